"""Jobs in parallel: what they return, in which order, on which solver, and what is dropped."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

import pytest

from liftopt.collocation.solvers.parallel_map import parallel_map


class Stub:
    """A solver that one job has at a time."""

    def __init__(self) -> None:
        self.busy, self.jobs = threading.Lock(), 0

    def __enter__(self) -> None:
        assert self.busy.acquire(blocking=False), "two jobs on one solver"
        self.jobs += 1

    def __exit__(self, *_: object) -> None:
        self.busy.release()


def jobs_of(count: int, seconds: float) -> list[Callable[[Any], int]]:
    def job(n: int) -> Callable[[Any], int]:
        def do(solver: Stub) -> int:
            with solver:
                time.sleep(seconds * (count - n))  # the first takes longest
            return n

        return do

    return [job(n) for n in range(count)]


@pytest.mark.parametrize("count", [1, 2, 3])
def test_results_come_in_the_order_of_the_jobs_each_on_a_solver_of_its_own(count: int) -> None:
    solvers: list[Any] = [Stub() for _ in range(count)]
    assert list(parallel_map(solvers, jobs_of(9, 2e-3))) == list(range(9))
    assert sum(solver.jobs for solver in solvers) == 9
    assert all(solver.jobs for solver in solvers)


@pytest.mark.parametrize("count", [1, 2])
def test_nobody_who_asks_for_no_more_waits_for_the_rest(count: int) -> None:
    solvers: list[Any] = [Stub() for _ in range(count)]
    found = parallel_map(solvers, jobs_of(50, 1e-3))
    assert next(found) == 0
    found.close()  # type: ignore[attr-defined]
    done = sum(solver.jobs for solver in solvers)
    assert done < 10
    time.sleep(0.1)
    assert sum(solver.jobs for solver in solvers) == done


def test_no_jobs_and_an_error_of_a_job() -> None:
    solvers: list[Any] = [Stub(), Stub()]
    assert list(parallel_map(solvers, [])) == []

    def fail(solver: Any) -> int:
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        list(parallel_map(solvers, [fail, *jobs_of(3, 1e-3)]))
