"""What would make a lift possible: the smallest change of one value of the scenario, found by solving with it.

Each change grows until a lift is found. Then it is bisected towards the scenario as it was; each solve starts from the
last that worked. What is reported was solved and verified with that very value. That a smaller change does not help is
not proven.
"""

from __future__ import annotations

import numpy as np

from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.result import Multipliers, Solver, SolverResult
from liftopt.collocation.transfer import transfer
from liftopt.errors import InputError, SolverError
from liftopt.scenario.model import Scenario
from liftopt.search.adjustables import Adjustable, adjustables
from liftopt.search.cache import BANDED
from liftopt.search.candidate import Candidate
from liftopt.search.feasibility_screen import too_fast
from liftopt.search.found import Found
from liftopt.search.initial_guess import InitialGuess, posture_starts
from liftopt.search.make_clear import Clearer
from liftopt.search.mesh_refinement import refine_while
from liftopt.search.optimum_on_mesh import planes_of
from liftopt.search.postures import PostureSolver
from liftopt.search.session import Session
from liftopt.solution.infeasibility_report import SuggestedChange
from liftopt.types import Array

STARTS = 2  # of each changed scenario
ITERATIONS = 150  # of each start
ENOUGH = 4  # changes that are suggested
# Work for all changes, and what one search for postures counts as. The unit is the time of one iteration of the solver
# on so many intervals.
WORK, POSTURES, INTERVALS = 3000.0, 70.0, 20
HOLDS = 4.0  # likewise, the check that the object can be held at both ends of a known motion
# Rounds of seeds for postures: more take the work that other changes need (docs/tuning.md).
ROUNDS = 1
GROWTH = 1.6  # of a change that does not help yet
FINEST_CHANGED = 160  # intervals of the finest mesh of a changed scenario


def suggest_changes(session: Session, found: Found, work: float = WORK) -> tuple[SuggestedChange, ...]:
    """Return changes that make a scenario solvable, each solved and verified, the smallest first.

    Args:
        session: of the search; past its deadline no more is tried.
        found: what comes nearest to a lift, and why it is none.
        work: after which no more is tried, see ``WORK``.
    """
    trials, scenario = _Trials(session, found, work), session.scenario
    changes: list[SuggestedChange] = []
    hints = [(adjustable, adjustable.hint(scenario, found.reasons)) for adjustable in adjustables(scenario)]
    helpful = [(adjustable, hint) for adjustable, hint in hints if hint]
    for i, (adjustable, hint) in enumerate(helpful):
        if not trials.go_on(0.0) or len(changes) == ENOUGH:
            break
        what = " and ".join(adjustable.keys)
        session.progress(f"looking for the smallest change that helps: {what} ({i + 1} of {len(helpful)})")
        change = _smallest(trials, adjustable, hint, trials.left - 2 * trials.left / (len(helpful) - i + 1))
        changes += [change] if change else []
    return tuple(sorted(changes, key=lambda change: change.size))


def _smallest(trials: _Trials, adjustable: Adjustable, hint: int, rest: float) -> SuggestedChange | None:
    """Return the smallest change of an adjustable that leads to a verified lift; ``hint`` steps are tried first.

    ``rest`` of the work is left to others.
    """
    candidate, steps, fails, sign = None, min(hint, adjustable.most), 0, 0
    while candidate is None and fails < adjustable.most and trials.go_on(rest):
        for sign in adjustable.signs:
            candidate = trials.solve(adjustable, sign * steps)
            if candidate:
                break
        else:
            fails, steps = steps, min(int(GROWTH * steps) + 1, adjustable.most)
    if candidate is None:
        return None
    helps = steps
    while helps - fails > 1 and trials.go_on(rest):
        middle = (helps + fails) // 2
        nearer = trials.solve(adjustable, sign * middle, candidate)
        candidate, helps, fails = (nearer, middle, fails) if nearer else (candidate, helps, middle)
    return _suggested(trials.scenario, adjustable, sign, candidate.scenario) if trials.verify(candidate) else None


def _suggested(scenario: Scenario, adjustable: Adjustable, sign: int, changed: Scenario) -> SuggestedChange:
    """Return a change that helps, in words and by its size."""
    was, values = adjustable.values(scenario), adjustable.values(changed)
    change = abs(values[0] - was[0])
    words = (adjustable.less if sign < 0 else adjustable.more).format(change=change, value=values[0])
    if "{value" in (adjustable.less or adjustable.more):
        words += f", not {was[0]:g}"
    size = change / (adjustable.usual * (was[0] if adjustable.relative else 1.0))
    return SuggestedChange(adjustable.keys, values, words, round(size, 6))


