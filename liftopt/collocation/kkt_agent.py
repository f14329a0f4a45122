"""Outputs and slopes of an agent's kernel, recomputed with Pinocchio in double precision."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from liftopt.collocation.layout import FORCE_SIZE
from liftopt.collocation.outputs import AgentOutputs, outputs_of
from liftopt.collocation.wrench_dynamics import WRENCH_SIZE
from liftopt.multibody.agent import Agent
from liftopt.multibody.leaning import up_in_link
from liftopt.multibody.standing import rooted
from liftopt.multibody.trajectory import attitude, bearing, cross, mirrored, turned
from liftopt.types import Array

# A step along the imaginary axis gives a derivative without a difference, so it can be as small as this.
STEP = 1e-30


def agent_knots(agent: Agent, y: Array, period: float) -> tuple[Array, Array]:
    """Return outputs (K, n_c) and Jacobians (K, n_c, n_y) of an agent at every knot.

    Args:
        agent: who holds.
        y: (K, n_y) knot variables: q, q', q'', of each hand force and moment, and roll, pitch, yaw of the object; of
            one who pushes at a point only the force comes after q''.
        period: T [s].
    """
    model, own = agent.reduced(), outputs_of(agent)
    n, data = model.nv, model.createData()
    q, v, a = y[:, :n], y[:, n : 2 * n] / period, y[:, 2 * n : 3 * n] / period**2
    frames = [model.frames[model.getFrameId(hand)] for hand in agent.hands]
    outputs, jacobian = np.zeros((len(y), own.size)), np.zeros((len(y), own.size, y.shape[1]))
    slopes, mass_matrix = np.zeros((len(y), 6, n)), np.zeros((len(y), n, n))
    points, grips = np.zeros((len(frames), len(y), 3)), np.zeros((len(frames), len(y), 3, 3))
    held = {grasp.frame: grasp.R_hand_measured for grasp in agent.grasps}
    turns = [held.get(hand, np.eye(3)) for hand in agent.hands]
    for k in range(len(y)):
        outputs[k, :n] = pin.rnea(model, data, q[k], v[k], a[k])
        slopes[k] = pin.computeJointJacobians(model, data, q[k]).reshape(6, -1)  # of one joint it is flat
        for h, (frame, turn) in enumerate(zip(frames, turns, strict=True)):
            points[h, k] = data.oMi[frame.parentJoint].act(frame.placement.translation)
            grips[h, k] = data.oMi[frame.parentJoint].rotation @ frame.placement.rotation @ turn
        by_state = pin.computeRNEADerivatives(model, data, q[k], v[k], a[k])
        jacobian[k, :n, :n], jacobian[k, :n, n : 2 * n], mass_matrix[k] = by_state
    jacobian[:, :n, n : 2 * n] /= period
    jacobian[:, :n, 2 * n : 3 * n] = mirrored(mass_matrix) / period**2
    if own.leans:
        outputs[:, own.lean], jacobian[:, own.lean, :n] = _lean(agent, model, q, slopes)
    if own.stands:
        outputs[:, own.ground], jacobian[:, own.ground, : 3 * n] = _bare_ground(agent, model, q, v, a, period)
    room = FORCE_SIZE if agent.pushes_at_a_point else WRENCH_SIZE
    for h, (hand, frame) in enumerate(zip(agent.hands, frames, strict=True)):
        own_slopes = slopes * bearing(model, frame.parentJoint)
        turning = own_slopes[:, 3:].swapaxes(1, 2)
        reach = own_slopes[:, :3].swapaxes(1, 2) + cross(turning, points[h][:, None])
        first = 3 * n + room * h
        force = slice(first, first + FORCE_SIZE)
        _add_force(own, hand, outputs, jacobian, turning, reach, points[h], y, force)
        if own.has_moments:
            moment = slice(first + FORCE_SIZE, first + WRENCH_SIZE)
            _add_moment(own, hand, outputs, jacobian, np.ascontiguousarray(turning), grips[h], y, force, moment)
            if own.stands:
                _add_to_ground(agent, own, outputs, jacobian, points[h], reach, y, force, moment)
    return outputs, jacobian


def _add_force(
    own: AgentOutputs, hand: str, outputs: Array, jacobian: Array, turning: Array, reach: Array, point: Array, y: Array,
    force: slice,
) -> None:  # fmt: skip
    """Add what a hand's force does to the torques, and its own outputs."""
    n, f, position = own.joints, y[:, force], own.position(hand)
    # A joint turns the grasp's Jacobian columns of the joints after it: d2p / dq_i dq_j = w_i x dp/dq_j for i <= j,
    # and the order of differentiation does not matter.
    jacobian[:, :n, :n] += mirrored(turned(cross(turning[:, :, None], reach[:, None, :]), f[:, None]))
    jacobian[:, :n, force] = reach
    jacobian[:, position, :n] = reach.swapaxes(1, 2)
    jacobian[:, own.force_squared(hand), force] = 2 * f[:, None]
    outputs[:, :n] += turned(reach, f)
    outputs[:, position], outputs[:, own.force_squared(hand)] = point, (f**2).sum(axis=1)[:, None]


