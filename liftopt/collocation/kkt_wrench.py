"""Outputs and slopes of the kernels for wrenches, recomputed with Pinocchio; ``kkt`` has those without moments."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from liftopt.multibody.agent import Agent, LiftedObject
from liftopt.multibody.trajectory import attitude, bearing, cross, turned
from liftopt.types import Array

# A step along the imaginary axis gives a derivative without a difference, so it can be as small as this.
STEP = 1e-30


def add_agent_wrench(agent: Agent, y: Array, outputs: Array, slopes: Array) -> tuple[Array, Array]:
    """Return outputs (K, n + 12) and Jacobians (K, n + 12, n_y) of a hold with moments and the object's attitude.

    Args:
        agent: who holds.
        y: (K, n_y) knot variables: q, q', q'', force, moment, and roll, pitch, yaw of the object.
        outputs: (K, n + 4) torques, grasp point and squared force without the moment.
        slopes: (K, n + 4, n_y) of these.
    """
    model = agent.reduced()
    n, frame = model.nv, model.frames[model.getFrameId(agent.hands[0])]
    data, carrier = model.createData(), frame.parentJoint
    axes, grip = np.zeros((len(y), n, 3)), np.zeros((len(y), 3, 3))
    for k in range(len(y)):
        axes[k] = pin.computeJointJacobians(model, data, y[k, :n])[3:].T
        grip[k] = data.oMi[carrier].rotation @ frame.placement.rotation @ agent.grasps[0].R_hand_object
    axes *= bearing(model, carrier)[:, None]
    f, m, angles = y[:, 3 * n : 3 * n + 3], y[:, 3 * n + 3 : 3 * n + 6], y[:, 3 * n + 6 :]
    rotation = attitude(angles)[0]
    turning = attitude(angles[:, None] + 1j * STEP * np.eye(3))[0].imag / STEP  # dR by roll, pitch, yaw
    cosine = (np.einsum("kab,kab->k", rotation, grip) - 1.0) / 2.0
    local = [np.einsum("kab,ka->kb", rotation, vector) for vector in (f, m)]

    outputs = np.hstack([outputs, (m**2).sum(axis=1)[:, None], cosine[:, None], *local])
    outputs[:, :n] += turned(axes, m)
    added = np.zeros((len(y), 8, y.shape[1]))
    moment, attitudes = slice(3 * n + 3, 3 * n + 6), slice(3 * n + 6, 3 * n + 9)
    # A joint turns the axes of the joints after it: dw_i / dq_j = w_j x w_i for j < i.
    slopes[:, :n, :n] += np.tril(turned(cross(axes[:, None], axes[:, :, None]), m[:, None]), -1)
    slopes[:, :n, moment] = axes
    added[:, 0, moment] = 2.0 * m
    # d tr(R^T G) = sum_b R_b . (w x G_b) = w . sum_b G_b x R_b for a turn w of the hand.
    sideways = cross(grip.swapaxes(1, 2), rotation.swapaxes(1, 2)).sum(axis=1)
    added[:, 1, :n] = turned(axes, sideways) / 2.0
    added[:, 1, attitudes] = np.einsum("kjab,kab->kj", turning, grip) / 2.0
    for first, vector, columns in ((2, f, slice(3 * n, 3 * n + 3)), (5, m, moment)):
        added[:, first : first + 3, columns] = rotation.swapaxes(1, 2)
        added[:, first : first + 3, attitudes] = np.einsum("kjab,ka->kbj", turning, vector)
    return outputs, np.concatenate([slopes, added], axis=1)


def object_wrench_slopes(lifted: LiftedObject, y: Array, slopes: Array) -> Array:
    """Return the Jacobians (K, n_c, 18 + 6 m) of the object with moments.

    Args:
        lifted: the object.
        y: (K, 18 + 6 m) knot variables.
        slopes: (K, n_c, 18 + 3 m) of the object with the same forces and no moments.
    """
    grasps = len(lifted.grasp_frames)
    rotation, angles = attitude(y[:, 3:6])[0], y[:, None, 3:6] + 1j * STEP * np.eye(3)
    turning = attitude(angles)[0].imag / STEP
    whole = np.zeros((*slopes.shape[:2], y.shape[1]))
    whole[:, :, :18] = slopes[:, :, :18]
    for i in range(grasps):
        force, moment = slice(18 + 6 * i, 21 + 6 * i), slice(21 + 6 * i, 24 + 6 * i)
        whole[:, :, force] = slopes[:, :, 18 + 3 * i : 21 + 3 * i]
        whole[:, 3:6, moment] = -rotation.swapaxes(1, 2)
        whole[:, 3:6, 3:6] -= np.einsum("kjab,ka->kbj", turning, y[:, moment])
    return whole
