"""The lifted object from its markers: pose, when it is carried, and the force that its motion takes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pinocchio as pin
from scipy.interpolate import make_interp_spline
from scipy.spatial.transform import Rotation, Slerp

from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.mocap.gaps import runs
from liftopt.lab.mocap.rigid import fit_poses, mean_shape, were_seen
from liftopt.types import Array

AT_REST = 0.005  # m; nearer than this to where it lay, the object has not been lifted yet, or lies again
AT_PLACE = 0.1  # s that it stays there at least, or it passes by
LYING, LYING_FOR = 0.0015, 0.5  # m and s: hands never hold so still for so long, a support does
MOVING = 0.05  # m/s; slower than this when it comes into sight, it lay there before
GRAVITY = np.array([0.0, 0.0, -9.81])


@dataclass(frozen=True)
class ObjectMotion:
    """The object over F frames.

    Attributes:
        position: (F, 3) mean of its markers in the world [m].
        quaternion: (F, 4) x y z w, turn in the world since the first frame.
        acceleration: (F, 3) of the position [m/s^2].
        lifts: first and last frame of each time in which it is away from where it lies before and after.
        unseen: (F,) True where its pose was taken from before and after.
    """

    position: Array
    quaternion: Array
    acceleration: Array
    lifts: tuple[tuple[int, int], ...]
    unseen: npt.NDArray[np.bool_]


def object_motion(time: Array, points: Array, source: str) -> ObjectMotion:
    """Return the motion of a rigid object.

    Where it is out of sight and lies, it lies on.

    Args:
        time: (F,) [s].
        points: (F, M, 3) its markers in the world, filtered, NaN where not seen [m].
        source: of the recording, for messages.

    Raises:
        InputError: it is out of sight (fewer than three markers) while it moves.
    """
    shape = mean_shape(points)
    known = were_seen(shape)
    if known.sum() < 3:
        raise InputError("segments.object", NO_VALUE, f"{source}: no frame shows 3 of its markers")
    poses = fit_poses(shape[known], points[:, known])
    unseen = ~were_seen(poses.translation)
    if (~unseen).sum() < 6:
        raise InputError("segments.object", NO_VALUE, f"{source}: 3 of its markers are seen in hardly any frame")
    position = poses.to_world(shape[known].mean(axis=0))
    rotation = _turns(time, position, poses.rotation, unseen, source)
    position = _positions(time, position, unseen)
    turn = rotation @ rotation[0].T
    quaternion = np.array([pin.Quaternion(one).coeffs() for one in turn])
    acceleration = np.asarray(make_interp_spline(time, position, k=5).derivative(2)(time))
    return ObjectMotion(position, quaternion, acceleration, lifts(time, position), unseen)


def load_force(motion: ObjectMotion, mass: float, share: float) -> Array:
    """Return (F, 3) an estimate of one hand's force on the object: its share of ``m (a - g)`` while it is carried [N].

    It takes the object to hang on the hands alone, from the frame in which it leaves its place to the one in which it
    is put down; a support that still carries part of it is not seen. Between two lifts the force is 0.

    Args:
        motion: of the object.
        mass: of the object [kg].
        share: of the hand, 0 to 1.
    """
    force = np.zeros_like(motion.position)
    for first, last in motion.lifts:
        carried = slice(first, last + 1)
        force[carried] = share * mass * (motion.acceleration - GRAVITY)[carried]
    return force


def lifts(time: Array, position: Array) -> tuple[tuple[int, int], ...]:
    """Return first and last frame of each lift: the object is away from all places where it lies.

    It lies where it is at the start and at the end, wherever it does not move by 1.5 mm for half a second, and
    whenever it is at one of these places for a tenth of a second.
    """
    step, last = float(np.median(np.diff(time))), len(position) - 1
    still = _still(position, max(round(LYING_FOR / step), 2))
    places = [position[0], position[-1], *(np.median(position[a : b + 1], axis=0) for a, b in runs(still))]
    at_place = still | (np.min([np.linalg.norm(position - place, axis=1) for place in places], axis=0) <= AT_REST)
    away = ~at_place
    for first, end in runs(at_place):
        if first > 0 and end < last and (end - first + 1) * step < AT_PLACE:
            away[first : end + 1] = True
    return tuple((max(first - 1, 0), min(end + 1, last)) for first, end in runs(away) if (end - first + 1) > 2)


def _still(position: Array, window: int) -> npt.NDArray[np.bool_]:
    """Return (F,) True in all windows of so many frames in which it keeps its place."""
    still = np.zeros(len(position), bool)
    if len(position) < window:
        return still
    views = np.lib.stride_tricks.sliding_window_view(position, window, axis=0)
    for start in np.flatnonzero(np.linalg.norm(np.ptp(views, axis=2), axis=1) < LYING):
        still[start : start + window] = True
    return still


def _turns(time: Array, position: Array, rotation: Array, unseen: npt.NDArray[np.bool_], source: str) -> Array:
    """Return (F, 3, 3) with the frames filled in which the object is out of sight."""
    seen = np.flatnonzero(~unseen)
    for first, last in runs(unseen):
        before, after = seen[seen < first], seen[seen > last]
        ends = [side for side in (before[-3:], after[:3]) if side.size]
        moving = any(_speed(time, position, side) > MOVING for side in ends)
        if len(ends) == 2 and not moving:
            moving = bool(np.linalg.norm(position[after[0]] - position[before[-1]]) > AT_REST)
        if moving:
            raise InputError(
                "segments.object",
                NO_VALUE,
                f"{source}: fewer than 3 markers in {last - first + 1} frames, first {first} ({time[first]:.2f} to "
                f"{time[last]:.2f} s), in which the object moves; cut the trial with --from and --to",
            )
    if not unseen.any():
        return rotation
    whole = Slerp(time[seen], Rotation.from_matrix(rotation[seen]))
    return np.asarray(whole(np.clip(time, time[seen[0]], time[seen[-1]])).as_matrix())


def _positions(time: Array, position: Array, unseen: npt.NDArray[np.bool_]) -> Array:
    seen, whole = np.flatnonzero(~unseen), position.copy()
    if not unseen.any():
        return position
    for first, last in runs(unseen):
        before, after = seen[seen < first], seen[seen > last]
        if not before.size or not after.size:
            whole[first : last + 1] = position[after[0] if after.size else before[-1]]
        else:
            share = (time[first : last + 1] - time[before[-1]]) / (time[after[0]] - time[before[-1]])
            way = position[after[0]] - position[before[-1]]
            whole[first : last + 1] = position[before[-1]] + share[:, None] * way
    return whole


def _speed(time: Array, position: Array, frames: npt.NDArray[np.intp]) -> float:
    if len(frames) < 2:
        return 0.0
    return float(np.linalg.norm(position[frames[-1]] - position[frames[0]]) / (time[frames[-1]] - time[frames[0]]))
