"""The planes of one problem on another whose bodies have other sizes: the same rows, of the same points."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from liftopt.collocation.problem import Problem
from liftopt.collocation.separating_planes import SeparatingPlanes, Separation
from liftopt.scenario.model import Scenario
from liftopt.search.cache import SolverCache
from liftopt.search.candidate import Candidate
from liftopt.search.team_solids import TeamSolids
from liftopt.types import Array


def carried_planes(planes: SeparatingPlanes, solids: TeamSolids, onto: TeamSolids) -> SeparatingPlanes:
    """Return planes with the same normals, between the same corners of other solids.

    Args:
        planes: chosen among ``solids``.
        solids: of one team.
        onto: of another, with as many of each kind in the same order.
    """
    number = {pair.told: i for i, pair in enumerate(solids.pairs)}
    wanted = [part.part for part in planes.parts]
    parts = tuple(part for part in onto.parts if part.part in wanted)
    return SeparatingPlanes(parts, tuple(_carried(s, number, solids, onto) for s in planes.separations))


def with_planes_of(cache: SolverCache, candidate: Candidate, scenario: Scenario, problem: Problem) -> Problem:
    """Return the problem of a scenario with the planes of a candidate, if that one has some; their rows are the same.

    Args:
        cache: where solids come from.
        candidate: of a team of the same kind, on the problem's mesh.
        scenario: of the problem.
        problem: without planes.
    """
    planes = candidate.problem.planes
    if planes is None:
        return problem
    solids = cache.solids(candidate.scenario, candidate.problem.team)
    return problem.apart(carried_planes(planes, solids, cache.solids(scenario, problem.team)))


def _carried(rows: Separation, number: dict[str, int], solids: TeamSolids, onto: TeamSolids) -> Separation:
    points = (rows.point_one.copy(), rows.point_other.copy())
    distance = rows.distance.copy()
    for k, j in np.argwhere(rows.active):
        for point, s in zip(points, solids.ends[number[rows.names[k][j]]], strict=True):
            point[k, j] = onto.points[s, _corner(solids.points[s], point[k, j])]
            distance[k, j] += onto.radius[s] - solids.radius[s]
    return replace(rows, point_one=points[0], point_other=points[1], distance=distance)


def _corner(points: Array, point: Array) -> int:
    return int(np.linalg.norm(points - point, axis=1).argmin())
