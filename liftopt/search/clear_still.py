"""One knot at rest with bodies apart: looked at, given planes and solved, with the object at any pose."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from liftopt.collocation.problem import Problem
from liftopt.collocation.separating_planes import SeparatingPlanes
from liftopt.collocation.solvers.banded import Banded, BandedOptions
from liftopt.collocation.solvers.result import Solver
from liftopt.search.feasibility_screen import RELIEF, stronger
from liftopt.search.make_clear import CLEAR, MARGIN, Clearer, Pairs
from liftopt.search.plane_choice import NEAR, PlaneOptions, choose_planes
from liftopt.search.postures import MAX_ITERATIONS, ROUGH, SCALING, TOLERANCE, Posture
from liftopt.search.solid_distances import SolidDistances, solid_distances
from liftopt.types import Array

ROUNDS = 6  # solves of one posture, each with new planes
# Pairs nearer than this to what is allowed get planes [m]: solves and steps along a path are about as long.
NEARBY = 0.06


class ClearStill:
    """What static postures with bodies apart are found with.

    Attributes:
        clearer: of the team, with solvers for one knot.
        postures: solver of static postures without planes, with somewhat more strength.
    """

    def __init__(self, clearer: Clearer, problem: Problem) -> None:
        """Get ready.

        Args:
            clearer: of the team.
            problem: of one knot at rest, with the team's strength.
        """
        self.postures = stronger(problem, RELIEF)
        self.clearer = replace(clearer, solver=self.solver)
        self._solvers: dict[bool, Solver] = {}

    def solver(self, problem: Problem) -> Solver:
        """Return the solver for a problem of one knot, with planes or without."""
        kept = self._solvers.get(problem.planes is not None)
        if kept is None or not kept.takes(problem):
            kept = Banded(problem, BandedOptions(TOLERANCE, MAX_ITERATIONS, SCALING, ROUGH))
            self._solvers[problem.planes is not None] = kept
        return kept

    def look(self, problem: Problem, x: Array) -> SolidDistances:
        """Return the distances at a posture, as unknowns ``x`` of a problem of one knot."""
        return solid_distances(self.clearer.solids, problem, problem.unpack(x)[0], NEAR)

    def planes(
        self, found: SolidDistances, pairs: Pairs, margin: float, like: SeparatingPlanes | None = None
    ) -> SeparatingPlanes:
        """Return planes for pairs by number that ask for so much more than the scenario does, see ``choose_planes``."""
        crossing = frozenset(np.flatnonzero(found.distance[0] < self.clearer.asked - CLEAR).tolist())
        options = PlaneOptions(self.clearer.clearance + margin, margin, None, crossing)
        return choose_planes(self.clearer.solids, found, pairs, options, like)

    def cleared(
        self, problem: Problem, x: Array, nearby: float = NEARBY, rounds: int = ROUNDS
    ) -> tuple[Posture | None, float]:
        """Return the clear posture that one near it leads to, with planes from the first solve on, or None.

        With it comes how deep the deepest overlap is, in the posture of those looked at where it is least [m].

        Args:
            problem: of one knot, with the object at a pose.
            x: (n_x,) unknowns to start from.
            nearby: pairs nearer than this to what is allowed get planes [m].
            rounds: solves, each with new planes.
        """
        watched: Pairs = np.array([], dtype=np.int64)
        planes: SeparatingPlanes | None = None
        found = self.look(problem, x)
        room = found.distance[0] - self.clearer.asked
        depth = -float(room.min(initial=np.inf))
        for _ in range(rounds):
            watched = np.union1d(watched, np.flatnonzero(room < nearby))
            planes = self.planes(found, watched, MARGIN, planes)
            apart = problem.apart(planes)
            result = self.solver(apart).solve(x, deadline=self.clearer.deadline, problem=apart, most=MAX_ITERATIONS)
            x, found = result.x, self.look(problem, result.x)
            room = found.distance[0] - self.clearer.asked
            depth = min(depth, -float(room.min(initial=np.inf)))
            if not result.converged:
                break
            if room.min(initial=np.inf) >= -CLEAR:
                return posture_of(problem, x, result.objective), depth
        return None, depth


def posture_of(problem: Problem, x: Array, cost: float) -> Posture:
    """Return the posture that the unknowns of a problem of one knot are."""
    control, force = problem.unpack(x)
    return Posture(control[0], force[0], cost).rounded()
