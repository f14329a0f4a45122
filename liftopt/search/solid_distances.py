"""How far solids are from each other along a motion, pair by pair: signed distances and the directions between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from liftopt.collocation.problem import Problem
from liftopt.search.team_solids import TeamSolids
from liftopt.types import Array


@dataclass(frozen=True, eq=False)
class SolidDistances:
    """Distances at K times.

    Attributes:
        distance: (K, P) signed, negative where two solids overlap, by how far they must move to be apart; infinite
            where they are surely farther apart than was asked [m].
        normal: (K, P, 3) unit vector from the second solid of the pair to the first; zero where that is not known.
        placements: (K, S, 4, 4) of the bodies of the solids.
        points: (K, S, 8, 3) corners of the hulls in the world.
    """

    distance: Array
    normal: Array
    placements: Array
    points: Array


def solid_distances(
    solids: TeamSolids,
    problem: Problem,
    coordinates: Array,
    near: float,
    among: npt.NDArray[np.int64] | None = None,
) -> SolidDistances:
    """Return the distances of all pairs that are nearer than ``near`` [m].

    Args:
        solids: of the team.
        problem: whose layout.
        coordinates: (K, n) of everybody and the object.
        near: what is surely farther apart is not measured.
        among: numbers of the pairs of interest; None: all.
    """
    placements = solids.placements(problem, coordinates)
    points = solids.points @ placements[:, :, :3, :3].swapaxes(2, 3) + placements[:, :, None, :3, 3]
    shape = (len(coordinates), len(solids.pairs))
    distance, normal = np.full(shape, np.inf), np.zeros((*shape, 3))
    middle, around = solids.spheres
    centre = np.einsum("ksab,sb->ksa", placements[:, :, :3, :3], middle) + placements[:, :, :3, 3]
    among = np.arange(shape[1]) if among is None else among
    one, other = solids.ends[among].T
    between = centre[:, one] - centre[:, other]
    apart = np.linalg.norm(between, axis=2)
    close = (apart - around[one] - around[other] < near).any(axis=0)
    among, one, other = among[close], one[close], other[close]
    direction = between[:, close] / np.maximum(apart[:, close, None], 1e-9)
    flat = solids.flat[other]
    direction[:, flat] = [0.0, 0.0, 1.0]
    # Along any direction solids are no farther apart than they are; along this one many are surely far.
    gap = gaps(solids, points, direction, among)
    distance[:, among[flat]], normal[:, among[flat]] = gap[:, flat], [0.0, 0.0, 1.0]
    measure = _Coal(solids, placements)
    for k, n in zip(*np.nonzero((gap < near) & ~flat), strict=True):
        p = among[n]
        distance[k, p], normal[k, p] = measure(int(k), *map(int, solids.ends[p]))
    return SolidDistances(distance, normal, placements, points)


def gaps(solids: TeamSolids, points: Array, direction: Array, pairs: npt.NDArray[np.int64]) -> Array:
    """Return how far pairs (K, P) are apart along directions (K, P, 3) towards the first; the distance is the most.

    Args:
        solids: of the team.
        points: (K, S, 8, 3) corners of their hulls in the world.
        direction: unit vectors.
        pairs: numbers of the P pairs.
    """
    one, other = solids.ends[pairs].T
    low = np.einsum("kpca,kpa->kpc", points[:, one], direction).min(axis=2)
    high = np.einsum("kpca,kpa->kpc", points[:, other], direction).max(axis=2)
    return np.asarray(low - high - solids.radius[one] - solids.radius[other])


class _Coal:
    """Signed distances by coal, with the direction to the first of two solids."""

    def __init__(self, solids: TeamSolids, placements: Array) -> None:
        import coal

        self._coal, self._request, self._result = coal, coal.DistanceRequest(), coal.DistanceResult()
        self._shapes = solids.geometries
        self._T_world_solid = placements @ np.array([solid.T_joint_solid for solid in solids.solids])
        self._placed: dict[tuple[int, int], Any] = {}

    def __call__(self, k: int, one: int, other: int) -> tuple[float, Array]:
        self._result.clear()
        first, second = self._at(k, one), self._at(k, other)
        distance = self._coal.distance(
            self._shapes[one], first, self._shapes[other], second, self._request, self._result
        )
        return float(distance), -np.asarray(self._result.normal)

    def _at(self, k: int, s: int) -> Any:
        if (k, s) not in self._placed:
            T = self._T_world_solid[k, s]
            self._placed[k, s] = self._coal.Transform3s(T[:3, :3], T[:3, 3])
        return self._placed[k, s]