def _add_moment(
    own: AgentOutputs, hand: str, outputs: Array, jacobian: Array, axes: Array, grip: Array, y: Array, force: slice,
    moment: slice,
) -> None:  # fmt: skip
    """Add what a hand's moment does to the torques, and the outputs of a hold that transmits one."""
    n, f, m, attitudes = own.joints, y[:, force], y[:, moment], slice(y.shape[1] - 3, y.shape[1])
    rotation = attitude(y[:, attitudes])[0]
    # dR by roll, pitch, yaw
    turning = attitude(y[:, None, attitudes] + 1j * STEP * np.eye(3))[0].imag / STEP
    cosine = (np.einsum("kab,kab->k", rotation, grip) - 1.0) / 2.0
    outputs[:, :n] += turned(axes, m)
    outputs[:, own.moment_squared(hand)] = (m**2).sum(axis=1)[:, None]
    outputs[:, own.cosine(hand)] = cosine[:, None]
    # A joint turns the axes of the joints after it: dw_i / dq_j = w_j x w_i for j < i.
    jacobian[:, :n, :n] += np.tril(turned(cross(axes[:, None], axes[:, :, None]), m[:, None]), -1)
    jacobian[:, :n, moment] = axes
    jacobian[:, own.moment_squared(hand), moment] = 2.0 * m[:, None]
    # d tr(R^T G) = sum_b R_b . (w x G_b) = w . sum_b G_b x R_b for a turn w of the hand.
    sideways = cross(grip.swapaxes(1, 2), rotation.swapaxes(1, 2)).sum(axis=1)
    jacobian[:, own.cosine(hand), :n] = turned(axes, sideways)[:, None] / 2.0
    jacobian[:, own.cosine(hand), attitudes] = np.einsum("kjab,kab->kj", turning, grip)[:, None] / 2.0
    first = own.wrench(hand).start
    for vector, columns in ((f, force), (m, moment)):
        rows = slice(first, first + 3)
        outputs[:, rows] = np.einsum("kab,ka->kb", rotation, vector)
        jacobian[:, rows, columns] = rotation.swapaxes(1, 2)
        jacobian[:, rows, attitudes] = np.einsum("kjab,ka->kbj", turning, vector)
        first += 3


def _lean(agent: Agent, model: pin.Model, q: Array, slopes: Array) -> tuple[Array, Array]:
    """Return 1 - cos of the trunk's angle from the vertical (K, 1), and its slopes (K, 1, n)."""
    assert agent.lean is not None
    trunk, data = model.getJointId(agent.lean.joint), model.createData()
    at_rest, up = up_in_link(model, trunk), np.zeros((len(q), 3))
    for k in range(len(q)):
        pin.forwardKinematics(model, data, q[k])
        up[k] = data.oMi[trunk].rotation @ at_rest
    turning = (slopes * bearing(model, trunk))[:, 3:].swapaxes(1, 2)
    # A joint turns the trunk's axis about its own: d up / dq_j = w_j x up.
    return 1.0 - up[:, 2:], -cross(turning, up[:, None])[:, None, :, 2]


def _bare_ground(agent: Agent, model: pin.Model, q: Array, v: Array, a: Array, period: float) -> tuple[Array, Array]:
    """Return what the ground exerts on all that moves (K, 6) without the grasps, and its slopes (K, 6, 3 n)."""
    n, tree, still = model.nv, rooted(model, _base(agent)), np.zeros(6)
    data = tree.createData()
    ground, slopes = np.zeros((len(q), 6)), np.zeros((len(q), 6, 3 * n))
    for k in range(len(q)):
        state = np.concatenate([still, [1.0], q[k]]), np.concatenate([still, v[k]]), np.concatenate([still, a[k]])
        ground[k] = pin.rnea(tree, data, *state)[:6]
        by_state = pin.computeRNEADerivatives(tree, data, *state)
        slopes[k] = np.hstack([each[:6, 6:] / period**order for order, each in enumerate(by_state)])
    return ground, slopes


def _base(agent: Agent) -> Array:
    """Return the placement (4, 4) in whose axes the ground's outputs are: the world's of one that does not stand."""
    return agent.T_world_base if agent.stance else np.eye(4)


def _add_to_ground(
    agent: Agent, own: AgentOutputs, outputs: Array, jacobian: Array, point: Array, reach: Array, y: Array,
    force: slice, moment: slice,
) -> None:  # fmt: skip
    """Add what holds a hand's reaction to the ground's force and moment."""
    n, f, m, first = own.joints, y[:, force], y[:, moment], own.ground.start
    to_base, lever = _base(agent)[:3, :3].T, point - _base(agent)[:3, 3]
    pull, twist = slice(first, first + 3), slice(first + 3, first + 6)
    outputs[:, pull] += f @ to_base.T
    outputs[:, twist] += (cross(lever, f) + m) @ to_base.T
    jacobian[:, pull, force] = jacobian[:, twist, moment] = to_base
    jacobian[:, twist, force] = to_base @ cross(lever[:, None], np.eye(3)).swapaxes(1, 2)
    jacobian[:, twist, :n] += to_base @ cross(reach, f[:, None]).swapaxes(1, 2)
