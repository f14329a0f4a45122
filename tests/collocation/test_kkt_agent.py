"""Outputs and slopes of agents with several hands: against finite differences, trajectories and momentum."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from liftopt.collocation.kkt_agent import agent_knots
from liftopt.collocation.outputs import outputs_of
from liftopt.multibody.agent import Agent
from liftopt.multibody.trajectory import agent_trajectory, attitude, hand_turn

PERIOD = 1.7


@pytest.fixture(params=[("right", "left"), ("left",)], ids=["both hands", "left hand"])
def porter(request: pytest.FixtureRequest, make_two_handed: Callable[..., Agent]) -> Agent:
    return make_two_handed(hands=request.param, moments=True, stands=True, x=0.3, y=-0.2, yaw=0.4)


def test_jacobian_by_finite_differences(
    porter: Agent, differences: Callable[..., np.ndarray], rng: np.random.Generator
) -> None:
    y = rng.normal(size=3 * 12 + 2 * 6 + 3)
    y[36:48] *= 20.0
    jacobian = agent_knots(porter, y[None], PERIOD)[1][0]
    numeric = differences(lambda at: agent_knots(porter, at[None], PERIOD)[0][0], y)
    np.testing.assert_allclose(jacobian, numeric, rtol=0, atol=1e-9 * np.abs(numeric).max())


def test_outputs_are_those_of_the_trajectory(porter: Agent, rng: np.random.Generator) -> None:
    """Pinocchio's frames and RNEA on the whole model; a hand that holds nothing transmits nothing."""
    q, v, a = rng.normal(size=(3, 5, 12))
    wrench, angles = np.zeros((5, 2, 6)), rng.normal(size=(5, 3))
    used = [porter.hands.index(grasp.frame) for grasp in porter.grasps]
    wrench[:, used] = 20.0 * rng.normal(size=(5, len(used), 6))
    y = np.hstack([q, PERIOD * v, PERIOD**2 * a, wrench.reshape(5, -1), angles])
    c, own = agent_knots(porter, y, PERIOD)[0], outputs_of(porter)
    found = agent_trajectory(porter, q, v, a, wrench[:, used, :3], wrench[:, used, 3:])
    rotation = attitude(angles)[0]
    np.testing.assert_allclose(c[:, own.tau], found.tau, atol=1e-10)
    for g, grasp in enumerate(porter.grasps):
        np.testing.assert_allclose(c[:, own.position(grasp.frame)], found.grasp_position[:, g], atol=1e-12)
        held = np.einsum("kab,kab->k", rotation, found.grip_rotation[:, g])
        np.testing.assert_allclose(c[:, own.cosine(grasp.frame)][:, 0], (held - 1) / 2, atol=1e-12)
        local = np.einsum("kab,kda->kdb", rotation, wrench[:, used[g]].reshape(5, 2, 3)).reshape(5, 6)
        np.testing.assert_allclose(c[:, own.wrench(grasp.frame)], local, atol=1e-12)


def test_a_hand_around_a_bar_is_measured_by_its_angle_to_the_bar(porter: Agent, rng: np.random.Generator) -> None:
    """Pinocchio's frames turned about the bar by any angle, and tilted; finite differences of what is between."""
    bar = rng.normal(size=3)
    bar /= np.linalg.norm(bar)
    around = replace(porter, grasps=tuple(replace(grasp, bar=bar, max_turn=0.5) for grasp in porter.grasps))
    y, own = rng.normal(size=(1, 3 * 12 + 2 * 6 + 3)), outputs_of(around)
    found = agent_trajectory(around, y[:, :12], y[:, 12:24], y[:, 24:36], np.zeros((1, len(around.grasps), 3)))
    for g, grasp in enumerate(around.grasps):
        grip = found.grip_rotation[0, g]
        for roll, tilt in ((0.0, 0.0), (2.5, 0.0), (-1.0, 0.7)):
            aside = np.cross(bar, rng.normal(size=3))
            turn = pin.exp3(tilt * aside / np.linalg.norm(aside)) @ pin.exp3(roll * bar)
            rotation = grip @ turn.T
            y[0, -3:] = pin.rpy.matrixToRpy(rotation.T) * -1.0  # Rx(a) Ry(b) Rz(c) is (Rz(-c) Ry(-b) Rx(-a)) transposed
            known = float(agent_knots(around, y, PERIOD)[0][0, own.cosine(grasp.frame)][0])
            assert hand_turn(grasp, rotation[None], grip[None])[0] == pytest.approx(tilt, abs=1e-7)
            assert grasp.turn_beyond(np.array(grasp.least_cosine - known)) == pytest.approx(tilt - 0.5, abs=1e-7)
    jacobian = agent_knots(around, y, PERIOD)[1][0]
    rows = [own.cosine(grasp.frame).start for grasp in around.grasps]
    for column in range(y.shape[1]):
        step = 1e-6 * np.eye(y.shape[1])[column]
        after, before = (agent_knots(around, y + s * step, PERIOD)[0][0, rows] for s in (1.0, -1.0))
        np.testing.assert_allclose(jacobian[rows, column], (after - before) / 2e-6, atol=1e-8)


def test_the_ground_gives_what_changes_the_momentum(porter: Agent, rng: np.random.Generator) -> None:
    """Newton and Euler: force and moment of the ground, less weight and hands, are the momentum's rate (Pinocchio)."""
    q, v, a = rng.normal(size=(3, 1, 12))
    wrench = np.zeros((2, 6))
    for grasp in porter.grasps:
        wrench[porter.hands.index(grasp.frame)] = 20.0 * rng.normal(size=6)
    y = np.hstack([q, PERIOD * v, PERIOD**2 * a, wrench.reshape(1, -1), np.zeros((1, 3))])
    ground = agent_knots(porter, y, PERIOD)[0][0, outputs_of(porter).ground].reshape(2, 3)
    model, data, base = porter.model, porter.model.createData(), porter.T_world_base
    pin.computeCentroidalMomentumTimeVariation(model, data, q[0], v[0], a[0])
    pin.framesForwardKinematics(model, data, q[0])
    com, mass = pin.centerOfMass(model, data, q[0]), sum(body.mass for body in model.inertias)
    force, moment = (
        base[:3, :3] @ ground[0],
        base[:3, :3] @ ground[1] + np.cross(base[:3, 3] - com, base[:3, :3] @ ground[0]),
    )
    for hand, (f, m) in zip(porter.hands, wrench.reshape(2, 2, 3), strict=True):
        force = force - f
        moment = moment - m - np.cross(data.oMf[model.getFrameId(hand)].translation - com, f)
    np.testing.assert_allclose(force + mass * model.gravity.linear, data.dhg.linear, atol=1e-10)
    np.testing.assert_allclose(moment, data.dhg.angular, atol=1e-10)
