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

    def solve(start: Start) -> SolverResult:
        now, solver = time.monotonic(), idle.get()
        until = deadline if len(starts) == 1 else now + START_SHARE * (deadline - now)
        try:
            return solver.solve(start.x, deadline=until, problem=problem)
        finally:
            idle.put(solver)

    if len(solvers) == 1:
        yield from map(solve, starts)
        return
    with ThreadPoolExecutor(len(solvers), thread_name_prefix="start") as pool:
        # The last start, the naive one, takes about three times as long as the others: it begins first.
        last, *others = [pool.submit(solve, start) for start in (starts[-1], *starts[:-1])]
        try:
            for future in (*others, last):
                yield future.result()
        finally:
            # After a Ctrl-C the starts that wait are dropped; those at work end first.
            for future in (*others, last):
                future.cancel()
