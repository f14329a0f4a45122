"""Robots that a scenario names. Oracle: Pinocchio on the robot's own URDF, placed by hand; hand-made files."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

pytest.importorskip("yourdfpy")

import liftopt as lo
from liftopt.collocation.objective import agent_weights
from liftopt.scenario.build import agent_of, task_of
from liftopt.scenario.model import Scenario, load_scenario
from liftopt.scenario.robot_agents import LEVER, is_from_file

FRAME = {"robot.grasp_frame": "tool0"}


@pytest.fixture
def file(arm: Callable[..., str], tmp_path: Path) -> Path:
    path = tmp_path / "arms" / "arm.urdf"
    path.parent.mkdir()
    path.write_text(arm())
    return path


def scenario(file: Path, **changes: object) -> Scenario:
    return load_scenario("table5", {"robot.model": str(file), **FRAME, **changes})


@pytest.mark.parametrize(
    ("base", "tool", "own"),
    [
        ({"x": 1.5, "z": 0.4, "yaw_deg": 90.0}, {"length": 0.2, "mass": 0.5, "direction": "z"}, (0.0, 0.0, 0.2)),
        ({"x": 1.5, "y": 0.3, "z": 2.2, "roll_deg": 180.0}, {"length": 0.1, "mass": 0.0, "direction": "-x"},
         (-0.1, 0.0, 0.0)),
        ({"x": 1.5, "z": 1.0, "pitch_deg": 90.0, "yaw_deg": 180.0}, {"length": 0.1, "mass": 0.0, "direction": "y",
         "turn_deg": 30.0}, (0.0, 0.1, 0.0)),
    ],
)  # fmt: skip
def test_it_is_where_and_as_its_own_urdf_has_it(
    base: dict[str, float], tool: dict[str, object], own: tuple[float, ...], file: Path
) -> None:
    agent = agent_of(scenario(file, **{"robot.base": base, "robot.tool": tool}), "robot")
    theirs = pin.buildModelFromUrdf(str(file))
    data, ours, q = theirs.createData(), agent.model.createData(), np.zeros(theirs.nq)
    names = ["j1", "j2", "j3", "j4"]
    values = np.array([0.3, -0.7, 0.5, 1.1])
    for name, value in zip(names, values, strict=True):
        q[theirs.joints[theirs.getJointId(name)].idx_q] = value
    pin.framesForwardKinematics(theirs, data, q)
    roll, pitch, yaw = (np.radians(base.get(key, 0.0 if key != "yaw_deg" else 180.0)) for key in (
        "roll_deg", "pitch_deg", "yaw_deg"))  # fmt: skip
    turned = pin.AngleAxis(yaw, np.array([0, 0, 1.0])).matrix() @ pin.AngleAxis(pitch, np.array([0, 1.0, 0])).matrix()
    turned = turned @ pin.AngleAxis(roll, np.array([1.0, 0, 0])).matrix()
    placed = pin.SE3(turned, np.array([base["x"], base.get("y", 0.0), base["z"]]))
    flange = placed * data.oMf[theirs.getFrameId("tool0")]
    pin.framesForwardKinematics(agent.model, ours, values)
    tip = ours.oMf[agent.model.getFrameId("robot_grasp")]
    assert tip.translation == pytest.approx(flange.act(np.array(own)), abs=1e-9)
    assert tip.rotation[:, 2] == pytest.approx(flange.rotation @ np.array(own) / np.linalg.norm(own), abs=1e-9)
    assert agent.moving_joints == tuple(f"robot_{name}" for name in names)


def test_a_relative_path_counts_from_the_file_that_says_it(file: Path, tmp_path: Path) -> None:
    text = load_scenario("table5").to_toml().replace('model = "sawyer"', 'model = "arms/arm.urdf"')
    (tmp_path / "lift.toml").write_text(text)
    read = load_scenario(tmp_path / "lift.toml", FRAME)
    assert read.agents["robot"].model == str(file) and is_from_file(read, "robot")  # type: ignore[union-attr]
    assert agent_of(read, "robot").model.nq == 4
    assert (
        load_scenario(tmp_path / "lift.toml", {**FRAME, "name": "x"}).to_toml() == read.replace({"name": "x"}).to_toml()
    )


def test_another_model_drops_what_goes_by_the_first(file: Path) -> None:
    first = scenario(file, **{"robot.locked": {"j2": 0.5}, "robot.payload": 3.0, "robot.tool.length": 0.1})
    assert agent_of(first, "robot").moving_joints == ("robot_j1", "robot_j3", "robot_j4")
    back = first.replace({"robot.model": "sawyer"})
    assert back.agents["robot"] == load_scenario("table5").agents["robot"]


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"robot.locked": {"q": 0.0}}, "robot.locked = 'q': it has no joint of this name; it has j1, j2, j3, j4"),
        ({"robot.locked": {"j1": 3.0}}, "robot.locked.j1 = 3.0: must be from -2.5 to 2.1, where the joint can be"),
        ({"robot.posture": {"tool0": 0.0}}, "robot.posture = 'tool0': must be a joint that moves: j1, j2, j3, j4"),
        ({"robot.posture": {"j1": 3.0}}, "robot.posture.j1 = 3.0: must be from -2.5 to 2.1 rad or m"),
        ({"robot.joint_weights": {"q": 2.0}}, "robot.joint_weights = 'q': must be a joint that moves"),
        ({"robot.grasp_frame": "tol0"}, "robot.grasp_frame = 'tol0': it has no link of this name; did you mean tool0"),
        ({"robot.base_link": "bas"}, "robot.base_link = 'bas': it has no link of this name; did you mean base"),
        ({"robot.limits": {"j1": {"effort": -1.0}}}, "robot.limits.j1.effort = -1.0: must be a number above 0"),
        ({"robot.limits": {"j1": {"efort": 1.0}}}, "robot.limits.j1.efort = 1.0: unknown key; did you mean "),
        ({"robot.tool": {"direction": "up"}}, "robot.tool.direction = 'up': must be"),
        ({"robot.model": "nowhere.urdf"}, "nowhere.urdf': must be a name that `liftopt robots` lists"),
    ],
)
def test_what_does_not_go_is_one_line_that_names_it(changes: dict[str, object], told: str, file: Path) -> None:
    with pytest.raises(lo.InputError) as caught:
        agent_of(scenario(file, **changes), "robot")
    assert told in str(caught.value) and "\n" not in str(caught.value)


def test_limits_and_payload_stand_in_for_the_files(file: Path) -> None:
    given = {"robot.limits": {"j2": {"effort": 12.0, "velocity": 0.5, "upper": 1.0}}}
    agent = agent_of(scenario(file, **given), "robot")
    assert (agent.limits.tau_upper[1], agent.limits.velocity[1], agent.limits.q_upper[1]) == (12.0, 0.5, 1.0)
    assert agent.limits.tau_upper[0] == 99.0


def test_weights_of_joints_count_in_the_objective(file: Path) -> None:
    plain, heavy = (scenario(file, **more) for more in ({}, {"robot.joint_weights": {"j3": 5.0}}))
    of = [agent_weights(task_of(each), 1, agent_of(each, "robot"), 24) for each in (plain, heavy)]
    assert of[1].above / of[0].above == pytest.approx([1.0, 1.0, 5.0, 1.0], rel=1e-12)


def test_a_sliding_joint_counts_by_a_lever_in_preset_paper(arm: Callable[..., str], tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(arm(('name="j1" type="revolute"', 'name="j1" type="prismatic"')))
    for preset, factors in (("natural", None), ("paper", [LEVER**2, 1.0, 1.0, 1.0])):
        agent = agent_of(scenario(tmp_path / "arm.urdf", **{"objective.preset": preset}), "robot")
        assert agent.joint_weights is None if factors is None else agent.joint_weights == pytest.approx(factors)


def test_python_reads_a_robot_at_once(file: Path) -> None:
    robot = lo.Robot.from_urdf(file, grasp_frame="tool0", base=lo.Pose(x=1.9, z=0.9, yaw_deg=180))
    assert scenario(file, **{"robot.base": lo.Pose(x=1.9, z=0.9)}).agents["robot"].model == robot.model  # type: ignore[union-attr]
    file.write_text(file.read_text().replace('<mass value="4.0"/>', '<mass value="nan"/>'))
    with pytest.raises(lo.InputError, match="l1"):
        lo.Robot.from_urdf(file, grasp_frame="tool0")


def test_a_joint_that_turns_further_is_held_to_the_turn_around_its_posture(
    arm: Callable[..., str], tmp_path: Path
) -> None:
    joint = '<joint name="j{}" type="revolute">'
    (tmp_path / "arm.urdf").write_text(arm((joint.format(1), joint.format(1).replace("revolute", "continuous"))))
    wide = {"j4": {"lower": -7.0, "upper": 7.0}, "j1": {"lower": -9.0, "upper": 9.0}}
    given = {"robot.posture": {"j1": 4.0, "j4": 5.0}, "robot.limits": wide}
    agent = agent_of(scenario(tmp_path / "arm.urdf", **given), "robot")
    limits = agent.limits
    assert (limits.q_lower[0], limits.q_upper[0]) == pytest.approx((4.0 - np.pi, 4.0 + np.pi), abs=1e-9)
    assert (limits.q_lower[3], limits.q_upper[3]) == pytest.approx((5.0 - np.pi, 7.0), abs=1e-9)
    assert (limits.q_lower[1], limits.q_upper[1]) == (-2.5, 2.2)
    assert agent.posture[[0, 3]] == pytest.approx((4.0, 5.0))
    assert agent.model.upperPositionLimit == pytest.approx(limits.q_upper)
