"""Rigid bodies from markers: pose in every frame, mean shape, and the point that two bodies turn about."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from liftopt.types import Array

FEWEST = 3  # markers that make a pose
ROUNDS = 20  # of the mean shape; it moves by less than a micrometre after ten
ON_A_LINE = 1e-3  # m, spread of markers across their line below which their pose is not determined


@dataclass(frozen=True)
class Poses:
    """Pose of one body in F frames, NaN where it is not known.

    Attributes:
        rotation: (F, 3, 3) R_world_body.
        translation: (F, 3) p_world_body [m].
    """

    rotation: Array
    translation: Array

    def to_world(self, point: Array) -> Array:
        """Return (F, 3) where a point (3,) of the body, or one for each frame (F, 3), is in the world [m]."""
        points = np.broadcast_to(point, self.translation.shape)
        return np.asarray(np.einsum("fij,fj->fi", self.rotation, points) + self.translation)

    def to_body(self, points: Array) -> Array:
        """Return (F, ..., 3) points of the world (F, ..., 3) in the body [m]."""
        shape = (len(self.translation),) + (1,) * (points.ndim - 2) + (3,)
        return np.asarray(np.einsum("fji,f...j->f...i", self.rotation, points - self.translation.reshape(shape)))


def were_seen(points: Array) -> npt.NDArray[np.bool_]:
    """Return (...,) True where a point (..., 3) is known."""
    return np.asarray(np.isfinite(points).all(axis=-1))


def fit_poses(shape: Array, points: Array) -> Poses:
    """Return the least-squares poses of a body of known shape (Kabsch 1976), leaving out what was not seen.

    Args:
        shape: (M, 3) markers in the body [m].
        points: (F, M, 3) the same markers in the world, NaN where not seen [m].
    """
    seen = were_seen(points)
    weight = seen[:, :, None] / np.maximum(seen.sum(axis=1), 1)[:, None, None]
    world = np.where(seen[:, :, None], points, 0.0)
    body_mean = np.einsum("fmk,mi->fi", weight, shape)
    world_mean = (weight * world).sum(axis=1)
    body = shape[None] - body_mean[:, None]
    spread = np.einsum("fmi,fmj->fij", weight * body, world - world_mean[:, None])
    u, extent, vt = np.linalg.svd(spread)
    mirror = np.ones((len(points), 3))
    mirror[:, 2] = np.sign(np.linalg.det(np.swapaxes(vt, 1, 2) @ np.swapaxes(u, 1, 2)))
    rotation = np.einsum("fji,fj,fkj->fik", vt, mirror, u)
    translation = world_mean - np.einsum("fij,fj->fi", rotation, body_mean)
    unknown = (seen.sum(axis=1) < FEWEST) | (extent[:, 1] < ON_A_LINE**2)
    rotation[unknown], translation[unknown] = np.nan, np.nan
    return Poses(rotation, translation)


def mean_shape(points: Array) -> Array:
    """Return (M, 3) the mean shape of a body from its markers (F, M, 3) in the world, NaN where not seen [m].

    Generalised Procrustes analysis from the frame with most markers; a marker never seen is NaN. The axes of the body
    are those of the world in that frame, its origin is the markers' mean.
    """
    best = int(np.argmax(were_seen(points).sum(axis=1)))
    seen = were_seen(points[best])
    shape = np.where(seen[:, None], points[best] - points[best][seen].mean(axis=0), np.nan)
    for _ in range(ROUNDS):
        known = were_seen(shape)
        if known.sum() < FEWEST:
            return shape
        local = fit_poses(shape[known], points[:, known]).to_body(points)
        count = were_seen(local).sum(axis=0)
        total = np.nansum(np.where(were_seen(local)[:, :, None], local, 0.0), axis=0)
        shape = np.where(count[:, None] > 0, total / np.maximum(count, 1)[:, None], np.nan)
    return shape


@dataclass(frozen=True)
class CommonPoint:
    """The point that stays nearest to one place in both of two bodies.

    Attributes:
        first, second: (3,) the point in each body [m].
        distance: root mean square distance of the two over the frames [m].
        motion: smallest singular value over the root of the number of frames: how much the bodies turned against each
            other about the axis they turned least about [-]; below about 0.05 the point is ill determined.
    """

    first: Array
    second: Array
    distance: float
    motion: float


def common_point(first: Poses, second: Poses) -> CommonPoint:
    """Return the centre of rotation of two bodies that both move (SCoRE: Ehrig et al. 2006, J Biomech 39:2798-2809)."""
    rows = np.concatenate([first.rotation, -second.rotation], axis=2)
    right = second.translation - first.translation
    known = np.isfinite(rows).all(axis=(1, 2)) & were_seen(right)
    count = int(known.sum())
    if count < FEWEST:  # the two were hardly ever seen together
        return CommonPoint(np.full(3, np.nan), np.full(3, np.nan), float("nan"), 0.0)
    a, b = rows[known].reshape(-1, 6), right[known].reshape(-1)
    x, _, _, singular = np.linalg.lstsq(a, b, rcond=None)
    distance = float(np.sqrt(((a @ x - b) ** 2).sum() / count))
    return CommonPoint(x[:3], x[3:], distance, float(singular[-1] / np.sqrt(count)))
