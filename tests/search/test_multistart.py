"""Several starts at a time: the same answer as one after the other, and no solver in two hands."""

from __future__ import annotations

import threading
import time
from dataclasses import dataclass, field

import numpy as np
import pytest

from liftopt.collocation.solvers.deadline import NEVER, Deadline
from liftopt.collocation.solvers.result import STOPPED, Multipliers, SolverResult
from liftopt.scenario.model import load_scenario
from liftopt.search.cache import SolverCache
from liftopt.search.initial_guess import InitialGuess
from liftopt.search.multistart import solve_all
from liftopt.search.solve import solve


@dataclass
class Slow:
    """A solver that takes a while and returns its start."""

    busy: threading.Lock = field(default_factory=threading.Lock)
    given: list[tuple[Deadline, int | None]] = field(default_factory=list)
    incumbents: dict[float, SolverResult | None] = field(default_factory=dict)
    converges: bool = True

    def solve(
        self,
        x0: np.ndarray,
        *,
        deadline: Deadline,
        warm: object = None,
        problem: object = None,
        incumbent: SolverResult | None = None,
        most: int | None = None,
    ) -> SolverResult:
        """Wait for as long as the start says."""
        assert self.busy.acquire(blocking=False), "two threads use one solver"
        time.sleep(float(x0[0]))
        self.given.append((deadline, most))
        self.incumbents[float(x0[0])] = incumbent
        self.busy.release()
        return SolverResult(x0, Multipliers(x0, x0), float(x0[0]), 1, self.converges, STOPPED, 0.0, 0.0)


@pytest.mark.parametrize("workers", [1, 3])
def test_results_come_in_the_order_of_the_starts(workers: int) -> None:
    starts = [InitialGuess(f"start {i}", np.array([wait])) for i, wait in enumerate((0.03, 0.0, 0.02, 0.0, 0.01, 0.0))]
    solvers = [Slow() for _ in range(workers)]
    results = list(solve_all(solvers, starts, NEVER))
    assert [result.objective for result in results] == [float(start.x[0]) for start in starts]
    assert all(solver.given for solver in solvers)


@pytest.mark.parametrize("workers", [1, 2, 4])
def test_the_first_optimum_is_the_incumbent_of_all_that_join_moves(workers: int) -> None:
    """However many solve at a time: what a start is compared with must not depend on who is quicker."""
    starts = [InitialGuess(f"start {i}", np.array([wait]), (i, 0)) for i, wait in enumerate((0.03, 0.0, 0.02))]
    starts.append(InitialGuess("naive", np.array([0.01])))
    for converges in (True, False):
        solvers = [Slow(converges=converges) for _ in range(workers)]
        list(solve_all(solvers, starts, NEVER))
        given = {x: r for solver in solvers for x, r in solver.incumbents.items()}
        assert given[0.03] is given[0.01] is None
        assert all((r.objective, r.converged) == (0.03, converges) for r in (given[0.0], given[0.02]) if r)
        assert given[0.0] and given[0.02]


def test_each_start_gets_its_share_in_iterations_and_all_the_time() -> None:
    """A share of the time that is left would make what is found depend on how busy the machine is."""
    solver, late = Slow(), Deadline.after(3600.0)
    list(solve_all([solver], [InitialGuess("a", np.zeros(1)), InitialGuess("b", np.zeros(1))], late, most=7))
    assert solver.given == [(late, 7)] * 2


@pytest.mark.parametrize("tries", [0, 6])
def test_workers_and_a_kept_cache_change_nothing(tries: int) -> None:
    """Bit by bit: one worker, two workers, and a second time with what was kept; some starts are given up."""
    overrides = ["solver.name=banded", "solver.starts=6", "solver.intervals=16", f"solver.tries={tries}"]
    one = solve(load_scenario("table5_paper", [*overrides, "solver.workers=1"]))
    both, cache = load_scenario("table5_paper", overrides), SolverCache()
    assert one.solved
    given_up = "given up: nothing better than another start in sight"
    statuses = {start.status for start in one.starts}
    assert {"converged"} <= statuses <= {"converged", given_up}
    assert tries or given_up in statuses
    for other in (solve(both, cache=cache), solve(both, cache=cache)):
        assert other.objective == one.objective
        assert [(s.name, s.objective) for s in other.starts] == [(s.name, s.objective) for s in one.starts]
        for ours, theirs in zip(one.agents, other.agents, strict=True):
            np.testing.assert_array_equal(ours.q, theirs.q)
            np.testing.assert_array_equal(ours.tau, theirs.tau)
