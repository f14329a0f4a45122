"""Findings on robots from outside. Oracles: arithmetic on their trajectories, least squares by SciPy, cases put in."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from rich.console import Console
from scipy.optimize import least_squares

from liftopt.assessment.assess import assess, assessed
from liftopt.assessment.failure_text import failure_text
from liftopt.assessment.joints import Words, joint_findings
from liftopt.assessment.text import verdict_text
from liftopt.assessment.who import Who
from liftopt.commands.summary_text import print_details
from liftopt.errors import NO_VALUE
from liftopt.multibody.robots.catalogue import known_robots
from liftopt.multibody.robots.data_finding import DataFinding
from liftopt.scenario.build import agents_of
from liftopt.solution.finding import Finding
from liftopt.solution.interpolation import between_knots
from liftopt.solution.solution import Solution
from liftopt.solution.summary import summary_dict
from liftopt.storage.reader import load_result
from liftopt.storage.writer import save

GRAVITY = 9.81


def _of(solution: Solution, code: str) -> list[Finding]:
    return [finding for finding in solution.assessment if finding.code == code]


def _asking(solution: Solution, **entries: Any) -> Solution:
    """Return the solution of a scenario that says more of the robot, assessed again."""
    return assessed(replace(solution, scenario=solution.scenario.replace(entries)))


def test_payload_is_the_makers_or_the_scenarios(ur10: Any) -> None:
    carried = np.abs(between_knots(ur10.solution)["robot"].load[:, 2] / GRAVITY).max()
    (finding,) = _of(ur10.solution, "robot.payload")
    assert (finding.value, finding.limit) == (pytest.approx(carried, rel=1e-12), 10.0)
    assert "Universal Robots" in finding.source and "gripper" not in finding.message
    given = _asking(ur10.solution, **{"robot.payload": 1.2 + carried, "robot.tool.mass": 1.3})
    (finding,) = _of(given, "robot.payload")
    assert (finding.value, finding.limit) == (pytest.approx(1.3 + carried), pytest.approx(1.2 + carried))
    assert (finding.severity, finding.source) == ("warning", "payload of the scenario")
    assert "1.3 kg of it the gripper" in finding.message


@pytest.mark.parametrize("name", ["panda", "tiago", "tiago_dual_left"])
def test_a_hand_that_is_in_the_urdf_counts_towards_the_payload(ur10: Any, name: str) -> None:
    """Oracle: masses in the URDF of all that is beyond the flange."""
    known = known_robots()[name]
    flange = {"panda": "panda_link8", "tiago": "wrist_ft_tool_link", "tiago_dual_left": "wrist_left_ft_tool_link"}[name]
    description = known.description()
    beyond = [joint.child for joint in description.below(flange)]
    for link in beyond:
        beyond += [joint.child for joint in description.below(link)]
    assert known.hand == pytest.approx(sum(description.link(link).body.mass for link in beyond), abs=1e-3)


def test_reach_ends_where_least_squares_end(ur10: Any) -> None:
    """A point just before the end can be held, one just beyond it from no posture near it."""
    (finding,) = _of(ur10.solution, "robot.reach")
    assert finding.value is not None and finding.limit is not None and finding.value < finding.limit
    fine, agent = between_knots(ur10.solution)["robot"], agents_of(ur10.solution.scenario, ur10.solution.urdfs)[1]
    origin = agent.model.jointPlacements[1].translation
    away = fine.grasp_position[:, 0] - origin
    k = int(np.argmax(np.linalg.norm(away, axis=1)))
    assert finding.value == pytest.approx(np.linalg.norm(away[k]))
    data, frame = agent.model.createData(), agent.model.getFrameId("robot_grasp")
    bounds = agent.limits.q_lower, agent.limits.q_upper

    def off(q: np.ndarray, point: np.ndarray) -> np.ndarray:
        pin.framesForwardKinematics(agent.model, data, q)
        return np.asarray(data.oMf[frame].translation - point)

    rng, ahead = np.random.default_rng(3), away[k] / np.linalg.norm(away[k])
    for beyond, held in ((-0.005, True), (0.005, False)):
        point = origin + (finding.limit + beyond) * ahead
        seeds = [fine.q[k], *(np.clip(fine.q[k] + rng.normal(0.0, 0.4, 6), *bounds) for _ in range(4))]
        left = min(np.linalg.norm(least_squares(off, q, bounds=bounds, args=(point,)).fun) for q in seeds)
        assert bool(left < 1e-4) is held


def test_a_stretched_arm_is_a_caution(ur10: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("liftopt.assessment.reach.room_outwards", lambda agent, q, direction: 0.01)
    (finding,) = _of(assessed(ur10.solution), "robot.reach")
    assert finding.severity == "caution"
    assert assess(ur10.solution).verdict("robot").severity == "caution"


def test_springs_are_told_by_the_scenario_or_by_name(ur10: Any) -> None:
    assert not _of(ur10.solution, "robot.springs")
    (finding,) = _of(_asking(ur10.solution, **{"robot.counterbalanced": True}), "robot.springs")
    assert finding.severity == "caution" and "smaller than those that are computed" in finding.message
    baxter = _asking(ur10.solution, **{"robot.model": "baxter_left"})
    assert "second joint of the shoulder" in _of(baxter, "robot.springs")[0].message
    assert not _of(_asking(baxter, **{"robot.counterbalanced": False}), "robot.springs")


def test_what_was_noticed_as_a_urdf_was_read_is_in_every_output_and_stays(ur10: Any, tmp_path: Any) -> None:
    same = [DataFinding("effort.same", "warned", f"joint {j}: effort", 300.0, "as of all", "see") for j in ("a", "b")]
    held = DataFinding("joints.held", "assumed", "joints that are held", NO_VALUE, "two", "say locked")
    robot = replace(ur10.solution["robot"], remarks=(*same, held))
    told = assessed(replace(ur10.solution, agents=(ur10.solution["human"], robot)))
    first, second = _of(told, "robot.data")
    assert (first.severity, second.severity) == ("caution", "info")
    assert first.message == "Data of the robot: joint a: effort = 300.0: as of all; see (and joint b: effort)."
    assert told.assessment.verdict("robot").severity == "caution"
    assert "joint a: effort and 1 more" in verdict_text(told, None).replace("\n    ", " ")
    assert first.message in [finding["message"] for finding in summary_dict(told)["assessment"]]
    save(told, tmp_path / "kept")
    again = load_result(tmp_path / "kept")
    assert list(again.assessment) == list(told.assessment)
    assert again["robot"].remarks == ()


def test_doubtful_data_are_told_where_there_is_no_lift(ur10: Any) -> None:
    doubt = DataFinding("effort.same", "warned", "effort", 300.0, "as of all", "see")
    robot = replace(ur10.solution["robot"], remarks=(doubt,))
    agents = (ur10.solution["human"], robot)
    told = assessed(replace(ur10.solution, agents=agents, outcome="infeasible: too weak"))
    assert [finding.message for finding in _of(told, "robot.data")] == [f"Data of the robot: {doubt.told}."]
    lines = failure_text(told, Path("a"), Path("a")).splitlines()
    assert lines[1] == f"  to check: Data of the robot: {doubt.told}."


def test_an_agent_from_a_file_carries_what_was_noticed(ur10: Any, known_agent: Any) -> None:
    assert "joints.held" in [remark.code for remark in known_agent("panda").remarks]


def test_a_joint_that_slides_is_told_in_its_units(on_a_column: Any, capsys: pytest.CaptureFixture[str]) -> None:
    """Oracle: its own trajectory, in m and N."""
    solution = on_a_column.solution
    fine = between_knots(solution)["robot"]
    force, way = fine.tau[:, 0], fine.q[:, 0]
    row = summary_dict(solution)["joints"]["robot"][0]
    assert row["peak_force_N"] == pytest.approx(force[np.argmax(np.abs(force))])
    assert (row["q_min_mm"], row["q_max_mm"]) == pytest.approx((1e3 * way.min(), 1e3 * way.max()))
    assert not [key for key in row if key.endswith(("_Nm", "_deg"))]
    strained = replace(solution["robot"].limits, velocity=np.full(7, 1e3), tau_upper=np.full(7, 1e3))
    strained.velocity[0], strained.tau_upper[0] = np.abs(fine.v[:, 0]).max(), force.max()
    agents = (solution["human"], replace(solution["robot"], limits=strained))
    words = Words(Who("robot", "robot", True), "torque", "torque limit", "")
    at = between_knots(solution)
    told = {f.code: f for f in joint_findings(at, replace(at["robot"], limits=agents[1].limits), words)}
    torque, speed, end = told["robot.torque"], told["robot.speed"], told["robot.range"]
    assert (torque.unit, torque.joint, torque.title) == ("N", "robot_column", "column at 100 % of its force limit")
    assert f"takes {force.max():.3g} N at" in torque.message
    assert speed.unit == "m/s" and f"slides at up to {1e3 * np.abs(fine.v[:, 0]).max():.0f} mm/s" in speed.message
    assert end.unit == "m" and end.value == pytest.approx(way.max()) and "500.0 mm" in end.message
    print_details(summary_dict(solution), Console(width=120))
    line = next(line for line in capsys.readouterr().out.splitlines() if line.startswith("column"))
    assert f"{row['peak_force_N']:+.2f} N" in line and f"{row['q_max_mm']:.1f} mm" in line
