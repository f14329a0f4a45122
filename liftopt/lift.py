"""The main job: a scenario in, a verified optimal lift out."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from liftopt import result_writer
from liftopt.checks import Verification
from liftopt.collocation.guess import Start, blend, naive_start, posture_starts
from liftopt.collocation.motion import motion_at, objective_terms, objective_weights
from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.screen import Obstacle, screen, too_fast
from liftopt.collocation.solvers.banded import Banded, BandedOptions
from liftopt.collocation.solvers.ipopt import Ipopt, IpoptOptions
from liftopt.collocation.solvers.result import STOPPED, Multipliers, SolverResult
from liftopt.collocation.spline import RestToRestSpline, interpolate_linear
from liftopt.scenario import Scenario
from liftopt.scene import URDF_FILES, agents_of, object_of, task_of
from liftopt.solution import SOLVED, Solution, StartRecord
from liftopt.verify import CLOSURE_BETWEEN_KNOTS, verify

Say = Callable[[str], None]
# Shares of the time that is left: the search for postures, one start of several.
POSTURE_SHARE, START_SHARE = 0.3, 0.5
SOLVING_SHARE = 0.9
FINEST = 400


def lift(scenario: Scenario, *, out: Path | None = None, progress: Say | None = None) -> Solution:
    """Solve a scenario from several starts and return the best verified solution.

    Where there is none, the solution returned says why in ``status`` and holds the best iterate.

    Args:
        scenario: what to lift.
        out: folder to write the result to, or None.
        progress: hears one line at a time of what is going on.

    Raises:
        InputError: a value of the scenario cannot be used, or ``out`` cannot be written.
        SolverError: the solver cannot run at all.
    """
    began, notes = time.monotonic(), []

    def say(line: str) -> None:
        if progress:
            progress(line)

    team = Team.of(agents_of(scenario), object_of(scenario), say)
    if not all(kernel.compiled for kernel in team.kernels):
        notes.append("no C compiler: the dynamics ran in CasADi's virtual machine, several times slower")
    search = _Search(scenario, team, RestToRestSpline(scenario.solver.intervals), say)
    best = search.run()
    while best.refinable and search.spline.intervals * 2 <= FINEST and time.monotonic() < search.deadline:
        gap = best.verification.check("closure between knots").value
        coarse, search = search, search.refined()
        notes.append(
            f"mesh refined from N = {coarse.spline.intervals} to {search.spline.intervals}: "
            f"closure between knots was {1e3 * gap:.2f} mm, {1e3 * CLOSURE_BETWEEN_KNOTS:g} mm is allowed"
        )
        best = search.run_from(coarse.transfer(best.result, search.spline))
    solution = search.solution(best, began, tuple(notes))
    if out is not None:
        say("writing the result")
        result_writer.save(solution, out)
    return solution


@dataclass(frozen=True)
class _Candidate:
    """Where one start ended, verified."""

    start: str
    result: SolverResult
    verification: Verification
    outcome: str

    @property
    def solved(self) -> bool:
        return self.outcome == SOLVED and self.verification.passed

    @property
    def refinable(self) -> bool:
        """Whether closure between knots is all that is wrong."""
        wrong = {check.name for check in self.verification.checks if not check.passed}
        return self.outcome == SOLVED and wrong == {"closure between knots"}


class _Search:
    """Starts, solves and verifies on one mesh."""

    def __init__(self, scenario: Scenario, team: Team, spline: RestToRestSpline, say: Say) -> None:
        self.scenario, self.team, self.spline, self.say = scenario, team, spline, say
        self.problem = Problem(team, task_of(scenario), spline.mesh())
        self.solver = Ipopt(self.problem, IpoptOptions(tolerance=scenario.solver.tolerance))
        # Tried first where the scenario asks for it; IPOPT takes over from every start it fails from.
        self.quick = None
        if scenario.solver.name == "banded":
            self.quick = Banded(self.problem, BandedOptions(tolerance=scenario.solver.tolerance), say)
        self.records: list[StartRecord] = []
        # Compiling is done once in a lifetime; the limit is on what comes after, with time left to verify and write.
        self.prepared = time.monotonic()
        self.deadline = self.prepared + SOLVING_SHARE * scenario.solver.time_limit

    def run(self) -> _Candidate:
        """Solve from all starts and return the best verified result, or the best iterate and why it is none."""
        options = self.scenario.solver
        until = time.monotonic() + POSTURE_SHARE * (self.deadline - time.monotonic())
        starts = posture_starts(self.problem, max(1, options.starts - 1), options.seed, until, self.say)
        if not starts or too_fast(self.problem):
            nearest, obstacles = self._nearest()
            if obstacles:
                return self._hindered(nearest, obstacles)
            starts = [nearest]
        self.prepared = time.monotonic()
        starts = [*starts, naive_start(self.problem)][: options.starts]
        results = [(start, self._solve(start, len(starts))) for start in starts]
        results.sort(key=lambda pair: (not pair[1].converged, pair[1].objective))
        candidates = []
        for start, result in results:
            candidates.append(self._judge(start.name, result))
            if candidates[-1].solved or candidates[-1].refinable:
                return candidates[-1]
        return min(candidates, key=lambda candidate: candidate.verification.max_violation)

    def run_from(self, start: Start) -> _Candidate:
        """Solve from one start."""
        return self._judge(start.name, self._solve(start, 1))

    def refined(self) -> _Search:
        """Return a search on twice as many intervals."""
        spline = RestToRestSpline(2 * self.spline.intervals)
        finer = _Search(self.scenario, self.team, spline, self.say)
        finer.records, finer.deadline = self.records, self.deadline
        return finer

    def transfer(self, result: SolverResult, spline: RestToRestSpline) -> Start:
        """Return the same motion on a finer mesh; exact where the finer knots hold the coarser ones."""
        control, force = self.problem.unpack(result.x)
        dense = np.linspace(0.0, 1.0, 8 * spline.intervals + 1)
        fitted = np.asarray(np.linalg.lstsq(spline.basis(dense), self.spline.basis(dense) @ control, rcond=None)[0])
        finer = Problem(self.team, self.problem.task, spline.mesh())
        return Start("refined", finer.pack(fitted, interpolate_linear(force, spline.phase)))

    def solution(self, best: _Candidate, began: float, notes: tuple[str, ...]) -> Solution:
        """Return the solution that the best candidate stands for."""
        motion = motion_at(self.problem, self.spline, best.result.x, self.spline.phase)
        terms, weights = objective_terms(motion), objective_weights(self.problem)
        seconds = {
            "solve": best.result.seconds,
            "evaluation": best.result.evaluation_seconds,
            "setup": self.prepared - began,
            "total": time.monotonic() - began,
        }
        models = {agent.name: agent.urdf for agent in self.team.agents} | {self.team.held.name: self.team.held.urdf}
        return Solution(
            scenario=self.scenario,
            outcome=best.outcome,
            time=motion.time,
            agents=motion.agents,
            held=motion.held,
            urdfs={URDF_FILES[name]: text for name, text in models.items()},
            objective=sum(weights[name] * value for name, value in terms.items()),
            objective_terms=terms,
            objective_weights=weights,
            iterations=best.result.iterations,
            intervals=self.spline.intervals,
            seconds=seconds,
            starts=tuple(self.records),
            kept_start=best.start,
            verification=best.verification,
            notes=notes,
        )

    def _solve(self, start: Start, of: int) -> SolverResult:
        which = f" ({len(self.records) + 1} of {of})" if of > 1 else ""
        self.say(f"solving on {self.spline.intervals} intervals: {start.name}{which}")
        now = time.monotonic()
        until = self.deadline if of == 1 else now + START_SHARE * (self.deadline - now)
        result, before = (self.quick or self.solver).solve(start.x, deadline=until), ""
        if self.quick is not None and not result.converged and result.status != STOPPED:
            self.say(f"the banded solver stopped ({result.status}): IPOPT takes over")
            before = f" (IPOPT, after banded: {result.status})"
            result = self.solver.solve(start.x, deadline=until)
        status = ("converged" if result.converged else result.status) + before
        self.records.append(StartRecord(start.name, status, result.objective, result.iterations, result.seconds))
        return result

    def _judge(self, start: str, result: SolverResult) -> _Candidate:
        self.say("verifying with Pinocchio")
        verification = verify(self.problem, self.spline, result, self.scenario.solver.tolerance)
        outcome = SOLVED
        if not result.converged:
            late = result.status == STOPPED
            why = f"time limit of {self.scenario.solver.time_limit:g} s reached" if late else f"IPOPT: {result.status}"
            outcome = f"not converged ({why}): {verification.describe_failure()}"
        return _Candidate(start, result, verification, outcome)

    def _nearest(self) -> tuple[Start, list[Obstacle]]:
        """Return the motion between the nearest postures that can be had at the ends, and what is in the way."""
        self.say("looking for what is in the way")
        obstacles, (first, last) = screen(self.problem, self.scenario.solver.seed, self.deadline)
        if obstacle := too_fast(self.problem):
            obstacles.append(obstacle)
        return Start("nearest postures", blend(self.problem, first, last)), obstacles

    def _hindered(self, nearest: Start, obstacles: list[Obstacle]) -> _Candidate:
        """Return the nearest motion and why it is no solution."""
        layout, constraints = self.problem.layout, self.problem.constraints
        nothing = Multipliers(np.zeros(layout.n_x), np.zeros(constraints.linear.shape[0]))
        result = SolverResult(nearest.x, nothing, np.nan, 0, False, "infeasible", 0.0, 0.0)
        reasons = "; ".join(dict.fromkeys(obstacle.message for obstacle in obstacles))
        return replace(self._judge(nearest.name, result), outcome=f"infeasible: {reasons}")
