"""Outputs and slopes of the pose kernels, recomputed with Pinocchio in double precision."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from liftopt.collocation.pose_kernels import POSE_SIZE
from liftopt.multibody.agent import Agent
from liftopt.multibody.trajectory import attitude
from liftopt.types import Array

# A step along the imaginary axis gives a derivative without a difference, so it can be as small as this.
STEP = 1e-30


def link_poses(agent: Agent, joints: tuple[int, ...], q: Array) -> tuple[Array, Array]:
    """Return position and rotation, by columns, of some joints (K, 12 m) at q (K, n), and their slopes (K, 12 m, n)."""
    model = agent.reduced()
    data = model.createData()
    outputs = np.zeros((len(q), len(joints), POSE_SIZE))
    slopes = np.zeros((len(q), len(joints), POSE_SIZE, model.nv))
    for k, at in enumerate(q):
        pin.computeJointJacobians(model, data, at)
        for i, joint in enumerate(joints):
            pose = data.oMi[joint]
            # Of one joint it is flat.
            jacobian = pin.getJointJacobian(model, data, joint, pin.LOCAL_WORLD_ALIGNED).reshape(6, -1)
            outputs[k, i] = np.concatenate([pose.translation, pose.rotation.ravel("F")])
            slopes[k, i, :3] = jacobian[:3]
            # A turn w moves each column of the rotation by w x column.
            columns = np.cross(jacobian[3:].T[None], pose.rotation.T[:, None])
            slopes[k, i, 3:] = columns.transpose(0, 2, 1).reshape(9, -1)
    size = POSE_SIZE * len(joints)
    return outputs.reshape(len(q), size), slopes.reshape(len(q), size, -1)


def object_pose(x: Array) -> tuple[Array, Array]:
    """Return position and rotation, by columns, of the object (K, 12) at x (K, 6), and their slopes (K, 12, 6)."""
    rotation = attitude(x[:, 3:])[0]
    turning = attitude(x[:, None, 3:] + 1j * STEP * np.eye(3))[0].imag / STEP  # dR by roll, pitch, yaw
    slopes = np.zeros((len(x), POSE_SIZE, 6))
    slopes[:, :3, :3] = np.eye(3)
    slopes[:, 3:, 3:] = turning.transpose(0, 3, 2, 1).reshape(len(x), 9, 3)
    return np.hstack([x[:, :3], rotation.transpose(0, 2, 1).reshape(len(x), 9)]), slopes
