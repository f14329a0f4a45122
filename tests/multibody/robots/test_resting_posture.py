"""Postures of robots that come with none. Oracle: Pinocchio's kinematics of the agent's model."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

pytest.importorskip("yourdfpy")

from liftopt.multibody.robots.example_robot_data import share_folder
from liftopt.multibody.robots.read_robot import read_robot
from liftopt.multibody.robots.resting_posture import heading
from liftopt.multibody.robots.robot_agent import robot_agent
from liftopt.scenario.build import agents_of
from liftopt.scenario.model import scenario_from_dict

LIFT = {
    "schema": 2,
    "duration": 2.0,
    "agents": {"anna": {"kind": "person", "stature": 1.7, "mass": 60.0, "sex": "female"}},
    "object": {"name": "box", "mass": 1.0, "depth": 0.3, "width": 0.3, "height": 0.1},
    "task": {"standing_distance": 1.0, "start": {"x": 0.5, "z": 0.9}, "end": {"x": 0.5, "z": 1.1}},
    "objective": {"preset": "paper"},
}

needs_robots = pytest.mark.skipif(share_folder() is None, reason="example-robot-data is not installed")
# Robots whose grasp frame has its z axis along the fingers.
POINTING = ("ur3", "ur5", "ur10", "panda", "kinova", "xarm7", "baxter_left", "baxter_right", "tiago_dual_right")


def _conditioned(agent, q):
    """Return the least singular value of the tip's motion, lengths in shares of its distance from the first joint."""
    model, data = agent.model, agent.model.createData()
    pin.framesForwardKinematics(model, data, q)
    slopes = pin.computeFrameJacobian(model, model.createData(), q, model.getFrameId("robot_grasp"), pin.LOCAL)
    reach = np.linalg.norm(data.oMf[model.getFrameId("robot_grasp")].translation - data.oMi[1].translation)
    return np.linalg.svd(np.vstack([slopes[:3] / reach, slopes[3:5]]), compute_uv=False)[-1]


@needs_robots
@pytest.mark.parametrize("name", POINTING)
def test_the_tool_is_level_and_ahead_far_from_limits_and_from_stretched(name, known_agent):
    place = np.asarray(pin.SE3(pin.rpy.rpyToMatrix(0.0, 0.0, 2.5), np.array([1.0, 2.0, 0.9])))
    agent = known_agent(name, T_world_base=place)
    data, limits, ahead = agent.model.createData(), agent.limits, np.array([np.cos(2.5), np.sin(2.5), 0.0])
    pin.framesForwardKinematics(agent.model, data, agent.posture)
    tip = data.oMf[agent.model.getFrameId("robot_grasp")]
    assert tip.rotation[:, 2] @ ahead > np.cos(np.radians(3.0))
    assert (tip.translation - data.oMi[1].translation) @ ahead > 0.2
    assert np.minimum(agent.posture - limits.q_lower, limits.q_upper - agent.posture).min() > 0.4
    middle = (limits.q_lower + limits.q_upper) / 2.0
    assert _conditioned(agent, agent.posture) > max(0.1, _conditioned(agent, middle))
    np.testing.assert_array_equal(agent.posture, known_agent(name, T_world_base=place).posture)


@needs_robots
def test_a_robot_on_a_wall_reaches_out_level_too(known_agent):
    place = np.asarray(pin.SE3(pin.rpy.rpyToMatrix(0.0, np.pi / 2.0, np.pi), np.array([2.0, 0.0, 1.2])))
    agent = known_agent("ur5", T_world_base=place)
    data = agent.model.createData()
    pin.framesForwardKinematics(agent.model, data, agent.posture)
    tip = data.oMf[agent.model.getFrameId("robot_grasp")]
    assert tip.rotation[:, 2] @ [-1.0, 0.0, 0.0] > np.cos(np.radians(3.0))
    assert tip.translation[0] < 1.6


@needs_robots
@pytest.mark.parametrize("name", ["icub_left", "so100", "talos_right", "centauro_left"])
def test_a_known_robot_turns_its_front_to_the_person_and_its_hand_out(name):
    """These have their front, or the axis along the hand, elsewhere than x of the base and z of the frame."""
    robot = {"kind": "robot", "model": name, "base": {"x": 1.0, "z": 0.9}}
    agent = agents_of(scenario_from_dict(LIFT | {"agents": {**LIFT["agents"], "ben": robot}}))[1]
    data = agent.model.createData()
    pin.framesForwardKinematics(agent.model, data, agent.posture)
    tip = data.oMf[agent.model.getFrameId("ben_grasp")]
    assert tip.rotation[:, 2] @ [-1.0, 0.0, 0.0] > np.cos(np.radians(5.0))
    assert tip.translation[0] < 0.9


def test_a_base_faces_along_its_x_axis_or_away_from_its_wall():
    for angles, faces in (
        ((0.0, 0.0, np.pi / 2.0), (0.0, 1.0, 0.0)),
        ((np.pi, 0.0, np.pi), (-1.0, 0.0, 0.0)),  # on a ceiling
        ((0.0, np.pi / 2.0, np.pi), (-1.0, 0.0, 0.0)),  # on a wall
        ((0.0, 0.3, 0.0), (1.0, 0.0, 0.0)),
    ):
        place = np.asarray(pin.SE3(pin.rpy.rpyToMatrix(*angles), np.zeros(3)))
        np.testing.assert_allclose(heading(place), faces, rtol=0.0, atol=1e-12)


def test_positions_that_are_given_stay_and_few_joints_do(arm):
    robot = read_robot(arm())
    agent = robot_agent(robot, name="robot", T_world_base=np.eye(4), posture={"j2": 0.7})
    assert agent.posture[1] == 0.7
    every = {"j1": 0.1, "j2": 0.2, "j3": 0.3, "j4": 0.4}
    agent = robot_agent(robot, name="robot", T_world_base=np.eye(4), posture=every)
    np.testing.assert_array_equal(agent.posture, list(every.values()))
    held = robot_agent(robot, name="robot", T_world_base=np.eye(4), locked={"j1": 0.0, "j2": 0.4, "j4": 0.1})
    assert held.limits.q_lower[0] < held.posture[0] < held.limits.q_upper[0]
