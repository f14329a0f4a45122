"""Capsules and boxes around the triangles of a body: few, and small together.

Links of a body, and halves of them, are parts; a plane cuts a part where the solids of its halves are smallest
together. Then the two parts that take least more room together are made one, again and again, until there are few and
another step would waste room. Every solid holds all of its part, so that together they hold all of the surface.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations, product

import numpy as np
import numpy.typing as npt

from liftopt.multibody.robots.smallest_capsule import FittedCapsule, principal_axes, rough_volumes, smallest_capsule
from liftopt.types import Array

CUTS = (0.25, 0.5, 0.75)  # of the extent of a part, where it is cut
CRUMB = 0.01  # of it: what is smaller goes with what is nearest
WASTED = 1.06  # of what they were apart: so large a part that is made of two may be
WORTH = 1.03  # times as much room as with cuts: solids without any are taken that need no more
FREE = 10.0  # of a part so fine that it is not cut, this part may be wasted anyhow
ROUGH = 16  # cells along a link's largest extent with a point in each, to compare cuts
MOST_ROUGH = 700  # such points
BOXIER = 0.75  # of a capsule's volume: where boxes are allowed, one that is smaller is taken in its place
HALVED = 5  # times that a large triangle is cut in four so that points lie all over it
# Directions to neighbouring cells.
AROUND = np.array([way for way in product((-1.0, 0.0, 1.0), repeat=3) if any(way)])
THINNEST = 1e-3  # [m]: no edge of a box is shorter


@dataclass(frozen=True)
class FittedBox:
    """A box of ``size`` (3,) [m] along the axes of ``placement`` (4, 4), at its centre."""

    placement: Array
    size: Array

    @property
    def volume(self) -> float:
        """[m^3]."""
        return float(np.prod(self.size))


@dataclass(frozen=True)
class Surface:
    """Triangles with a number each that says what they are of.

    Attributes:
        corners: (m, 3, 3) [m].
        owner: (m,) number of each.
    """

    corners: Array = field(repr=False)
    owner: npt.NDArray[np.int64] = field(repr=False)

    @cached_property
    def points(self) -> Array:
        """(n, 3) all corners."""
        return np.asarray(self.corners.reshape(-1, 3))

    @cached_property
    def rough(self) -> Array:
        """(n, 3) points all over the surface, about one in each of ``ROUGH`` cells along its largest extent."""
        low, extent = self.points.min(axis=0), float(np.ptp(self.points, axis=0).max())
        cell, corners, found = max(extent / ROUGH, 1e-9), self.corners, [self.points]
        for _ in range(HALVED):
            first, second, third = (corners[:, i] for i in range(3))
            edges = np.linalg.norm(np.stack([first - second, second - third, third - first]), axis=2)
            corners = corners[edges.max(axis=0) > cell]
            first, second, third = (corners[:, i] for i in range(3))
            ab, bc, ca = (first + second) / 2.0, (second + third) / 2.0, (third + first) / 2.0
            found += [ab, bc, ca]
            quarters = [(first, ab, ca), (ab, second, bc), (ca, bc, third), (ab, bc, ca)]
            corners = np.concatenate([np.stack(quarter, axis=1) for quarter in quarters])
        points = np.concatenate(found)
        cells = np.floor((points - low) / cell).astype(np.int64)
        chosen = np.unique(cells @ (1, 1000, 1000000), return_index=True)[1]
        return np.asarray(points[chosen])

    def of(self, owner: int) -> Surface:
        """Return what is of one owner."""
        return Surface(self.corners[self.owner == owner], self.owner[self.owner == owner])

    def with_rough(self, points: Array) -> Surface:
        """Return the same, with some of its points that are known already."""
        vars(self)["rough"] = points
        return self

    @property
    def main_owner(self) -> int:
        """Of most of the surface."""
        first, second, third = (self.corners[:, i] for i in range(3))
        areas = np.linalg.norm(np.cross(second - first, third - first), axis=1)
        return int(np.argmax(np.bincount(self.owner, areas)))

    def cut(self, axis: Array, at: float) -> tuple[Surface, Surface] | None:
        """Return what is on the two sides of the plane axis . p = at, or None where one has nothing."""
        height, rough = self.corners @ axis - at, self.rough @ axis - at
        # Points near the plane count for both sides, where they are on it.
        near = np.abs(rough) < np.ptp(self.rough, axis=0).max() / ROUGH
        rim = self.rough[near] - np.outer(rough[near], axis)
        sides = []
        for sign in (1.0, -1.0):
            ahead = sign * height
            touched = (ahead > 0.0).any(axis=1)
            if not touched.any():
                return None
            corners, origin = _clipped(self.corners[touched], ahead[touched])
            sides.append(
                Surface(corners, self.owner[touched][origin]).with_rough(
                    np.concatenate([self.rough[sign * rough >= 0.0], rim])
                )
            )
        return sides[0], sides[1]


@dataclass(frozen=True)
class SolidFit:
    """How solids are fitted to a body.

    Attributes:
        pieces: into how many its parts are cut at most before some are made one.
        most: solids.
        fine: volume [m^3] of a part that is not cut any more.
        boxes: whether boxes are allowed beside capsules.
    """

    pieces: int
    most: int
    fine: float
    boxes: bool

    def solids(self, surface: Surface) -> list[tuple[FittedCapsule | FittedBox, int]]:
        """Return solids that together hold a surface, the largest first, and of what each is mainly."""
        parts = [self._part(surface.of(owner)) for owner in np.unique(surface.owner)]
        room = sum(part.cost for part in parts)
        parts = self._without_crumbs(parts, CRUMB * room)
        whole, cut = self._joined(parts), self._joined(self._cut(list(parts)))
        chosen = cut if WORTH * self._volume(cut) < self._volume(whole) else whole
        chosen = sorted(chosen, key=lambda part: -part.cost)
        return [(self._solid(part.surface), part.surface.main_owner) for part in chosen]

    def _part(self, surface: Surface) -> _Part:
        return _Part((surface,), surface.rough, self._cost(surface.rough))

    def _cost(self, points: Array) -> float:
        """Return the volume of a solid around points, roughly [m^3]."""
        capsule, box = rough_volumes(points)
        return min(capsule, box / BOXIER) if self.boxes else capsule

    def _volume(self, parts: list[_Part]) -> float:
        """Return the volume of all solids that parts will have, roughly [m^3]."""
        both = [rough_volumes(part.rough) for part in parts]
        return sum(box if self.boxes and box < BOXIER * capsule else capsule for capsule, box in both)

    def _without_crumbs(self, parts: list[_Part], crumb: float) -> list[_Part]:
        while len(parts) > 1:
            parts = sorted(parts, key=lambda part: part.cost)
            if parts[0].cost >= crumb:
                break
            small, *parts = parts
            middle = small.rough.mean(axis=0)
            near = int(np.argmin([np.linalg.norm(part.rough - middle, axis=1).min() for part in parts]))
            parts[near] = self._both(parts[near], small)
        return parts

    def _cut(self, parts: list[_Part]) -> list[_Part]:
        ready: list[_Part] = []
        while parts and len(parts) + len(ready) < self.pieces:
            parts.sort(key=lambda part: part.cost)
            largest = parts.pop()
            halves = None if largest.cost < self.fine else self._halves(largest.surface)
            if halves is None:
                ready.append(largest)
            else:
                parts += [self._part(half) for half in halves]
        return parts + ready

    def _halves(self, surface: Surface) -> tuple[Surface, Surface] | None:
        """Return the two parts of a surface that have the smallest solids together."""
        rough = surface.rough
        best, least = None, np.inf
        for axis in principal_axes(rough):
            height = rough @ axis
            low, high = float(height.min()), float(height.max())
            for share in CUTS:
                at = low + share * (high - low)
                ahead = height >= at
                if 0 < np.sum(ahead) < len(ahead):
                    both = self._cost(rough[ahead]) + self._cost(rough[~ahead])
                    best, least = ((axis, at), both) if both < least else (best, least)
        return None if best is None else surface.cut(*best)

    def _joined(self, parts: list[_Part]) -> list[_Part]:
        """Return parts of which some are made one: those that fit together, and the smallest of too many."""
        alive = dict(enumerate(parts))
        pairs = {(i, j): self._both(a, b) for (i, a), (j, b) in combinations(alive.items(), 2)}
        while pairs:
            waste = {key: both.cost - alive[key[0]].cost - alive[key[1]].cost for key, both in pairs.items()}
            one, other = min(waste, key=lambda key: waste[key])
            both, apart = pairs[one, other], alive[one].cost + alive[other].cost
            if len(alive) <= self.most and both.cost > max(WASTED * apart, apart + self.fine / FREE):
                break
            new = max(alive) + 1
            del alive[one], alive[other]
            pairs = {key: part for key, part in pairs.items() if not {one, other} & set(key)}
            pairs |= {(key, new): self._both(part, both) for key, part in alive.items()}
            alive[new] = both
        return list(alive.values())

    def _both(self, one: _Part, other: _Part) -> _Part:
        points = np.concatenate([one.rough, other.rough])
        if len(points) > MOST_ROUGH:  # the outermost in some directions, and of the others some
            outermost = np.argmax(points @ AROUND.T, axis=0)
            points = np.concatenate([points[outermost], points[:: -(-len(points) // MOST_ROUGH)]])
        return _Part((*one.surfaces, *other.surfaces), points, self._cost(points))

    def _solid(self, surface: Surface) -> FittedCapsule | FittedBox:
        """Return a small solid that holds all of a surface."""
        points = _outermost(surface.points)
        capsule, box = smallest_capsule(points), _smallest_box(points)
        return box if self.boxes and box.volume < BOXIER * capsule.volume else capsule


MOVING, STANDING = SolidFit(4, 3, 1.5e-3, boxes=False), SolidFit(16, 10, 5e-3, boxes=True)


@dataclass(frozen=True)
class _Part:
    """Surfaces that are to have one solid, some points on them, and roughly its volume [m^3]."""

    surfaces: tuple[Surface, ...]
    rough: Array
    cost: float

    @property
    def surface(self) -> Surface:
        """All of them as one."""
        corners, owners = ([getattr(one, what) for one in self.surfaces] for what in ("corners", "owner"))
        return Surface(np.concatenate(corners), np.concatenate(owners)).with_rough(self.rough)


def _smallest_box(points: Array) -> FittedBox:
    """Return the smaller of the boxes along the principal axes and along those of the frame."""
    found = []
    for axes in (principal_axes(points), np.eye(3)):
        own = points @ axes.T
        low, high = own.min(axis=0), own.max(axis=0)
        placement = np.eye(4)
        placement[:3, :3], placement[:3, 3] = axes.T, axes.T @ ((low + high) / 2.0)
        found.append(FittedBox(placement, np.maximum(high - low, THINNEST)))
    return min(found, key=lambda box: box.volume)


def _outermost(points: Array) -> Array:
    """Return the corners of the points' hull: a convex body that holds them holds all."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        return np.asarray(points[ConvexHull(points).vertices])
    except QhullError:  # flat
        return points


