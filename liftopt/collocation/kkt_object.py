"""Outputs and slopes of the object's kernel, recomputed with Pinocchio in double precision."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from liftopt.collocation.kkt_agent import STEP
from liftopt.collocation.layout import OBJECT_SIZE
from liftopt.multibody.agent import LiftedObject
from liftopt.multibody.trajectory import attitude, free_flyer_state, mirrored, object_trajectory
from liftopt.types import Array


def object_knots(lifted: LiftedObject, y: Array, period: float, *, bare: bool) -> tuple[Array, Array]:
    """Return outputs (K, n_c) and Jacobians (K, n_c, n_y) of the object at every knot.

    Args:
        lifted: the object.
        y: (K, n_y) knot variables: x, x', x'', of each grasp force and moment.
        period: T [s].
        bare: whether there are forces only.
    """
    if bare:
        return _outputs(lifted, y, period), _slopes(lifted, y, period)
    # Forces and moments take turns in y.
    wrenches = y[:, 18:].reshape(len(y), -1, 2, 3)
    forces, moments = (wrenches[:, :, i].reshape(len(y), -1) for i in (0, 1))
    without_moments = np.hstack([y[:, :18], forces])
    slopes = _wrench_slopes(lifted, y, _slopes(lifted, without_moments, period))
    return _outputs(lifted, without_moments, period, moments), slopes


def _outputs(lifted: LiftedObject, y: Array, period: float, moments: Array | None = None) -> Array:
    moved = object_trajectory(lifted, y[:, :6], y[:, 6:12] / period, y[:, 12:18] / period**2, y[:, 18:], moments)
    return np.hstack([moved.wrench, moved.grasp_position.reshape(len(y), -1)])


def _slopes(lifted: LiftedObject, y: Array, period: float) -> Array:
    """Return the Jacobians (K, n_c, n_y): Pinocchio's by the free-flyer's motion, times that motion's by y."""
    model, data = lifted.model, lifted.model.createData()
    rotation, spin = attitude(y[:, 3:6])
    back = rotation.swapaxes(1, 2)
    # The motion (q in its tangent space, v, a) by x, x', x''.
    motion = np.zeros((len(y), 18, 18))
    motion[:, 0:3, 0:3], motion[:, 3:6, 3:6] = back, spin
    nudged = y[:, None, :18] + 1j * STEP * np.eye(18)
    _, v, a = free_flyer_state(nudged[..., :6], nudged[..., 6:12] / period, nudged[..., 12:] / period**2)
    motion[:, 6:12], motion[:, 12:] = v.imag.swapaxes(1, 2) / STEP, a.imag.swapaxes(1, 2) / STEP
    turning = attitude(nudged[:, 3:6, 3:6])[0].imag / STEP  # dR by roll, pitch, yaw

    q, v, a = free_flyer_state(y[:, :6], y[:, 6:12] / period, y[:, 12:18] / period**2)
    generalized, by_motion = np.zeros((len(y), OBJECT_SIZE)), np.zeros((len(y), OBJECT_SIZE, 18))
    for k in range(len(y)):
        generalized[k] = pin.rnea(model, data, q[k], v[k], a[k])
        by_motion[k] = np.hstack(pin.computeRNEADerivatives(model, data, q[k], v[k], a[k]))
    by_motion[:, :, 12:] = mirrored(by_motion[:, :, 12:])
    levers = [model.frames[model.getFrameId(name)].placement.translation for name in lifted.grasp_frames]
    jacobian = np.zeros((len(y), OBJECT_SIZE + 3 * len(levers), y.shape[1]))
    jacobian[:, :OBJECT_SIZE, :18] = by_motion @ motion
    jacobian[:, :3] = rotation @ jacobian[:, :3]
    jacobian[:, :3, 3:6] += np.einsum("kaij,kj->kia", turning, generalized[:, :3])
    for i, lever in enumerate(levers):
        rows, columns = slice(OBJECT_SIZE + 3 * i, OBJECT_SIZE + 3 * i + 3), slice(18 + 3 * i, 21 + 3 * i)
        jacobian[:, :3, columns] = -np.eye(3)
        jacobian[:, 3:OBJECT_SIZE, columns] = -pin.skew(lever) @ back
        jacobian[:, 3:OBJECT_SIZE, 3:6] -= pin.skew(lever) @ np.einsum("kaji,kj->kia", turning, y[:, columns])
        jacobian[:, rows, :3], jacobian[:, rows, 3:6] = np.eye(3), np.einsum("kaij,j->kia", turning, lever)
    return jacobian


def _wrench_slopes(lifted: LiftedObject, y: Array, slopes: Array) -> Array:
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
