"""Three hinges as one ball: the same motion and effort. Oracles: Pinocchio's torques, MuJoCo's kinematics."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from liftopt.crosscheck.mujoco_balls import ball_joints, ball_motions
from liftopt.crosscheck.mujoco_forward import Simulation
from liftopt.multibody.mujoco_model import import_mujoco
from liftopt.scenario.build import agents_of


@pytest.fixture(scope="module")
def solution(solved: Any) -> Any:
    pytest.importorskip("mujoco", minversion="3.7", reason="mujoco is in the extra 'crosscheck'")
    return solved("table5", "solver.intervals=10", "solver.starts=1").solution


def test_a_person_has_two_and_the_robot_none(solution):
    human, robot = agents_of(solution.scenario, solution.urdfs)
    assert [human.model.names[j] for j in ball_joints(human.model)] == ["human_Q3", "human_Q6"]
    assert ball_joints(robot.model) == []


def test_components_of_the_moment_are_the_torques(solution):
    # Oracle: the trajectory's torques, RNEA's and the grasp's by Jacobians.
    human, trajectory = agents_of(solution.scenario, solution.urdfs)[0], solution.agents[0]
    for ball in ball_motions(human.model, trajectory):
        columns = [trajectory.joint_names.index(name) for name in ball.hinges]
        torques = np.einsum("khc,kc->kh", ball.axes, ball.moment)
        np.testing.assert_allclose(torques, trajectory.tau[:, columns], rtol=1e-9, atol=1e-9)


def test_body_is_where_the_hinges_put_it(solution):
    # Oracle: MuJoCo's kinematics of the ball against Pinocchio's grasp point, at every tenth time.
    mujoco, simulation = import_mujoco(), Simulation(solution)
    human = simulation._dense.agents[0]
    for k in range(0, len(human.q), 10):
        simulation._data.qpos[:] = simulation._states.qpos[k]
        mujoco.mj_kinematics(simulation._model, simulation._data)
        place = simulation._data.body("human_grasp").xpos
        np.testing.assert_allclose(place, human.p_world_hold[k], atol=1e-9)


def test_velocity_is_that_of_the_rotation(solution):
    # Oracle: central differences of the quaternion, on the simulation's time steps.
    simulation = Simulation(solution)
    mujoco, step = import_mujoco(), simulation._step
    for ball in simulation._balls:
        for k in range(1, len(ball.quaternion) - 1, 25):
            turn = np.zeros(3)
            mujoco.mju_subQuat(turn, ball.quaternion[k + 1], ball.quaternion[k - 1])
            np.testing.assert_allclose(turn / (2 * step), ball.velocity[k], atol=2e-4)