def _clipped(corners: Array, ahead: Array) -> tuple[Array, npt.NDArray[np.int64]]:
    """Return what of triangles (m, 3, 3) is ahead of a plane, as triangles, and of which triangle each is.

    Args:
        corners: of triangles that have a corner ahead.
        ahead: (m, 3) of each corner, how far ahead it is.
    """
    behind = ahead <= 0.0
    count = behind.sum(axis=1)
    found, origin = [corners[count == 0]], [np.flatnonzero(count == 0)]
    for how_many in (1, 2):
        chosen = np.flatnonzero(count == how_many)
        # The corner that is alone on its side comes first.
        alone = np.argmax(behind[chosen] if how_many == 1 else ~behind[chosen], axis=1)
        order = (alone[:, None] + np.arange(3)) % 3
        a, b, c = np.moveaxis(np.take_along_axis(corners[chosen], order[:, :, None], axis=1), 1, 0)
        of_a, of_b, of_c = np.take_along_axis(ahead[chosen], order, axis=1).T[:, :, None]
        on_ab, on_ac = a + of_a / (of_a - of_b) * (b - a), a + of_a / (of_a - of_c) * (c - a)
        pieces = [(on_ab, b, c), (on_ab, c, on_ac)] if how_many == 1 else [(a, on_ab, on_ac)]
        found += [np.stack(piece, axis=1) for piece in pieces]
        origin += [chosen] * len(pieces)
    return np.concatenate(found), np.concatenate(origin)
