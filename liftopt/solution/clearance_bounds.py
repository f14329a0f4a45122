"""Bounds on the distances of many pairs of solids at many times at once, so that coal is asked for few."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from liftopt.multibody.solids import Solid
from liftopt.types import Array

Indices = npt.NDArray[np.int64]
SAMPLES = 5  # points along the axis of a capsule that stand in for it against a box


@dataclass(frozen=True)
class PlacedSolids:
    """S solids at K times.

    Attributes:
        solids: their shapes.
        rotation: (S, K, 3, 3) of each solid's axes in the world.
        position: (S, K, 3) of its origin in the world [m].
    """

    solids: Sequence[Solid]
    rotation: Array
    position: Array

    @cached_property
    def radius(self) -> Array:
        """(S,) of the capsules; 0 for others [m]."""
        return np.array([solid.radius for solid in self.solids])

    @cached_property
    def half_axis(self) -> Array:
        """(S, K, 3) from the origin to the end of a capsule's axis in the world; 0 for others [m]."""
        half = np.array([solid.size[1] / 2.0 if solid.kind == "capsule" else 0.0 for solid in self.solids])
        return np.asarray(self.rotation[..., 2] * half[:, None, None])

    @cached_property
    def half_edges(self) -> Array:
        """(S, 3) half the edges of the boxes; 0 for others [m]."""
        return np.array([np.array(solid.size) / 2.0 if solid.kind == "box" else np.zeros(3) for solid in self.solids])

    @cached_property
    def around(self) -> Array:
        """(S,) radius of the smallest sphere about the origin that holds the solid [m]; infinite for a half-space."""
        return np.array([
            np.inf if solid.kind == "half-space" else float(np.linalg.norm(solid.size)) / 2.0
            if solid.kind == "box" else solid.size[0] + solid.size[1] / 2.0 for solid in self.solids
        ])  # fmt: skip

    @cached_property
    def inside(self) -> Array:
        """(S,) radius of the largest sphere about the origin within the solid [m]; 0 for a half-space."""
        return np.array([
            min(solid.size) / 2.0 if solid.kind == "box" else solid.radius for solid in self.solids
        ])  # fmt: skip


def sphere_bounds(placed: PlacedSolids, one: Indices, other: Indices) -> tuple[Array, Array]:
    """Return lower and upper bounds (P, K) on the distances of pairs, by spheres around and within the solids [m].

    Args:
        placed: all solids.
        one: (P,) index of the first solid of each pair.
        other: (P,) of the second.
    """
    apart = np.zeros((len(one), placed.position.shape[1]))
    for axis in np.ascontiguousarray(placed.position.transpose(2, 0, 1)):  # one at a time takes half the time
        apart += np.square(axis[one] - axis[other])
    np.sqrt(apart, out=apart)
    below = apart - (placed.around[one] + placed.around[other])[:, None]
    above = apart - (placed.inside[one] + placed.inside[other])[:, None]
    for floor, solid in ((one, other), (other, one)):
        for row in np.flatnonzero(np.isinf(placed.around[floor])):
            exact = _above(placed, int(floor[row]), int(solid[row]))
            below[row], above[row] = exact, exact
    return below, above


def tight_bounds(placed: PlacedSolids, one: Indices, other: Indices, time: Indices) -> Array:
    """Return better lower bounds (C,) on the distances of single pairs at single times [m].

    Of two capsules it is their distance.

    Args:
        placed: all solids.
        one: (C,) index of the first solid.
        other: (C,) of the second.
        time: (C,) indices of the times.
    """
    bound = np.full(len(time), -np.inf)
    kinds = np.array([solid.kind for solid in placed.solids])
    capsule, box = kinds == "capsule", kinds == "box"
    rows = np.flatnonzero(capsule[one] & capsule[other])
    if rows.size:
        bound[rows] = _capsules(placed, one[rows], other[rows], time[rows])
    for first, second in ((one, other), (other, one)):
        rows = np.flatnonzero(capsule[first] & box[second])
        if rows.size:
            bound[rows] = _capsule_box(placed, first[rows], second[rows], time[rows])
        rows = np.flatnonzero(box[first] & box[second])
        if rows.size:
            centre = placed.position[first[rows], time[rows]][:, None]
            away = _to_box(placed, second[rows], time[rows], centre)[:, 0] - placed.around[first[rows]]
            bound[rows] = np.maximum(bound[rows], away)
    return bound


def _above(placed: PlacedSolids, floor: int, solid: int) -> Array:
    """Return how far a solid is above a half-space (K,)."""
    normal = placed.rotation[floor, :, :, 2]
    height = np.einsum("ki,ki->k", normal, placed.position[solid] - placed.position[floor])
    along = np.abs(np.einsum("ki,ki->k", normal, placed.half_axis[solid]))
    along += np.abs(np.einsum("ki,kij->kj", normal, placed.rotation[solid])) @ placed.half_edges[solid]
    return np.asarray(height - along - placed.radius[solid])


def _capsules(placed: PlacedSolids, one: Indices, other: Indices, time: Indices) -> Array:
    """Return the distances (C,) of capsules: of their axes, less both radii.

    Of two segments: Ericson (2005), Real-Time Collision Detection, section 5.1.9.
    """
    d1, d2 = 2.0 * placed.half_axis[one, time], 2.0 * placed.half_axis[other, time]
    start, other_start = placed.position[one, time] - d1 / 2.0, placed.position[other, time] - d2 / 2.0
    r = start - other_start
    a, b, e = _dot(d1, d1), _dot(d1, d2), _dot(d2, d2)
    c, f = _dot(d1, r), _dot(d2, r)
    tiny = 1e-12
    s = np.clip(_over(b * f - c * e, a * e - b * b, tiny), 0.0, 1.0)
    t = np.clip(_over(b * s + f, e, tiny), 0.0, 1.0)
    s = np.clip(_over(b * t - c, a, tiny), 0.0, 1.0)
    apart = r + s[:, None] * d1 - t[:, None] * d2
    return np.asarray(np.sqrt(_dot(apart, apart)) - placed.radius[one] - placed.radius[other])


def _capsule_box(placed: PlacedSolids, capsule: Indices, box: Indices, time: Indices) -> Array:
    """Return lower bounds (C,): points along the axis, less how far the axis reaches beyond the nearest of them."""
    half = placed.half_axis[capsule, time]
    share = np.linspace(-1.0, 1.0, SAMPLES)
    points = placed.position[capsule, time][:, None] + share[:, None] * half[:, None]
    nearest = _to_box(placed, box, time, points).min(axis=1)
    reach = np.sqrt(_dot(half, half)) / (SAMPLES - 1)
    return np.asarray(nearest - reach - placed.radius[capsule])


def _to_box(placed: PlacedSolids, box: Indices, time: Indices, points: Array) -> Array:
    """Return the distances (C, n) of points (C, n, 3) from boxes, 0 within them."""
    own = np.einsum("cij,cni->cnj", placed.rotation[box, time], points - placed.position[box, time][:, None])
    beyond = np.maximum(np.abs(own) - placed.half_edges[box][:, None], 0.0)
    return np.asarray(np.linalg.norm(beyond, axis=2))


def _dot(left: Array, right: Array) -> Array:
    return np.asarray(np.einsum("ci,ci->c", left, right))


def _over(numerator: Array, denominator: Array, tiny: float) -> Array:
    """Return the quotients, 0 where the denominator is nothing."""
    return np.divide(numerator, denominator, out=np.zeros_like(numerator), where=denominator > tiny)
