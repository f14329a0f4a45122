"""Pinocchio's side of the comparison, for S states at a time, in world axes; nothing of the DH recursion is used."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from liftopt.types import Array


@dataclass(frozen=True)
class BodyLoad:
    """A force at a point of one joint's body, and a moment on it, in each of S states.

    Attributes:
        joint: Pinocchio index of the joint that moves the body.
        point: (3,) or (S, 3) where the force acts, in the joint's frame [m].
        force: (S, 3) world axes [N].
        moment: (S, 3) world axes [Nm].
    """

    joint: int
    point: Array
    force: Array
    moment: Array

    def sample(self, index: int) -> tuple[Array, Array, Array]:
        """Return point, force and moment, (3,) each, of one state."""
        point = self.point if self.point.ndim == 1 else self.point[index]
        return point, self.force[index], self.moment[index]


def frame_attachment(model: pin.Model, frame: str) -> tuple[int, Array]:
    """Return the joint that carries a frame and the frame's origin (3,) in that joint's frame [m].

    Raises:
        ValueError: the model has no such frame.
    """
    if not model.existFrame(frame):
        raise ValueError(f"{model.name} has no frame {frame!r}; it has {[f.name for f in model.frames]}")
    found = model.frames[model.getFrameId(frame)]
    return int(found.parentJoint), np.array(found.placement.translation)


def torques(model: pin.Model, q: Array, v: Array, a: Array, loads: Sequence[BodyLoad] = ()) -> Array:
    """Return RNEA's generalized forces (S, nv) under ``loads``, for q (S, nq) and v, a (S, nv)."""
    data = model.createData()
    tau = np.empty_like(v)
    for s in range(len(q)):
        pin.forwardKinematics(model, data, q[s])
        external = [pin.Force.Zero() for _ in range(model.njoints)]
        for load in loads:
            point, force, moment = load.sample(s)
            to_joint = data.oMi[load.joint].rotation.T
            local = to_joint @ force
            external[load.joint] += pin.Force(local, np.cross(point, local) + to_joint @ moment)
        tau[s] = pin.rnea(model, data, q[s], v[s], a[s], external)
    return tau


def point_jacobians(model: pin.Model, q: Array, joint: int, point: Array) -> tuple[Array, Array]:
    """Return positions (S, 3) and Jacobians (S, 6, nv), linear then angular, of a point (3,) of ``joint``'s frame."""
    data = model.createData()
    frame = pin.SE3(np.eye(3), point)
    positions, jacobians = np.empty((len(q), 3)), np.empty((len(q), 6, model.nv))
    for s in range(len(q)):
        pin.computeJointJacobians(model, data, q[s])
        placement = data.oMi[joint] * frame
        aligned = pin.SE3(np.eye(3), placement.translation)
        positions[s] = placement.translation
        jacobians[s] = aligned.toActionMatrixInverse() @ pin.getJointJacobian(model, data, joint, pin.WORLD)
    return positions, jacobians


def newton_euler_balance(
    model: pin.Model, q: Array, v: Array, a: Array, about: Array, loads: Sequence[BodyLoad]
) -> tuple[Array, Array]:
    """Return the force and the moment, (S, 3) each, that the ground must give by the balance of the whole body.

    Force: rate of linear momentum less weight and loads. Moment: rate of angular momentum, moved from the centre of
    mass to ``about`` (S, 3), less the moments of weight and loads. World axes [N, Nm].
    """
    data = model.createData()
    mass = pin.computeTotalMass(model)
    force, moment = np.empty((2, len(q), 3))
    for s in range(len(q)):
        pin.computeCentroidalMomentumTimeVariation(model, data, q[s], v[s], a[s])
        needed = data.dhg.linear - mass * model.gravity.linear
        force[s] = needed
        moment[s] = data.dhg.angular + np.cross(data.com[0] - about[s], needed)
        for load in loads:
            point, applied, couple = load.sample(s)
            arm = data.oMi[load.joint].act(point) - about[s]
            force[s] -= applied
            moment[s] -= couple + np.cross(arm, applied)
    return force, moment
