"""Many starts of one problem, one after the other or several at a time."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from queue import SimpleQueue

from liftopt.collocation.guess import Start
from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.result import Solver, SolverResult

# One start of several may take this share of the time that is left.
START_SHARE = 0.5


def solve_all(
    solvers: Sequence[Solver], starts: Sequence[Start], deadline: float, problem: Problem | None = None
) -> Iterator[SolverResult]:
    """Solve from every start; yield the results in the order of the starts, whatever the number of solvers.

    The optimum of the first, which should be the most promising, is the rival of the others: these may be given up.
    That of whichever was best so far would save 1 % more iterations, but depend on how many solve at a time. The last,
    the naive start, has no rival: far from feasible for long, its objective tells nothing.

    Args:
        solvers: one for each thread; with several they must let go of Python's lock at work.
        starts: where to start.
        deadline: ``time.monotonic`` value past which solvers stop.
        problem: what is solved; None: what each solver was built for.

    Raises:
        SolverError: a solver cannot run at all.
    """
    idle: SimpleQueue[Solver] = SimpleQueue()
    for solver in solvers:
        idle.put(solver)

    def solve(start: Start, rival: float | None = None) -> SolverResult:
        now, solver = time.monotonic(), idle.get()
        until = deadline if len(starts) == 1 else now + START_SHARE * (deadline - now)
        try:
            return solver.solve(start.x, deadline=until, problem=problem, rival=rival)
        finally:
            idle.put(solver)

    first, *others = starts
    last = [others.pop()] if others else []
    if len(solvers) == 1:
        yield (found := solve(first))
        rival = _rival(found)
        yield from (solve(start, rival) for start in others)
        yield from map(solve, last)
        return

    def follow(start: Start) -> SolverResult:
        return solve(start, _rival(leading.result()))

    with ThreadPoolExecutor(len(solvers), thread_name_prefix="start") as pool:
        # The last takes about three times as long as the others: it begins with the first.
        leading = pool.submit(solve, first)
        lasting = [pool.submit(solve, start) for start in last]
        futures = [leading, *(pool.submit(follow, start) for start in others), *lasting]
        try:
            for future in futures:
                yield future.result()
        finally:
            # After a Ctrl-C the starts that wait are dropped; those at work end first.
            for future in futures:
                future.cancel()


def _rival(found: SolverResult) -> float | None:
    return found.objective if found.converged else None
