"""Many starts of one problem, one after the other or several at a time, and those that come of their results."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from queue import SimpleQueue

import numpy as np

from liftopt.collocation.guess import Start, mirrored, recombined, turned
from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.result import Solver, SolverResult

# One start of several may take this share of the time that is left.
START_SHARE = 0.5


def solve_all(
    solvers: Sequence[Solver],
    starts: Sequence[Start],
    deadline: float,
    problem: Problem | None = None,
    margin: float = 1.0,
) -> Iterator[SolverResult]:
    """Solve from every start; yield the results in the order of the starts, whatever the number of solvers.

    What the first leads to, which should be the most promising, is the rival of the others: these may be given up. That
    of whichever was best so far would save 1 % more iterations, but depend on how many solve at a time. A start that
    joins no known moves, the naive one, has no rival: far from feasible for long, its objective tells nothing.

    Args:
        solvers: one for each thread; with several they must let go of Python's lock at work.
        starts: where to start.
        deadline: ``time.monotonic`` value past which solvers stop.
        problem: what is solved; None: what each solver was built for.
        margin: how many times the rival's objective is still of interest.

    Raises:
        SolverError: a solver cannot run at all.
    """
    idle: SimpleQueue[Solver] = SimpleQueue()
    for solver in solvers:
        idle.put(solver)

    def solve(start: Start, leader: SolverResult | None) -> SolverResult:
        now, solver = time.monotonic(), idle.get()
        until = deadline if len(starts) == 1 else now + START_SHARE * (deadline - now)
        try:
            rival = replace(leader, objective=margin * leader.objective) if leader and start.moves else None
            return solver.solve(start.x, deadline=until, problem=problem, rival=rival)
        finally:
            idle.put(solver)

    first, *others = starts
    if len(solvers) == 1:
        yield (found := solve(first, None))
        for start in others:
            yield solve(start, found)
        return

    def follow(start: Start) -> SolverResult:
        return solve(start, leading.result())

    with ThreadPoolExecutor(len(solvers), thread_name_prefix="start") as pool:
        leading = pool.submit(solve, first, None)
        futures = [leading, *(pool.submit(follow, start) for start in others)]
        try:
            for future in futures:
                yield future.result()
        finally:
            # After a Ctrl-C the starts that wait are dropped; those at work end first.
            for future in futures:
                future.cancel()


def follow_up(
    solver: Solver, starts: Sequence[Start], results: Sequence[SolverResult], deadline: float, problem: Problem
) -> Iterator[tuple[Start, SolverResult]]:
    """Solve from the starts that come of others' results, and yield each with its result.

    First from the best moves of all agents together, then from the best optimum with joints turned back that press
    against a limit. The best optimum so far is the rival.

    Args:
        solver: for the problem.
        starts: what was solved from.
        results: where each of them led.
        deadline: ``time.monotonic`` value past which no more is tried.
        problem: what is solved.
    """

    def together(best: SolverResult) -> Start | None:
        return recombined(problem, starts, results)

    def back(best: SolverResult) -> Start | None:
        return turned(problem, best.x)

    optima = [result for result in results if result.converged]
    for make in (together, back):
        if not optima or time.monotonic() > deadline:
            return
        best = min(optima, key=lambda result: result.objective)
        if (start := make(best)) is not None:
            result = solver.solve(start.x, deadline=deadline, problem=problem, rival=best)
            optima += [result] if result.converged else []
            yield start, result


def bent_otherwise(
    solver: Solver, optima: Sequence[SolverResult], deadline: float, problem: Problem
) -> Iterator[tuple[Start, SolverResult]]:
    """Solve from optima with one joint bent the other way, and yield each start with its result; see ``mirrored``.

    Args:
        solver: for the problem.
        optima: what to start from; the lowest objective found so far is the rival.
        deadline: ``time.monotonic`` value past which no more is tried.
        problem: what is solved.
    """
    if not optima:
        return
    best = min(optima, key=lambda result: result.objective)
    for start in (start for optimum in optima for start in mirrored(problem, optimum.x)):
        if time.monotonic() > deadline:
            return
        result = solver.solve(start.x, deadline=deadline, problem=problem, rival=best)
        best = min(best, result, key=lambda known: known.objective if known.converged else np.inf)
        yield start, result
