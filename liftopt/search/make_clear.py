"""One optimum made clear: planes where solids overlap or nearly do, and solves with them until nothing does.

The free optimum says which pairs need planes and where. Each solve is followed by new planes at the motion that it led
to, which it keeps to: so from the second round on the objective falls, and a few rounds are enough.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from liftopt.collocation.problem import Problem
from liftopt.collocation.separating_planes import PosePart
from liftopt.collocation.solvers.deadline import Deadline
from liftopt.collocation.solvers.result import Solver, SolverResult
from liftopt.collocation.spline import RestToRestSpline
from liftopt.collocation.transfer import transfer_multipliers
from liftopt.search.candidate import Candidate
from liftopt.search.plane_choice import NEAR, PlaneOptions, choose_planes
from liftopt.search.solid_distances import SolidDistances, solid_distances
from liftopt.search.team_solids import TeamSolids
from liftopt.types import Array

# At the knots planes ask for so much more than the scenario does: solids come nearer between knots [m].
MARGIN = 0.003
# A motion counts as clear where nothing is deeper than this; the verification allows twice as much [m].
CLEAR = 0.0005
# Pairs that come nearer than this to what is allowed get planes too, or the next solve would find them overlapping [m].
WATCHED = 0.02
# Pairs farther apart than this at the knots are not looked at between them [m].
PASSING = 0.06
# Times between knots that are looked at, for each interval.
FINER = 5
# Solves before it gives up; objectives that differ by a smaller share are the same.
ROUNDS, SAME = 6, 1e-3


@dataclass(frozen=True, eq=False)
class Keeper:
    """What keeps a team's solids apart.

    Attributes:
        solids: of the team and of what stands around.
        parts: whose poses planes take.
        clearance: least distance [m].
        deadline: past which solvers stop.
        solver: gives a solver for a problem.
        on_solve: called with every result.
    """

    solids: TeamSolids
    parts: tuple[PosePart, ...]
    clearance: float
    deadline: Deadline
    solver: Callable[[Problem], Solver]
    on_solve: Callable[[SolverResult], None] = lambda result: None

    def look(self, problem: Problem, spline: RestToRestSpline, x: Array) -> tuple[SolidDistances, Array]:
        """Return distances at the knots, and the least of each pair (P,) at any time, as far as they may matter [m]."""
        control = problem.unpack(x)[0]
        knots = solid_distances(self.solids, problem, problem.mesh.basis[0] @ control, NEAR)
        passing = np.flatnonzero(knots.distance.min(axis=0) < self.clearance + PASSING)
        phase = np.linspace(0.0, 1.0, FINER * spline.intervals + 1)
        between = solid_distances(
            self.solids, problem, spline.basis(phase) @ control, self.clearance + WATCHED, passing
        )
        return knots, np.asarray(between.distance.min(axis=0))

    def is_clear(self, least: Array) -> bool:
        """Whether all pairs are as far apart as the scenario asks."""
        return bool(least.min(initial=np.inf) >= self.clearance - CLEAR)

    def make_clear(
        self, candidate: Candidate, polish: bool = True, avoided: frozenset[int] = frozenset()
    ) -> Candidate | None:
        """Return the clear optimum that a candidate leads to; itself if it is clear, None if none was found.

        Args:
            candidate: an optimum, with planes or without.
            polish: new planes until the objective falls no more; else the first clear motion will do.
            avoided: pairs whose first choice of a side led nowhere.
        """
        problem, spline, result = candidate.problem, candidate.spline, candidate.result
        watched = np.zeros(len(self.solids.pairs), dtype=bool)
        clear: Candidate | None = None
        for _ in range(ROUNDS):
            knots, least = self.look(problem, spline, result.x)
            if self.is_clear(least):
                now = replace(candidate, problem=problem, result=result)
                settled = clear is not None and result.objective > (1 - SAME) * clear.result.objective
                if clear is None or result.objective < clear.result.objective:
                    clear = now
                if problem.planes is None or settled or not polish:
                    return clear
            elif clear is not None:
                return clear
            watched |= least < self.clearance + WATCHED
            watched |= self._kept(problem)
            solved = self._solve(problem, knots, np.flatnonzero(watched), result, avoided)
            if solved is None:
                return clear
            problem, result = solved
        return clear

    def _kept(self, problem: Problem) -> npt.NDArray[np.bool_]:
        """Return which pairs have rows in a problem."""
        separations = problem.planes.separations if problem.planes else ()
        names = {name for pair in separations for at in pair.names for name in at}
        return np.array([pair.told in names for pair in self.solids.pairs])

    def _solve(
        self,
        problem: Problem,
        knots: SolidDistances,
        pairs: npt.NDArray[np.int64],
        before: SolverResult,
        avoided: frozenset[int],
    ) -> tuple[Problem, SolverResult] | None:
        options = PlaneOptions(self.clearance + MARGIN, avoided)
        planes = choose_planes(self.solids, self.parts, knots, pairs, options, problem.planes)
        other = problem.apart(planes)
        warm = transfer_multipliers(problem, before.multipliers, other)
        same = problem.planes is not None and other.same_structure(problem)
        result = self.solver(other).solve(
            before.x, deadline=self.deadline, warm=replace(warm, interpolated=not same), problem=other
        )
        self.on_solve(result)
        return (other, result) if result.converged else None
