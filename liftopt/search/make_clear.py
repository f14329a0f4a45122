"""One optimum made clear: planes where solids overlap or nearly do, and solves with them until nothing does.

The free optimum says which pairs need planes and where. Each solve is followed by new planes at the motion that it led
to, which it keeps to: so from the second round on the objective falls, and a few rounds are enough.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from liftopt.collocation.problem import Problem
from liftopt.collocation.separating_planes import SeparatingPlanes
from liftopt.collocation.solvers.deadline import Deadline
from liftopt.collocation.solvers.result import Solver, SolverResult
from liftopt.collocation.spline import RestToRestSpline
from liftopt.collocation.transfer import transfer_multipliers
from liftopt.search.candidate import Candidate
from liftopt.search.plane_choice import NEAR, PlaneOptions, choose_planes
from liftopt.search.solid_distances import SolidDistances, solid_distances
from liftopt.search.team_solids import TeamSolids
from liftopt.types import Array

Pairs = npt.NDArray[np.int64]
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
ITERATIONS = 100  # of a solve: what converges takes fewer


@dataclass(frozen=True, eq=False)
class Attempt:
    """What came of making an optimum clear.

    Attributes:
        origin: the optimum.
        candidate: clear, or the last that was tried.
        clear: whether it is.
        deep: numbers of the pairs that overlapped at first.
    """

    origin: Candidate
    candidate: Candidate
    clear: bool
    deep: frozenset[int]


def planes_along(
    solids: TeamSolids,
    problem: Problem,
    x: Array,
    pairs: Pairs,
    clearance: float,
    margin: float = MARGIN,
    crossing: frozenset[int] = frozenset(),
    like: SeparatingPlanes | None = None,
) -> SeparatingPlanes:
    """Return planes for pairs by number, at the knots of a motion ``x`` (n_x,) of a problem.

    Args:
        solids: of the problem's team.
        problem: on whose knots.
        x: the motion.
        pairs: that get rows.
        clearance: that the scenario asks for [m].
        margin: that they ask for beside it [m].
        crossing: pairs that overlap.
        like: planes whose structure is kept where it is large enough.
    """
    knots = solid_distances(solids, problem, problem.mesh.basis[0] @ problem.unpack(x)[0], NEAR, pairs)
    return choose_planes(
        solids, knots, pairs, PlaneOptions(clearance + margin, margin, knot_times(problem), crossing), like
    )


def knot_times(problem: Problem) -> Array:
    """Return the times (K,) of a problem's knots [s]."""
    return np.asarray(problem.mesh.phase * problem.task.duration)


def pairs_in(solids: TeamSolids, planes: SeparatingPlanes | None) -> Pairs:
    """Return the numbers of the pairs that have rows."""
    names = {name for pair in planes.separations for at in pair.names for name in at} if planes else set()
    return np.flatnonzero([pair.told in names for pair in solids.pairs])


@dataclass(frozen=True, eq=False)
class Clearer:
    """Makes optima of one team clear.

    Attributes:
        solids: of the team and of what stands around.
        clearance: least distance [m].
        deadline: past which solvers stop.
        solver: gives a solver for a problem.
    """

    solids: TeamSolids
    clearance: float
    deadline: Deadline
    solver: Callable[[Problem], Solver]

    @cached_property
    def asked(self) -> Array:
        """(P,) least distance of each pair [m]."""
        return np.array([pair.asked(self.clearance) for pair in self.solids.pairs])

    def look(self, problem: Problem, spline: RestToRestSpline, x: Array) -> tuple[SolidDistances, Array]:
        """Return distances at the knots, and the least of each pair (P,) at any time, as far as they may matter [m]."""
        control = problem.unpack(x)[0]
        knots = solid_distances(self.solids, problem, problem.mesh.basis[0] @ control, NEAR)
        passing = np.flatnonzero(knots.distance.min(axis=0) < self.asked + PASSING)
        phase = np.linspace(0.0, 1.0, FINER * spline.intervals + 1)
        between = solid_distances(
            self.solids, problem, spline.basis(phase) @ control, self.clearance + WATCHED, passing
        )
        return knots, np.asarray(between.distance.min(axis=0))

    def is_clear(self, least: Array) -> bool:
        """Whether all pairs are as far apart as the scenario asks, given the least distance of each (P,)."""
        return bool((least - self.asked).min(initial=np.inf) >= -CLEAR)

    def make_clear(
        self,
        candidate: Candidate,
        polish: bool = True,
        avoided: frozenset[int] = frozenset(),
        also: frozenset[int] = frozenset(),
    ) -> Attempt:
        """Return the clear optimum that a candidate leads to; itself if it is clear.

        Args:
            candidate: an optimum, with planes or without, or a motion to start from, which did not converge.
            polish: new planes until the objective falls no more; else the first clear motion will do.
            avoided: pairs whose first choice of a side led nowhere.
            also: pairs that get planes though they may be apart.
        """
        now, clear = candidate, None
        watched = np.union1d(pairs_in(self.solids, candidate.problem.planes), sorted(also)).astype(np.int64)
        deep: frozenset[int] = frozenset()
        for turn in range(ROUNDS + 1):
            knots, least = self.look(now.problem, now.spline, now.result.x)
            if turn == 0:
                deep = frozenset(np.flatnonzero(least < self.asked - CLEAR).tolist())
            if self.is_clear(least) and now.result.converged:
                before, clear = clear, now
                objective = now.result.objective
                if before and before.result.objective < objective:
                    clear = before
                settled = before is not None and objective > (1 - SAME) * before.result.objective
                if now.problem.planes is None or settled or not polish:
                    break
            elif clear or turn == ROUNDS:
                break
            watched = np.union1d(watched, np.flatnonzero(least < self.asked + WATCHED))
            crossing = frozenset(np.flatnonzero(least < self.asked - CLEAR).tolist())
            times = knot_times(now.problem)
            now = self._solved(
                now, knots, watched, PlaneOptions(self.clearance + MARGIN, MARGIN, times, crossing, avoided)
            )
            if not now.result.converged:
                break
        return Attempt(candidate, clear or now, clear is not None, deep)

    def _solved(self, now: Candidate, knots: SolidDistances, pairs: Pairs, options: PlaneOptions) -> Candidate:
        """Return what the solver makes of a candidate with new planes."""
        problem, before = now.problem, now.result
        other = problem.apart(choose_planes(self.solids, knots, pairs, options, problem.planes))
        warm = None
        if before.converged:
            same = problem.planes is not None and other.same_structure(problem)
            warm = replace(transfer_multipliers(problem, before.multipliers, other), interpolated=not same)
        result = self.solver(other).solve(before.x, deadline=self.deadline, warm=warm, problem=other, most=ITERATIONS)
        return replace(now, problem=other, result=total(before, result))


def total(before: SolverResult, after: SolverResult) -> SolverResult:
    """Return a result with the work of the one before it."""
    return replace(
        after,
        iterations=before.iterations + after.iterations,
        seconds=before.seconds + after.seconds,
        evaluation_seconds=before.evaluation_seconds + after.evaluation_seconds,
    )
