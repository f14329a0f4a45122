"""What the stages of one search share: the scenario, problems and solvers, the clock, and notes for the user."""

from __future__ import annotations

import time

from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.deadline import NEVER, Deadline
from liftopt.collocation.solvers.result import PRUNED, Solver, SolverResult
from liftopt.collocation.spline import RestToRestSpline
from liftopt.scenario.build import motions_of
from liftopt.scenario.model import Scenario
from liftopt.search.cache import BANDED, IPOPT, SolverCache
from liftopt.search.clear_end import ClearEnd
from liftopt.search.make_clear import Attempt, Clearer
from liftopt.solution.solution import CUT_SHORT, StartRecord
from liftopt.types import Progress

# How far a search goes is counted in starts and iterations. The time limit only stops what takes longer than foreseen:
# no start is tried after the first share of it, so that the best found can be finished; finishing ends at the second,
# so that the lift can be verified and written.
TRYING_SHARE, FINISHING_SHARE = 0.7, 0.9
CUT = "the time limit of {limit:g} s {what} ({stage})"
GIVEN_UP = {PRUNED: "given up: nothing better than another start in sight"}


class Session:
    """One search of one scenario: its stages ask it for problems and solvers, and leave records and notes with it.

    Attributes:
        scenario: what is asked.
        spline: the motions it asks for, on its own number of intervals.
        cache: where problems and solvers come from.
        postures: solver of static postures of its team.
        limit: deadline of the whole search; it begins after kernels and solvers are compiled.
        records: the starts that count, each with where it led.
        notes: what the user should know.
        blocked: optima that could not be made clear, on one mesh, the most promising first.
        held: clear postures at both ends, where no optimum could be made clear; empty where that is not known.
        detoured: whether all ways to make optima clear were tried on a coarse mesh, to no avail.
        cut: where the time limit ended the search too early, in one line; empty where it did not.
    """

    def __init__(self, scenario: Scenario, cache: SolverCache, progress: Progress | None = None) -> None:
        """Get ready; kernels and solvers are compiled here if they must be.

        Args:
            scenario: what to lift.
            cache: shared with earlier and later lifts.
            progress: called with one line at a time about what is going on.

        Raises:
            InputError: a value of the scenario cannot be used.
            SolverError: the solver cannot run at all.
        """
        self._began = time.monotonic()
        self.scenario, self.spline, self.cache = scenario, motions_of(scenario), cache
        self._tell = progress or (lambda line: None)
        self.limit, self._finishing, self._stage, self.cut = NEVER, False, "", ""
        self.records: list[StartRecord] = []
        self.notes: list[str] = []
        self.blocked: list[Attempt] = []
        self.held: tuple[ClearEnd, ...] = ()
        self.detoured = False
        problem = self.problem(self.spline)
        self.solvers(problem)
        self.postures = cache.postures(problem, scenario, self.progress)
        if not all(kernel.compiled for kernel in problem.team.kernels):
            self.notes.append("no C compiler: the dynamics ran in CasADi's virtual machine, several times slower")
        # Compiling is done once in a lifetime; the limit is on what comes after.
        self.limit = Deadline.after(scenario.solver.time_limit)
        self._prepared = self.limit.began

    @property
    def deadline(self) -> Deadline:
        """When trying starts ends; after ``finish``, when finishing what was found ends."""
        return self.limit.share(FINISHING_SHARE if self._finishing else TRYING_SHARE)

    def problem(self, spline: RestToRestSpline) -> Problem:
        """Return the lift on a mesh."""
        return self.cache.problem(self.scenario, spline, self.progress)

    def solver(self, problem: Problem, name: str, worker: int = 0, rough: float = 0.0) -> Solver:
        """Return a solver by name for a problem; see ``SolverCache.solver``."""
        return self.cache.solver(problem, self.scenario, name, self.progress, worker, rough)

    def clearer(self, problem: Problem, rough: float = 0.0) -> Clearer | None:
        """Return what makes optima of a problem clear, on any mesh; None where solids may overlap.

        Args:
            problem: whose team.
            rough: of its solvers, see ``SolverCache.solver``.
        """
        clearance = self.scenario.limits.clearance
        if clearance is None:
            return None
        name = BANDED if rough else self.scenario.solver.name
        solids = self.cache.solids(self.scenario, problem.team, self.progress)
        return Clearer(solids, clearance, self.deadline, lambda given: self.solver(given, name, rough=rough))

    def solvers(self, problem: Problem) -> list[Solver]:
        """Return the scenario's own solver for a problem, one for each worker that its starts keep busy."""
        options = self.scenario.solver
        # IPOPT's linear solver keeps state of its own and takes one solve at a time.
        count = 1 if options.name == IPOPT else min(options.workers, options.starts)
        return [self.solver(problem, options.name, i) for i in range(count)]

    def progress(self, line: str) -> None:
        """Tell what is done next, and note if time was over before it began."""
        self.note_time()
        self._stage = line
        self._tell(line)

    def note_time(self) -> None:
        """If time is over, note what was being done; once."""
        if not self.cut and self.deadline.passed:
            self.cut = CUT.format(limit=self.scenario.solver.time_limit, what=CUT_SHORT, stage=self._stage)
            self.notes.append(self.cut)

    def begin_solving(self) -> None:
        """End the preparation: what comes now is solving."""
        self._prepared = time.monotonic()

    def finish(self) -> None:
        """Go on to finish what was found, in the time that was kept for it."""
        self.note_time()
        self._finishing = True

    @property
    def blocked_at_rest(self) -> bool:
        """Whether no posture was found at one end that holds the object with bodies apart."""
        return any(end.reasons for end in self.held)

    def record(self, name: str, result: SolverResult) -> None:
        """Keep where a start led."""
        self.records.append(start_record(name, result))

    @property
    def seconds(self) -> dict[str, float]:
        """Wall time so far: ``setup`` and ``total`` [s]."""
        return {"setup": self._prepared - self._began, "total": time.monotonic() - self._began}


def start_record(name: str, result: SolverResult, after: str = "") -> StartRecord:
    """Return where a start led; ``after`` says what was tried before."""
    status = ("converged" if result.converged else GIVEN_UP.get(result.status, result.status)) + after
    return StartRecord(name, status, result.objective, result.iterations, result.seconds)
