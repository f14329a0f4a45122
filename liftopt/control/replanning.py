"""Planning a lift again and again, for a controller or a study, while object and agents change little.

Kernels, solvers and the last optimum with its multipliers are kept. A scenario that changes numbers only - masses,
heights, stature, where they stand, duration, weights - is solved from there in a few Newton steps::

    replanner = Replanner()
    solution = replanner.solve(scenario)  # the first from scratch: best of several starts, verified
    heavier = scenario.replace({"object.mass": 2.2})
    plan = replanner.replan(heavier)  # a few milliseconds; None if that did not converge
    now = plan.at([0.3])  # q, v, a, torques and grasp forces at 0.3 s
    plan.solved  # verified by Pinocchio when it is asked
"""

from __future__ import annotations

import time
from dataclasses import replace

from liftopt.assessment.assess import assessed
from liftopt.collocation.solvers.deadline import Deadline
from liftopt.scenario.build import motions_of
from liftopt.scenario.model import Scenario
from liftopt.search.cache import SolverCache
from liftopt.search.candidate import Candidate
from liftopt.search.carried_planes import with_planes_of
from liftopt.search.make_clear import Clearer
from liftopt.search.mesh_accuracy import estimate
from liftopt.search.optimum_on_mesh import planes_of
from liftopt.search.session import Session
from liftopt.search.solve import find_lift, solution_of
from liftopt.solution.solution import Solution, StartRecord
from liftopt.types import Progress

WARM = "last optimum"


class Replanner:
    """Plans one scenario after the other, each from the optimum of the one before; for one thread.

    A warm solve follows one local optimum as the scenario changes. Where a better one has appeared elsewhere, only a
    search from many starts (``cold=True``) finds it. The solver is the scenario's: ``solver.name=banded`` is the one
    that is fast from a warm start.

    Attributes:
        latest: the plan that the next one starts from, None before the first.
    """

    def __init__(self, progress: Progress | None = None, cache: SolverCache | None = None) -> None:
        """Start without an optimum.

        Args:
            progress: called with one line at a time about what is going on.
            cache: that others use too; None: one of its own.
        """
        self.latest: Candidate | None = None
        self._cache = cache or SolverCache()
        self._progress = progress or (lambda line: None)

    def solve(self, scenario: Scenario, *, cold: bool = False) -> Solution:
        """Return the verified solution of a scenario, or why there is none in its ``status``.

        Args:
            scenario: what to lift.
            cold: solve from several starts even if there is an optimum to start from.

        Raises:
            InputError: a value of the scenario cannot be used.
            SolverError: the solver cannot run at all.
        """
        limit = Deadline.after(scenario.solver.time_limit)
        candidate = None if cold else self._kept_clear(scenario, limit, self.replan(scenario))
        if candidate is not None and candidate.solved:
            result, seconds = candidate.result, time.monotonic() - limit.began
            record = StartRecord(candidate.start, "converged", result.objective, result.iterations, result.seconds)
            solution = candidate.solution([record], {"setup": 0.0, "total": seconds})
            return assessed(replace(solution, accuracy=estimate(self._cache, candidate, limit, self._progress)))
        session = Session(scenario, self._cache, self._progress)
        found = find_lift(session)
        if found.best.solved:
            self.latest = found.best
        return assessed(solution_of(session, found))

    def replan(self, scenario: Scenario) -> Candidate | None:
        """Return the plan of a changed scenario from the latest one, as fast as it can be had and not yet verified.

        Ask ``solved`` of it before it is believed: that verifies. The plan becomes the latest.

        Returns:
            None where there is no plan to start from, where the scenario has another structure (``solver.intervals``,
            ``task.rest``, a tool or none) or where the solver did not converge: then ``solve`` searches anew.

        Raises:
            InputError: a value of the scenario cannot be used.
            SolverError: the solver cannot run at all.
        """
        last = self.latest
        if last is None or motions_of(last.scenario) != motions_of(scenario):
            return None
        self._progress("solving from the last optimum")
        problem = self._cache.problem(scenario, last.spline, self._progress)
        if not problem.same_unknowns(last.problem):
            return None
        if last.problem.planes is not None and scenario.limits.clearance is not None:
            renewed = problem.apart(planes_of(self._cache, last, scenario, problem))
            # Where more of the solids' corners come near now, the optimum is none of the renewed problem.
            fits = renewed.same_structure(last.problem)
            problem = renewed if fits else with_planes_of(self._cache, last, scenario, problem)
        if not problem.same_structure(last.problem):
            return None
        solver = self._cache.solver(problem, scenario, scenario.solver.name, self._progress)
        deadline = Deadline.after(scenario.solver.time_limit)
        result = solver.solve(last.result.x, deadline=deadline, warm=last.result.multipliers, problem=problem)
        if not result.converged:
            return None
        self.latest = Candidate(scenario, problem, last.spline, WARM, result)
        return self.latest

    def _kept_clear(self, scenario: Scenario, limit: Deadline, candidate: Candidate | None) -> Candidate | None:
        """Return a plan with planes for what comes near in it now; None where that does not make it clear."""
        clearance = scenario.limits.clearance
        if candidate is None or clearance is None:
            return candidate
        solids, name = self._cache.solids(scenario, candidate.problem.team, self._progress), scenario.solver.name
        clearer = Clearer(solids, clearance, limit, lambda given: self._cache.solver(given, scenario, name))
        attempt = clearer.make_clear(candidate, polish=False)
        if attempt.clear:
            self.latest = attempt.candidate
        return attempt.candidate if attempt.clear else None
