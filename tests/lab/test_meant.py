"""Which robot and which person is meant; oracles: each one's own trajectory, equilibrium at rest."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from liftopt.commands.cli import main
from liftopt.commands.exit_status import BAD_INPUT, DONE
from liftopt.errors import InputError
from liftopt.lab.comparison.experiment import experiment
from liftopt.lab.forces.force_record import ForceRecord
from liftopt.lab.meant import the_person, the_robot
from liftopt.lab.robot.dry_run_plan import Plan
from liftopt.lab.robot.dry_run_summary import reach_to_others
from liftopt.lab.robot.joint_trajectory import joint_trajectory
from liftopt.lab.robot.simulated_arm import SimulatedArm
from liftopt.multibody.robots.sawyer import JOINT_SIGNS
from liftopt.solution.solution import Solution


def test_the_only_one_needs_no_name(people: Solution, robots: Solution) -> None:
    assert the_person(robots, None).name == "human"
    assert the_robot(robots, "far").name == "far"
    assert the_person(people, "ben").name == "ben"


@pytest.mark.parametrize(
    ("find", "team", "name", "said"),
    [
        (the_robot, "robots", None, "--robot: is missing; this lift has more than one robot: near, far"),
        (the_robot, "robots", "neer", "--robot = 'neer': must be the name of a robot of this lift: near, far; did you"),
        (the_robot, "robots", "human", "must be the name of a robot of this lift: near, far"),
        (the_robot, "people", None, "RESULT: has no robot"),
        (the_person, "people", None, "--person: is missing; this lift has more than one person: anna, ben"),
    ],
)
def test_who_is_not_clear_is_refused_in_one_line(
    find: Callable[..., Any], team: str, name: str | None, said: str, request: pytest.FixtureRequest
) -> None:
    with pytest.raises(InputError) as caught:
        find(request.getfixturevalue(team), name)
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["near", "far"])
def test_the_named_robots_motion_is_exported(robots: Solution, name: str) -> None:
    robot = robots[name]
    sent = joint_trajectory(robots, robot=name)
    np.testing.assert_allclose(sent.position[0], JOINT_SIGNS * robot.q[0, robot.moving], rtol=1e-12)
    np.testing.assert_allclose(sent.position[-1], JOINT_SIGNS * robot.q[-1, robot.moving], rtol=1e-12)


def test_at_rest_the_plans_of_both_robots_hold_what_is_theirs(robots: Solution) -> None:
    """The loads of all hands at rest carry the plank: what both robots bear is what the person's hand does not."""
    plans = {name: Plan.of(robots, name) for name in ("near", "far")}
    weight = 6.0 * 9.81
    for row in (0, -1):
        borne = {name: -plan.force[row, 2] for name, plan in plans.items()}
        human = weight - sum(borne.values())
        # Moments about the plank's middle: the robots hold on the far side, the person on the near one, midway.
        assert borne["near"] == pytest.approx(borne["far"], abs=1.0)
        assert human == pytest.approx(weight / 2, rel=0.02)
    for name, plan in plans.items():
        np.testing.assert_allclose(plan.tip[1], robots[name].p_world_hold[0], atol=1e-9)


def test_the_simulated_arm_is_the_named_one(robots: Solution) -> None:
    pytest.importorskip("mujoco")
    for name in ("near", "far"):
        robot = robots[name]
        arm = SimulatedArm(robots, np.ones(7), True, name)
        arm.rest(robot.q[0, robot.moving], np.zeros(3))
        np.testing.assert_allclose(arm.tip, robot.p_world_hold[0], atol=1e-6)


def test_the_lever_is_from_a_gripper_to_the_middle_of_the_other_hands(robots: Solution, solved: Any) -> None:
    table5 = solved("table5", "solver.intervals=10", "solver.starts=1").solution.scenario
    assert reach_to_others(table5, "robot") == table5.object.depth
    human, far, near = np.array([-0.2, 0.0]), np.array([0.2, 0.4]), np.array([0.2, -0.4])
    assert reach_to_others(robots.scenario, "near") == pytest.approx(np.linalg.norm(near - (human + far) / 2))


def test_a_record_is_compared_with_the_named_persons_hand(people: Solution) -> None:
    time = np.linspace(0.0, 2.0, 50)
    quiet = np.zeros((50, 2), np.uint8)
    record = ForceRecord("f.csv", 1, ("index", "thumb"), time, np.ones((50, 2)), quiet, np.zeros(2), ())
    for name in ("anna", "ben"):
        (found,) = experiment(people, forces=[record], person=name).comparisons
        assert found.predicted[-1] == pytest.approx(people[name].load[-1, 2])
    with pytest.raises(InputError, match="more than one person: anna, ben"):
        experiment(people, forces=[record])


def test_commands_take_the_name_or_say_that_it_is_missing(
    robots: Solution, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("liftopt.storage.reader.load_result", lambda _: robots)
    words = ["export", "lift", "--format", "csv", "--rate", "20"]
    assert main([*words, "--out", str(tmp_path / "none")]) == BAD_INPUT
    assert "--robot: is missing; this lift has more than one robot: near, far" in capsys.readouterr().err
    assert not (tmp_path / "none").exists()
    assert main([*words, "--robot", "far", "--out", str(tmp_path / "far")]) == DONE
    rows = np.loadtxt(tmp_path / "far" / "trajectory.csv", delimiter=",", skiprows=1, ndmin=2)
    far = robots["far"]
    np.testing.assert_allclose(rows[0, 1:8], JOINT_SIGNS * far.q[0, far.moving], atol=1e-6)
