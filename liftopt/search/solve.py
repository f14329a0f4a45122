"""The main job: a scenario in, a verified optimal lift out."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from liftopt.assessment.assess import assessed
from liftopt.collocation.solvers.result import PRUNED, STOPPED, Multipliers, Solver, SolverResult
from liftopt.collocation.spline import RestToRestSpline
from liftopt.collocation.transfer import transfer
from liftopt.scenario.build import motions_of
from liftopt.scenario.model import Scenario
from liftopt.search.cache import SolverCache
from liftopt.search.candidate import Candidate
from liftopt.search.coarse_search import coarse_search
from liftopt.search.feasibility_screen import screen, too_fast
from liftopt.search.infeasibility import find
from liftopt.search.initial_guess import InitialGuess, blend, initial_guesses, naive_guess
from liftopt.search.mesh_refinement import FINEST, SURE, SURE_ITERATIONS, finer, sharpened
from liftopt.search.multistart import follow_up, solve_all
from liftopt.search.suggested_changes import SuggestedChanges
from liftopt.solution.accuracy import Accuracy
from liftopt.solution.infeasibility_report import Obstacle
from liftopt.solution.solution import CUT_SHORT, Solution, StartRecord
from liftopt.solution.verify import CLOSURE_BETWEEN_KNOTS
from liftopt.storage import writer as result_writer

Array = npt.NDArray[np.float64]
Progress = Callable[[str], None]
# How far the search goes is counted in starts and iterations. The time limit only stops what takes longer than
# foreseen: trying what leads where at the first share of it, so that the best found can be finished, and that at the
# second, so that it can be verified and written.
TRYING_SHARE, WORKING_SHARE = 0.7, 0.9
# Postures searched from, for each start tried on a coarse mesh: of 44 widely varied lifts, each with two seeds, 86
# of 88 came within 5 % of what takes five times as long, with one 80 of 86, with one and twice the starts 85 of 88.
SEEDS_A_TRY = 2
# Times as many starts are tried before a lift that has postures at both ends counts as impossible, and iterations of
# each: half of those that converge take fewer.
WIDER, LEAN = 2, 60
SURE_STARTS = 2  # tried by IPOPT where the scenario's solver found nothing
CUT = "the time limit of {limit:g} s {what} ({stage})"
GIVEN_UP = {PRUNED: "given up: nothing better than another start in sight"}


def lift(
    scenario: Scenario, *, out: Path | None = None, progress: Progress | None = None, cache: SolverCache | None = None
) -> Solution:
    """Solve a scenario from several starts and return the best verified solution.

    Where there is none, the solution returned says why in ``status`` and holds the best iterate.

    Args:
        scenario: what to lift.
        out: folder to write the result to, or None; see ``result_writer.save`` for where an iterate goes.
        progress: hears one line at a time of what is going on.
        cache: keeps what the next lift can use again; None keeps nothing.

    Raises:
        InputError: a value of the scenario cannot be used, or ``out`` cannot be written.
        SolverError: the solver cannot run at all.
    """
    search = Search(scenario, cache or SolverCache(), motions_of(scenario), progress or (lambda line: None))
    solution = assessed(search.explained(search.sharpened(search.best())))
    if out is not None:
        search.progress("writing the result")
        result_writer.save(solution, out)
    return solution


class Search:
    """Starts, solves and verifies one scenario, on one mesh at a time."""

    def __init__(self, scenario: Scenario, cache: SolverCache, spline: RestToRestSpline, progress: Progress) -> None:
        """Get ready; kernels and solvers are compiled here if they must be."""
        self.began = time.monotonic()
        self.scenario, self.cache, self._progress = scenario, cache, progress
        self.deadline, self.stage, self.cut = np.inf, "", ""
        self.notes: list[str] = []
        self.records: list[StartRecord] = []
        self.candidates: list[Candidate] = []  # of the latest mesh, the best first
        self.accuracy: Accuracy | None = None
        self._on(spline)
        self.postures = cache.postures(self.problem, scenario, self.progress)
        if not all(kernel.compiled for kernel in self.problem.team.kernels):
            self.notes.append("no C compiler: the dynamics ran in CasADi's virtual machine, several times slower")
        # Compiling is done once in a lifetime; the limit is on what comes after, with time left to verify and write.
        self.prepared = time.monotonic()
        self.deadline, self.end = (
            self.prepared + share * scenario.solver.time_limit for share in (TRYING_SHARE, WORKING_SHARE)
        )
        self.obstacles: tuple[Obstacle, ...] = ()
        self.nearest: list[Array] = []

    def progress(self, line: str) -> None:
        """Tell what comes next, and note whether time was over before."""
        self._note_time()
        self.stage = line
        self._progress(line)

    def _note_time(self) -> None:
        """Note what was being done when time was over, if it is."""
        if not self.cut and time.monotonic() > self.deadline:
            self.cut = CUT.format(limit=self.scenario.solver.time_limit, what=CUT_SHORT, stage=self.stage)
            self.notes.append(self.cut)

    def _finish(self) -> None:
        """Let the time that was kept for it be used for what was found."""
        self._note_time()
        self.deadline = self.end

    def best(self) -> Candidate:
        """Return the best verified plan, on a finer mesh if it takes one, or the best iterate and why it is none."""
        candidate = self.run()
        while candidate.refinable and self.spline.intervals * 2 <= FINEST and time.monotonic() < self.deadline:
            gap, coarse = candidate.verification.check("closure between knots").value, self.spline.intervals
            candidate = self.refine(candidate)
            self.notes.append(
                f"mesh refined from N = {coarse} to {self.spline.intervals}: "
                f"closure between knots was {1e3 * gap:.2f} mm, {1e3 * CLOSURE_BETWEEN_KNOTS:g} mm is allowed"
            )
        return candidate

    def run(self) -> Candidate:
        """Solve from all starts and return the best verified plan, or the best iterate and why it is none."""
        options = self.scenario.solver
        tries = max(options.starts, options.tries) if options.tries else 0
        most = tries or options.starts
        found = initial_guesses(
            self.problem, most, options.seed, self.deadline, self.progress, self.postures, SEEDS_A_TRY * tries
        )
        if found is None or too_fast(self.problem):
            nearest, obstacles = self._nearest()
            if obstacles:
                return self._hindered(nearest, obstacles)
            starts = [nearest]
        else:
            self.prepared = time.monotonic()
            optima = coarse_search(self, found, tries)
            self._finish()
            if optima and (best := finer(self, optima, self.spline.intervals)) is not None:
                return best
            starts = found.starts(self.problem, options.starts)
        self._finish()
        self.prepared = time.monotonic()
        best = self._solved([*starts, naive_guess(self.problem)][: options.starts])
        return best if best.solved or best.refinable or found is None else self._wider() or best

    def _wider(self) -> Candidate | None:
        """Return the best verified plan of many more starts; None if none is found.

        That a lift is not possible has no proof where postures hold the object at both ends.
        """
        tries, seed = WIDER * self.scenario.solver.tries, self.scenario.solver.seed + 1
        if not tries or time.monotonic() > self.deadline:
            return None
        found = initial_guesses(
            self.problem, tries, seed, self.deadline, self.progress, self.postures, SEEDS_A_TRY * tries
        )
        optima = coarse_search(self, found, tries, LEAN) if found else []
        best = finer(self, optima, self.spline.intervals) if optima else None
        if best is not None:
            self.obstacles, self.nearest = (), []
        return best

    def refine(self, candidate: Candidate) -> Candidate:
        """Return the plan that comes of another one on twice its intervals."""
        self._on(candidate.spline.on(2 * candidate.spline.intervals))
        start = transfer(candidate.problem, candidate.spline, candidate.result.x, self.problem, self.spline)
        return finer(self, [candidate], self.spline.intervals) or self._solved([InitialGuess("refined", start)])

    def sharpened(self, candidate: Candidate) -> Candidate:
        """Return the plan on a mesh as fine as the scenario asks for, and find out how accurate it is."""
        if candidate.solved:
            candidate, self.accuracy = sharpened(self, candidate)
        return candidate

    def explained(self, best: Candidate) -> Solution:
        """Return the solution, or the best iterate with what is in the way and which changes would help."""
        if best.solved:
            return self.solution(best)
        self.progress(best.outcome)
        suggested_changes = SuggestedChanges(self, self.nearest).against(self.obstacles)
        return replace(self.solution(best), reasons=self.obstacles, suggested_changes=suggested_changes)

    def solution(self, best: Candidate) -> Solution:
        """Return the solution that the best plan stands for."""
        best.verification  # noqa: B018  (its time belongs to the total)
        self._note_time()
        seconds = {"setup": self.prepared - self.began, "total": time.monotonic() - self.began}
        solution = best.solution(self.records, seconds, tuple(self.notes))
        if self.cut and not best.solved:
            solution = replace(solution, outcome=f"{solution.status}; {self.cut}")
        return replace(solution, accuracy=self.accuracy)

    def _on(self, spline: RestToRestSpline) -> None:
        """Go to another mesh."""
        self.spline, self.problem = spline, self.cache.problem(self.scenario, spline, self.progress)
        name, workers = self.scenario.solver.name, self.scenario.solver.workers
        # IPOPT's linear solver keeps state of its own and takes one solve at a time.
        count = 1 if name == SURE else min(workers, self.scenario.solver.starts)
        self.solvers = [self.cache.solver(self.problem, self.scenario, name, self.progress, i) for i in range(count)]

    def _solved(self, starts: list[InitialGuess]) -> Candidate:
        """Return the best verified plan of all starts; IPOPT takes over where the solver of the scenario has none."""
        name, first = self.scenario.solver.name, len(self.records)
        results = self._solve(self.solvers, starts)
        best = self._pick(*self._followed(starts, results) if len(starts) > 1 else (starts, results))
        if best.solved or best.refinable:
            return best
        best = self._eased(best, starts)
        stopped = any(record.status == STOPPED for record in self.records[first:])
        if name == SURE or stopped or best.solved or best.refinable or best.obstacles:
            return best
        self.progress(f"the {name} solver found no solution ({self.records[first].status}): IPOPT takes over")
        before = [f" (IPOPT, after {name}: {record.status})" for record in self.records[first:]]
        del self.records[first:]
        sure, few = self.cache.solver(self.problem, self.scenario, SURE, self.progress), starts[:SURE_STARTS]
        return self._pick(few, self._solve([sure], few, before, SURE_ITERATIONS))

    def _solve(
        self,
        solvers: list[Solver],
        starts: list[InitialGuess],
        before: list[str] | None = None,
        most: int | None = None,
    ) -> list[SolverResult]:
        results, solved = [], solve_all(solvers, starts, self.deadline, self.problem, most=most)
        for i, start in enumerate(starts):
            which = f" ({i + 1} of {len(starts)})" if len(starts) > 1 else ""
            self.progress(f"solving on {self.spline.intervals} intervals: {start.name}{which}")
            result = next(solved)
            results.append(result)
            self.record(start.name, result, before[i] if before else "")
        return results

    def _followed(
        self, starts: list[InitialGuess], results: list[SolverResult]
    ) -> tuple[list[InitialGuess], list[SolverResult]]:
        """Return starts and results with those that come of them."""
        self.progress(f"solving on {self.spline.intervals} intervals: what comes of these")
        more = list(follow_up(self.solvers[0], starts, results, self.deadline, self.problem))
        for start, result in more:
            self.record(start.name, result)
        return [*starts, *(start for start, _ in more)], [*results, *(result for _, result in more)]

    def record(self, name: str, result: SolverResult, after: str = "") -> None:
        """Keep where a start led; ``after`` says what was tried before."""
        status = ("converged" if result.converged else GIVEN_UP.get(result.status, result.status)) + after
        self.records.append(StartRecord(name, status, result.objective, result.iterations, result.seconds))

    def _eased(self, best: Candidate, starts: list[InitialGuess]) -> Candidate:
        """Solve from the motion that breaks least, or return it with what it breaks."""
        self.progress("looking for what is in the way")
        first, *others = [start.x for start in starts]
        finding = find(self.problem, [first, best.result.x, *others], self.deadline)
        if finding is None:
            return best
        eased = InitialGuess("elastic", finding.x)
        self.obstacles, self.nearest = finding.reasons, [finding.x]
        if finding.reasons:
            return self._hindered(eased, list(finding.reasons)) if finding.sure else best
        result = self.solvers[0].solve(eased.x, deadline=self.deadline, problem=self.problem)
        candidate = self._candidate(eased, result)
        if not (candidate.solved or candidate.refinable):
            return best
        self.record(eased.name, result)
        return candidate

    def _pick(self, starts: list[InitialGuess], results: list[SolverResult]) -> Candidate:
        """Verify the best first; return the first that holds, or the one that is violated least."""
        self.progress("verifying with Pinocchio")
        candidates = [self._candidate(start, result) for start, result in zip(starts, results, strict=True)]
        candidates.sort(key=lambda candidate: (not candidate.result.converged, candidate.result.objective))
        self.candidates = candidates
        for candidate in candidates:
            if candidate.solved or candidate.refinable:
                return candidate
        return min(candidates, key=lambda candidate: candidate.verification.max_violation)

    def _candidate(self, start: InitialGuess, result: SolverResult, obstacles: str = "") -> Candidate:
        return Candidate(self.scenario, self.problem, self.spline, start.name, result, obstacles)

    def _nearest(self) -> tuple[InitialGuess, list[Obstacle]]:
        """Return the motion between the nearest postures that can be had at the ends, and what is in the way."""
        self.progress("looking for what is in the way")
        obstacles, (first, last) = screen(self.problem, self.scenario.solver.seed, self.deadline, self.postures)
        if obstacle := too_fast(self.problem):
            obstacles.append(obstacle)
        self.obstacles = tuple(obstacles)
        return InitialGuess("nearest postures", blend(self.problem, first, last)), obstacles

    def _hindered(self, nearest: InitialGuess, obstacles: list[Obstacle]) -> Candidate:
        """Return the nearest motion and why it is no solution."""
        layout, constraints = self.problem.layout, self.problem.constraints
        nothing = Multipliers(np.zeros(layout.n_x), np.zeros(constraints.linear.shape[0]))
        result = SolverResult(nearest.x, nothing, np.nan, 0, False, "infeasible", 0.0, 0.0)
        return self._candidate(nearest, result, "; ".join(dict.fromkeys(obstacle.message for obstacle in obstacles)))
