"""Several solves at a time, each in a thread and on a solver of its own."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from queue import SimpleQueue
from typing import TypeVar

from liftopt.collocation.solvers.result import Solver

T = TypeVar("T")


def parallel_map(solvers: Sequence[Solver], jobs: Sequence[Callable[[Solver], T]]) -> Iterator[T]:
    """Do jobs that take a solver; yield what they return, in their order.

    Whoever asks for no more drops the jobs that wait; those at work end first.

    Args:
        solvers: one for each thread, at least one; with several they must let go of Python's lock at work.
        jobs: what to do with a solver, whichever it is. With one solver each is done when its result is asked for.
    """
    if min(len(solvers), len(jobs)) < 2:
        yield from (job(solvers[0]) for job in jobs)
        return
    idle: SimpleQueue[Solver] = SimpleQueue()
    for solver in solvers:
        idle.put(solver)

    def do(job: Callable[[Solver], T]) -> T:
        solver = idle.get()
        try:
            return job(solver)
        finally:
            idle.put(solver)

    with ThreadPoolExecutor(len(solvers), thread_name_prefix="solver") as pool:
        futures = [pool.submit(do, job) for job in jobs]
        try:
            for future in futures:
                yield future.result()
        finally:
            for future in futures:
                future.cancel()
