"""The arm that holds nothing: it hangs.

In the model it is a rigid part of the trunk, with its mass and its shape (``person.bodies``, ``human_shapes``). What is
drawn of it hangs straight down from the shoulder however far the trunk leans, unless the object is in its way.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from liftopt.multibody.person.anthropometry import girth_radius, link_lengths
from liftopt.multibody.person.subject import Subject
from liftopt.types import Array
from liftopt.viz.digits import distance_to_box

FARTHEST = np.radians(100.0)  # that it swings from the trunk
# Sine of the angle by which it swings towards the trunk at most, and how much more where that leans ahead of the legs.
INWARDS, LEANING = 0.03, 0.8
TINY = 1e-9
SHARES = np.linspace(1.0, 0.0, 21)  # of the way to hanging that are tried
ALONG = np.linspace(0.3, 1.0, 12)  # where the arm is looked at, from the shoulder to the fingertips
HAND = 2.1  # length of a hand over the way from wrist to knuckles


def hanging_arm(
    subject: Subject, side: float, T_base_trunk: Array, T_world_trunk: Array, T_object_world: Array, half: Array
) -> Array:
    """Return where the frame of the trunk would be if it were fixed to the hanging arm (K, 4, 4).

    Args:
        subject: whose arm it is.
        side: ``LEFT`` or ``RIGHT``.
        T_base_trunk: (4, 4) the trunk's joint at zero, in the axes of the person upright.
        T_world_trunk: (K, 4, 4) that joint over the lift.
        T_object_world: (K, 4, 4) the world in the object's frame.
        half: (3,) half sizes of the object [m].
    """
    lengths = link_lengths(subject)
    shoulder = np.array([0.0, side * lengths.l3, lengths.l1 + lengths.l2])
    reach = lengths.l4 + lengths.l5 + HAND * lengths.l6
    upright = T_world_trunk @ np.linalg.inv(T_base_trunk)  # the person's axes, carried by the trunk
    down = -upright[:, 2, :3]  # the world's, in those axes
    room = INWARDS + LEANING * np.maximum(down[:, 0], 0.0)
    down[:, 1] = side * np.maximum(side * down[:, 1], -room)
    # The shortest turn from along the trunk to hanging, about an axis that is level in the trunk.
    level = np.maximum(np.hypot(down[:, 0], down[:, 1]), TINY)
    most = np.minimum(np.arctan2(level, -down[:, 2]), FARTHEST) / level
    turns = np.stack([down[:, 1] * most, -down[:, 0] * most, np.zeros(len(down))], axis=-1)[:, None] * SHARES[:, None]
    rotations = Rotation.from_rotvec(turns.reshape(-1, 3)).as_matrix().reshape(*turns.shape, 3)
    along = -rotations[..., 2]
    points = shoulder + reach * ALONG[:, None] * along[:, :, None]
    seen = T_object_world @ upright
    inside = np.einsum("kij,ktsj->ktsi", seen[:, :3, :3], points) + seen[:, None, None, :3, 3]
    apart = distance_to_box(inside, half).min(axis=-1) - girth_radius(subject, "wristcircumference")
    free = apart > 0.0
    chosen = np.where(free.any(axis=1), np.argmax(free, axis=1), np.argmax(apart, axis=1))
    swing = np.tile(np.eye(4), (len(turns), 1, 1))
    swing[:, :3, :3] = rotations[np.arange(len(turns)), chosen]
    swing[:, :3, 3] = shoulder - swing[:, :3, :3] @ shoulder
    return np.asarray(upright @ swing @ T_base_trunk)
