"""Where bodies are in the world at many postures, by Pinocchio in double precision."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from liftopt.multibody.trajectory import attitude
from liftopt.types import Array


def joint_placements(model: pin.Model, q: Array, joints: Sequence[int]) -> Array:
    """Return T_world_joint (K, m, 4, 4) of m joints, by index, at postures ``q`` (K, n)."""
    data, found = model.createData(), np.empty((len(q), len(joints), 4, 4))
    for row, places in zip(q, found, strict=True):
        pin.forwardKinematics(model, data, row)
        for joint, place in zip(joints, places, strict=True):
            place[:] = data.oMi[joint].homogeneous
    return found


def object_placements(pose: Array) -> Array:
    """Return T_world_object (K, 4, 4) at poses (K, 6): x, y, z, then roll, pitch and yaw with R = Rx Ry Rz."""
    found = np.zeros((len(pose), 4, 4))
    found[:, :3, :3] = attitude(pose[:, 3:])[0]
    found[:, :3, 3], found[:, 3, 3] = pose[:, :3], 1.0
    return found