class _Trials:
    """Solves of changed scenarios, as many as the work allows."""

    def __init__(self, session: Session, found: Found, work: float) -> None:
        self.session, self.scenario, self.found, self.left = session, session.scenario, found, work

    def go_on(self, rest: float) -> bool:
        """Whether more work is left than ``rest``, and time."""
        return self.left > rest and not self.session.deadline.passed

    def solve(self, adjustable: Adjustable, steps: int, near: Candidate | None = None) -> Candidate | None:
        """Return a converged candidate of the changed scenario, or None; ``near`` is that of a similar change."""
        scenario = adjustable.changed(self.scenario, steps)
        if scenario is None:
            return None
        cache, spline = self.session.cache, self.found.spline
        try:
            problem = cache.problem(scenario, spline)
        except InputError:  # the change leaves what a model can be
            return None
        if too_fast(problem):
            return None

        def solved(start: InitialGuess, problem: Problem = problem, warm: Candidate | None = None) -> Candidate | None:
            result = self._solve(problem, scenario, start.x, warm.result.multipliers if warm else None)
            candidate = self._clear(Candidate(scenario, problem, spline, start.name, result))
            return candidate if candidate.result.converged and candidate.usable else None

        postures = cache.postures(problem, scenario)
        if near and near.problem.same_unknowns(problem):
            kept = problem.apart(planes_of(cache, near, scenario, problem)) if near.problem.planes else problem
            if kept.same_structure(near.problem):
                holds = self._holds(postures, problem, near)
                return solved(InitialGuess("near", near.result.x), kept, near) if holds else None
        deadline, seed = self.session.deadline, scenario.solver.seed
        starts = posture_starts(problem, STARTS, seed, deadline, postures=postures, rounds=ROUNDS)
        self.left -= POSTURES
        if starts:
            lower, upper = problem.bounds()
            fitting = [x for x in self.found.near if x.shape == lower.shape]
            starts += [InitialGuess("near", np.clip(x, lower, upper)) for x in fitting]
        return next(filter(None, map(solved, starts)), None)

    def verify(self, candidate: Candidate) -> bool:
        """Whether a candidate is verified, on finer meshes if it takes them."""

        def refine(coarse: Candidate, intervals: int) -> Candidate:
            spline, scenario = coarse.spline.on(intervals), coarse.scenario
            problem = self.session.cache.problem(scenario, spline)
            x = transfer(coarse.problem, coarse.spline, coarse.result.x, problem, spline)
            return self._clear(Candidate(scenario, problem, spline, coarse.start, self._solve(problem, scenario, x)))

        deadline = self.session.deadline
        return refine_while(candidate, lambda coarse: coarse.refinable, refine, deadline, FINEST_CHANGED).solved

    def _clear(self, candidate: Candidate) -> Candidate:
        """Return a candidate made clear, where its scenario asks for it and it can be; count it as work."""
        scenario, problem = candidate.scenario, candidate.problem
        clearance = scenario.limits.clearance
        if clearance is None or not candidate.result.converged:
            return candidate
        solids = self.session.cache.solids(scenario, problem.team)
        clearer = Clearer(solids, clearance, self.session.deadline, lambda given: self._solver(given, scenario))
        attempt = clearer.make_clear(candidate, polish=False).candidate
        more = attempt.result.iterations - candidate.result.iterations
        self.left -= more * candidate.spline.intervals / INTERVALS
        return attempt

    def _solve(self, problem: Problem, scenario: Scenario, x: Array, warm: Multipliers | None = None) -> SolverResult:
        """Solve from ``x`` (n_x,), and count it as work."""
        solver, deadline = self._solver(problem, scenario), self.session.deadline
        result = solver.solve(x, deadline=deadline, warm=warm, problem=problem, most=ITERATIONS)
        self.left -= result.iterations * (len(problem.mesh.phase) - 1) / INTERVALS
        return result

    def _solver(self, problem: Problem, scenario: Scenario) -> Solver:
        try:
            return self.session.cache.solver(problem, scenario, BANDED)
        except SolverError:
            return self.session.cache.solver(problem, scenario, scenario.solver.name)

    def _holds(self, postures: PostureSolver, problem: Problem, near: Candidate) -> bool:
        """Whether the object can be held still at both ends, much as the motion of a candidate does.

        A motion need not: it may begin to fall. But a solve of the changed scenario asks for it first.
        """
        self.left -= HOLDS
        control, task = near.problem.unpack(near.result.x)[0], problem.task
        ends = ((task.start, control[0]), (task.end, control[-1]))
        return all(postures.solve(pose, seed, self.session.deadline) is not None for pose, seed in ends)
