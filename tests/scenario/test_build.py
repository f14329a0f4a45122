"""From a scenario to agents, object and task: the oracle is the scenario's own geometry, by hand."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from liftopt.scenario.build import agents_of, object_of, task_of
from liftopt.scenario.model import load_scenario


def test_agents_stand_where_the_scenario_says() -> None:
    human, robot = agents_of(load_scenario("table5", ["task.standing_distance=2.3", "robot.base_height=0.5"]))
    assert (human.name, robot.name) == ("human", "robot")
    assert human.model.jointPlacements[1].translation == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)
    data, shoulder = robot.model.createData(), robot.model.getJointId("robot_Q1")
    pin.forwardKinematics(robot.model, data, pin.neutral(robot.model))
    # Table 3: the first rotation's axis is the pedestal's; it stands at Y = 0 as far ahead as was asked.
    assert data.oMi[shoulder].translation[:2] == pytest.approx([2.3, 0.0], abs=1e-9)
    assert data.oMi[shoulder].rotation[:, 2] == pytest.approx([0.0, 0.0, 1.0], abs=1e-9)


@pytest.mark.parametrize(("entry", "joint"), [("robot.base_height=1.2", "robot_Q1"), ("robot.tool.length=0.35", None)])
def test_robots_height_and_tool_reach_the_model(entry: str, joint: str | None) -> None:
    """A higher base lifts, a longer tool carries on along the last axis, by just the difference."""

    def where(scenario_entries: list[str]) -> pin.SE3:
        robot = agents_of(load_scenario("table5", scenario_entries))[1]
        data = robot.model.createData()
        pin.framesForwardKinematics(robot.model, data, pin.neutral(robot.model))
        return data.oMf[robot.model.getFrameId(joint or robot.hands[0])]

    moved = np.linalg.norm(where([entry]).translation - where([]).translation)
    assert moved == pytest.approx(1.2 - 0.915 if joint else 0.35 - 0.15, abs=1e-9)


def test_subject_reaches_the_model() -> None:
    human = agents_of(load_scenario("table5", ["human.mass=91", "human.sex=female"]))[0]
    light = agents_of(load_scenario("table5", ["human.mass=60", "human.sex=female"]))[0]
    share = pin.computeTotalMass(human.model) / 91
    assert pin.computeTotalMass(light.model) == pytest.approx(60 * share, rel=1e-9)


def test_poses_put_the_grasp_points_where_the_scenario_says() -> None:
    entries = ["object.depth=0.6", "object.height=0.1", "task.start.height=1.0", "task.end.human_distance=free"]
    scenario = load_scenario("table5", entries)
    task, table = task_of(scenario), object_of(scenario)
    # 0.40 m to the grasp and half of 0.6 m; 1.0 m and half of 0.1 m; sideways free, level.
    np.testing.assert_allclose(task.start, [0.7, np.nan, 1.05, 0.0, 0.0, 0.0])
    np.testing.assert_allclose(task.end, [np.nan, np.nan, 1.45, 0.0, 0.0, 0.0])
    data = table.model.createData()
    pin.framesForwardKinematics(table.model, data, np.array([0.7, 0.0, 1.05, 0.0, 0.0, 0.0, 1.0]))
    points = [data.oMf[table.model.getFrameId(frame)].translation for frame in table.grasp_frames]
    np.testing.assert_allclose(points, [[0.4, 0.0, 1.0], [1.0, 0.0, 1.0]], atol=1e-12)


@pytest.mark.parametrize("pitch", [-9.0, 4.0])
def test_a_tilted_object_has_its_grasp_points_about_the_height_and_the_robots_edge_lower_if_positive(
    pitch: float,
) -> None:
    """The human's grasp is as far ahead as was asked; depth x sine apart in height, with the height midway."""
    scenario = load_scenario("table5", ["object.depth=0.6", "object.height=0.1", f"task.end.pitch_deg={pitch}"])
    end, table = task_of(scenario).end, object_of(scenario)
    turn = pin.Quaternion(pin.rpy.rpyToMatrix(0.0, np.radians(pitch), 0.0)).coeffs()
    data = table.model.createData()
    pin.framesForwardKinematics(table.model, data, np.array([end[0], 0.0, end[2], *turn]))
    human, robot = (data.oMf[table.model.getFrameId(frame)].translation for frame in table.grasp_frames)
    assert human[0] == pytest.approx(0.4, abs=1e-12)
    assert (human[2] + robot[2]) / 2 == pytest.approx(1.4, abs=1e-12)
    assert human[2] - robot[2] == pytest.approx(0.6 * np.sin(np.radians(pitch)), abs=1e-12)


def test_limits_and_weights_are_passed_on_in_the_tasks_units() -> None:
    entries = [
        "limits.table_pitch_deg=12", "limits.table_yaw_deg=7", "limits.max_grasp_force=150",
        "limits.balance_tolerance=0.5", "human.weight=2", "robot.weight=3",
        "objective.acceleration_weight=4", "objective.force_weight=5", "duration=3",
    ]  # fmt: skip
    task = task_of(load_scenario("table5_paper", entries))
    np.testing.assert_allclose(task.pose_upper[3:], np.radians([0.0, 12.0, 7.0]))
    np.testing.assert_allclose(task.pose_lower[3:], -task.pose_upper[3:])
    assert task.pose_lower[2] == 0.0
    assert (task.max_grasp_force, task.balance_tolerance, task.duration) == (150.0, 0.5, 3.0)
    assert (*task.agent_weights, task.acceleration_weight, task.force_weight) == (2.0, 3.0, 4.0, 5.0)


@pytest.mark.parametrize(("duration", "factor"), [(1.0, 1 / 16), (2.0, 1.0), (4.0, 16.0)])
def test_a_slow_natural_lift_is_as_smooth_as_a_fast_one(duration: float, factor: float) -> None:
    """The factor on squared accelerations, by hand: the fourth power of the duration over 2 s; none for the paper."""
    entries = ["objective.acceleration_weight=4", f"duration={duration}"]
    natural, paper = (
        task_of(load_scenario("table5", [f"objective.preset={name}", *entries])) for name in ("natural", "paper")
    )
    assert (natural.acceleration_weight, paper.acceleration_weight) == (4.0, 4.0)
    assert (natural.pace, paper.pace) == (pytest.approx(factor), 1.0)
