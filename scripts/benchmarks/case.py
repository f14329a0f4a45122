"""One lift to be timed: a problem on a mesh, and a start that is given, so that no search decides the path."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from benchmarks.scenarios import Ends
from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.solvers.deadline import Deadline
from liftopt.collocation.solvers.result import Solver, SolverResult
from liftopt.collocation.spline import RestToRestSpline
from liftopt.scenario.build import agents_of, motions_of, object_of, task_of
from liftopt.scenario.model import Scenario
from liftopt.search.cache import SolverCache
from liftopt.search.initial_guess import blend, naive_guess
from liftopt.search.postures import Posture
from liftopt.solution.verify import verify
from liftopt.types import Array

TOLERANCE = 1e-6
PATIENCE = 60.0  # [s] for one solve


@dataclass(frozen=True, eq=False)
class Case:
    """A scenario as a nonlinear programme.

    Attributes:
        scenario: what is lifted.
        spline, problem: on its mesh.
        start: (n_x,) the unknowns to start from.
    """

    scenario: Scenario
    spline: RestToRestSpline
    problem: Problem
    start: Array

    @staticmethod
    def of(scenario: Scenario, ends: Ends, intervals: int = 20) -> Case:
        """Build the problem; the start joins two postures by the quintic of minimum jerk."""
        spline = motions_of(scenario, intervals)
        team = Team.of(agents_of(scenario), object_of(scenario), print)
        problem = Problem(team, task_of(scenario), spline.mesh())
        first, last = (
            Posture(np.array(coordinates), np.array(force), 0.0)
            for coordinates, force in ((ends.first, ends.first_force), (ends.last, ends.last_force))
        )
        return Case(scenario, spline, problem, blend(problem, first, last))

    def from_zero(self) -> Case:
        """Return the case with the paper's guess as its start: control points 0, forces 10 N."""
        return replace(self, start=naive_guess(self.problem).x)

    def solver(self, name: str) -> Solver:
        """Return a new solver for the problem, set up as ``liftopt solve`` does."""
        return SolverCache().solver(self.problem, self.scenario, name)

    def solve(self, solver: Any, **more: Any) -> SolverResult:
        """Solve from the start; ``more`` goes to the solver's ``solve``."""
        result: SolverResult = solver.solve(self.start, deadline=Deadline.after(PATIENCE), **more)
        return result

    def verified(self, result: SolverResult) -> bool:
        """Whether a result converged and Pinocchio agrees, on this mesh.

        Closure between its knots is not asked for: where that is too wide a lift goes on to a finer mesh.
        """
        found = verify(self.problem, self.spline, result, TOLERANCE)
        wrong = {check.name for check in found.checks if not check.passed} - {"grasp closure between knots"}
        return result.converged and found.kkt_error <= TOLERANCE and not wrong


@dataclass(frozen=True)
class Timing:
    """Wall and processor times [s] of repeated calls."""

    wall: tuple[float, ...]
    cpu: tuple[float, ...]

    @property
    def median(self) -> float:
        """Median wall time [s]."""
        return float(np.median(self.wall))

    def plain(self) -> dict[str, float]:
        """Return the figures to keep, in ms."""
        return {
            "median_ms": 1e3 * self.median,
            "least_ms": 1e3 * min(self.wall),
            "cpu_median_ms": 1e3 * float(np.median(self.cpu)),
            "repeats": len(self.wall),
        }


def repeat(times: int, call: Callable[..., Any], *arguments: Any, **named: Any) -> tuple[Timing, Any]:
    """Call once to warm up and then ``times`` times; return the times of these and the last answer."""
    call(*arguments, **named)
    return measure(times, call, *arguments, **named)


def measure(times: int, call: Callable[..., Any], *arguments: Any, **named: Any) -> tuple[Timing, Any]:
    """Call ``times`` times; return the times and the last answer."""
    wall, cpu, answer = [], [], None
    for _ in range(times):
        began, busy = time.perf_counter(), time.process_time()
        answer = call(*arguments, **named)
        wall.append(time.perf_counter() - began)
        cpu.append(time.process_time() - busy)
    return Timing(tuple(wall), tuple(cpu)), answer
