"""Triangles to pixels without a graphics card: which of them is nearest at every pixel, and where in it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from liftopt.types import Array

Index = npt.NDArray[np.int64]
AT_ONCE = 2_000_000  # pixels that are looked at in one go, which bounds the memory
NOTHING = -1


@dataclass(frozen=True)
class Fragments:
    """What is seen at each of H x W pixels.

    Attributes:
        triangle: (H, W) index of the nearest triangle, ``NOTHING`` where there is none.
        weights: (H, W, 3) barycentric coordinates in it.
        depth: (H, W) of it, infinite where there is none.
    """

    triangle: Index
    weights: Array
    depth: Array


def rasterize(corners: Array, size: tuple[int, int], *, both_sides: bool = False) -> Fragments:
    """Return what is seen of triangles whose depth grows away from the eye and is linear on the screen.

    Args:
        corners: (m, 3, 3) x to the right and y down [pixels], depth.
        size: width and height [pixels].
        both_sides: draw those too that turn clockwise to the eye, which are seen from behind.
    """
    width, height = size
    nearest = np.full(width * height, np.inf)
    triangle, weights = np.full(width * height, NOTHING, dtype=np.int64), np.zeros((width * height, 3))
    a, b, c = (corners[:, i, :2] for i in range(3))
    area = _cross(b - a, c - a)  # negative of what turns counter-clockwise, as y is down
    low = np.maximum(np.ceil(np.minimum(np.minimum(a, b), c) - 0.5), 0.0).astype(np.int64)
    high = np.minimum(np.floor(np.maximum(np.maximum(a, b), c) - 0.5), np.array(size) - 1.0).astype(np.int64)
    extent = np.maximum(high - low + 1, 0)
    pixels = extent[:, 0] * extent[:, 1]
    drawn = np.flatnonzero(((np.abs(area) if both_sides else -area) > 1e-12) & (pixels > 0))
    # Shares of b and c, and the depth, are linear on the screen: constant, by x and by y.
    share_b, share_c = (_plane(p - a, q - a, a) for p, q in ((c, b), (b, c)))
    for part in _batches(drawn, pixels):
        count = pixels[part]
        owner = np.repeat(part, count)
        within = np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)
        wide = np.repeat(extent[part, 0], count)
        row = within // wide
        x, y = np.repeat(low[part, 0], count) + within - row * wide, np.repeat(low[part, 1], count) + row
        of_b, of_c = (_at(np.repeat(plane[part], count, axis=0), x, y) for plane in (share_b, share_c))
        inside = np.flatnonzero((of_b >= 0.0) & (of_c >= 0.0) & (of_b + of_c <= 1.0))
        owner, at = owner[inside], y[inside] * width + x[inside]
        of_b, of_c = of_b[inside], of_c[inside]
        depth = (1.0 - of_b - of_c) * corners[owner, 0, 2] + of_b * corners[owner, 1, 2] + of_c * corners[owner, 2, 2]
        np.minimum.at(nearest, at, depth)
        seen = np.flatnonzero(depth <= nearest[at])
        triangle[at[seen]] = owner[seen]
        weights[at[seen]] = np.stack([1.0 - of_b[seen] - of_c[seen], of_b[seen], of_c[seen]], axis=1)
    shape = (height, width)
    return Fragments(triangle.reshape(shape), weights.reshape(*shape, 3), nearest.reshape(shape))


def _cross(u: Array, v: Array) -> Array:
    return np.asarray(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])


def _plane(edge: Array, toward: Array, origin: Array) -> Array:
    """Return (m, 3) constant, slope by x and slope by y of what is 0 along an edge from an origin and 1 at a corner."""
    with np.errstate(divide="ignore", invalid="ignore"):
        by_x, by_y = edge[:, 1], -edge[:, 0]
        rise = by_x * toward[:, 0] + by_y * toward[:, 1]
        by_x, by_y = by_x / rise, by_y / rise
        return np.stack([-by_x * origin[:, 0] - by_y * origin[:, 1], by_x, by_y], axis=1)


def _at(plane: Array, x: Index, y: Index) -> Array:
    """Return the value of planes (P, 3) in the middle of pixels."""
    return np.asarray(plane[:, 0] + plane[:, 1] * (x + 0.5) + plane[:, 2] * (y + 0.5))


def _batches(drawn: Index, pixels: Index) -> Iterator[Index]:
    """Yield triangles in lots of about ``AT_ONCE`` pixels."""
    lots = np.cumsum(pixels[drawn]) // AT_ONCE
    for lot in np.unique(lots):
        yield drawn[lots == lot]
