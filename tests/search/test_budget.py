"""How far a search goes is a matter of work, not of time: oracles are the same search by a clock that runs or jumps."""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from liftopt.assessment.assess import assess
from liftopt.collocation.solvers.deadline import Deadline
from liftopt.scenario.model import load_scenario
from liftopt.search.cache import SolverCache
from liftopt.search.session import Session
from liftopt.search.solve import explain, find_lift, solve
from liftopt.solution.finding import CAUTION
from liftopt.solution.solution import Solution

pytestmark = pytest.mark.long
SMALL = ("solver.tries=6", "solver.starts=2", "solver.intervals=12", "solver.time_limit=3600")
CASES = {
    "solved": SMALL,
    "out of reach": ("task.standing_distance=2.3", *SMALL),
    "too heavy and too fast": ("duration=0.28", "object.mass=10", *SMALL),
}


def _told(solution: Solution) -> Any:
    """Return all that a solution tells, but for the seconds it took."""
    starts = [(s.name, s.status, s.objective, s.iterations) for s in solution.starts]
    return [solution.status, solution.notes, solution.kept_start, starts, solution.reasons, solution.suggested_changes]


def _assert_same(one: Solution, other: Solution) -> None:
    assert repr(_told(one)) == repr(_told(other))  # a NaN is its own equal in words only
    for ours, theirs in zip(one.agents, other.agents, strict=True):
        np.testing.assert_array_equal(ours.q, theirs.q)
        np.testing.assert_array_equal(ours.tau, theirs.tau)


@pytest.mark.parametrize("case", CASES)
def test_a_machine_that_is_hundreds_of_times_slower_finds_the_same(case: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its clock goes on by a second whenever it is looked at, so that this machine's speed does not count."""
    scenario = load_scenario("table5_paper", CASES[case])
    idle = solve(scenario)
    assert idle.solved == (case == "solved")
    clock = itertools.count()
    monkeypatch.setattr(time, "monotonic", lambda: float(next(clock)))
    _assert_same(idle, solve(scenario))


def _cut(scenario: Any, stage: str, monkeypatch: pytest.MonkeyPatch, by: float = 0.95) -> Solution:
    """Return the solution of a search whose clock jumps by a share of its limit when it tells of a stage."""
    clock, late = time.monotonic, [0.0]
    monkeypatch.setattr(time, "monotonic", lambda: clock() + late[0])

    def jump(line: str) -> None:
        if line.startswith(stage) and not late[0]:
            late[0] = by * scenario.solver.time_limit

    return solve(scenario, progress=jump)


@pytest.mark.parametrize("stage", ["varying the best of", "solving on 12 intervals", "estimating the error"])
def test_where_time_cuts_the_search_short_the_solution_says_so_and_where(
    stage: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Time to finish what was found is kept, and the estimate of the error comes after the solution."""
    solution = _cut(
        load_scenario("table5_paper", SMALL), stage, monkeypatch, 0.8 if stage.startswith("varying") else 0.95
    )
    assert solution.solved == (stage != "solving on 12 intervals")
    words = f"the time limit of 3600 s cut the search short ({stage}"
    (note,) = (note for note in solution.notes if "time limit" in note)
    assert note.startswith(words)
    cautions = {finding.code for finding in assess(solution) if finding.severity == CAUTION}
    assert "mathematics.time_limit" in cautions
    assert solution.solved or words in solution.status


@pytest.mark.parametrize("stage", ["postures at both ends", "looking for what is in the way"])
def test_a_verdict_that_time_cut_short_is_told_as_such(stage: str, monkeypatch: pytest.MonkeyPatch) -> None:
    solution = _cut(load_scenario("table5_paper", CASES["too heavy and too fast"]), stage, monkeypatch)
    assert not solution.solved
    assert f"the time limit of 3600 s cut the search short ({stage}" in solution.status


def test_no_time_at_all_is_told_and_the_best_iterate_is_finite() -> None:
    session = Session(load_scenario("table5_paper", SMALL), SolverCache())
    session.limit = Deadline.after(0.0)
    solution = explain(session, find_lift(session))
    assert solution.status.startswith("not converged (time limit of 3600 s reached)")
    assert all(np.isfinite(agent.tau).all() for agent in solution.agents)


def test_an_unsolvable_lift_ends_by_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    """Iterations of every solver on the lift, each as long as it takes: the whole budget of the default search."""
    from liftopt.collocation.solvers.banded import Banded
    from liftopt.collocation.solvers.ipopt import Ipopt

    spent = {Banded: 0.0, Ipopt: 0.0}

    def counted(kind: Any) -> Callable[..., Any]:
        solve = kind.solve

        def count(self: Any, *given: Any, **more: Any) -> Any:
            result = solve(self, *given, **more)
            spent[kind] += result.iterations * (len(self.problem.mesh.phase) - 1) / 20
            return result

        return count

    for kind in spent:
        monkeypatch.setattr(kind, "solve", counted(kind))
    solution = solve(load_scenario("table5_paper", ["duration=0.28", "object.mass=10", "solver.time_limit=3600"]))
    assert not solution.solved and solution.reasons
    # At 0.8 and 8 ms on an idle processor of 2023: 12 s of one, shared by two workers for the most part.
    assert spent[Banded] < 13e3 and spent[Ipopt] < 310
