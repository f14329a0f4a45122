"""The lifted object from its markers: pose, when it is carried, and the force that its motion takes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from scipy.interpolate import make_interp_spline

from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.rigid import Array, fit_poses, mean_shape, were_seen

AT_REST = 0.005  # m; nearer than this to where it lay, the object has not been lifted yet, or lies again
GRAVITY = np.array([0.0, 0.0, -9.81])


@dataclass(frozen=True)
class ObjectMotion:
    """The object over F frames.

    Attributes:
        position: (F, 3) mean of its markers in the world [m].
        quaternion: (F, 4) x y z w, turn in the world since the first frame.
        acceleration: (F, 3) of the position [m/s^2].
        carried: first and last frame in which it is away from where it lay before and after.
    """

    position: Array
    quaternion: Array
    acceleration: Array
    carried: tuple[int, int]


def object_motion(time: Array, points: Array, source: str) -> ObjectMotion:
    """Return the motion of a rigid object.

    Args:
        time: (F,) [s].
        points: (F, M, 3) its markers in the world, filtered, NaN where not seen [m].
        source: of the recording, for messages.

    Raises:
        InputError: some frames show fewer than three of its markers.
    """
    shape = mean_shape(points)
    known = were_seen(shape)
    poses = fit_poses(shape[known], points[:, known])
    lost = np.flatnonzero(~were_seen(poses.translation))
    if lost.size:
        raise InputError(
            "segments.object", NO_VALUE, f"{source}: fewer than 3 markers in {lost.size} frames, first {lost[0]}"
        )
    position = poses.to_world(shape[known].mean(axis=0))
    turn = poses.rotation @ poses.rotation[0].T
    quaternion = np.array([pin.Quaternion(rotation).coeffs() for rotation in turn])
    acceleration = np.asarray(make_interp_spline(time, position, k=5).derivative(2)(time))
    return ObjectMotion(position, quaternion, acceleration, _carried(position))


def load_force(motion: ObjectMotion, mass: float, share: float) -> Array:
    """Return (F, 3) an estimate of one hand's force on the object: its share of ``m (a - g)`` while it is carried [N].

    It takes the object to hang on the hands alone, from the frame in which it leaves its place to the one in which it
    is put down; a support that still carries part of it is not seen.

    Args:
        motion: of the object.
        mass: of the object [kg].
        share: of the hand, 0 to 1.
    """
    force = np.zeros_like(motion.position)
    carried = slice(motion.carried[0], motion.carried[1] + 1)
    force[carried] = share * mass * (motion.acceleration - GRAVITY)[carried]
    return force


def _carried(position: Array) -> tuple[int, int]:
    last = len(position) - 1
    left = np.flatnonzero(np.linalg.norm(position - position[0], axis=1) > AT_REST)
    arrives = np.flatnonzero(np.linalg.norm(position - position[-1], axis=1) > AT_REST)
    if not left.size:
        return last, last  # it never moved
    return max(int(left[0]) - 1, 0), min(int(arrives[-1]) + 1, last)
