"""Variations: made-up solvers tell in which order optima are varied and when it ends."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from liftopt.collocation.solvers.deadline import NEVER, Deadline
from liftopt.collocation.solvers.result import Multipliers, SolverResult
from liftopt.search import variations
from liftopt.search.initial_guess import InitialGuess
from liftopt.search.variations import NEAR, TURN, vary


def _result(value: float, objective: float, converged: bool = True) -> SolverResult:
    x = np.array([value])
    return SolverResult(x, Multipliers(x, x), objective, 1, converged, "", 0.0, 0.0)


class Table:
    """A solver that looks the objective up; what is not in it does not converge."""

    def __init__(self, objectives: dict[float, float]) -> None:
        self.objectives = objectives
        self.asked: list[tuple[float, float]] = []

    def solve(self, x0: np.ndarray, *, incumbent: SolverResult, **_: object) -> SolverResult:
        """Return what the table has for the start."""
        value = float(x0[0])
        self.asked.append((value, incumbent.objective))
        return _result(value, self.objectives.get(value, np.nan), value in self.objectives)


@pytest.fixture
def tenfold(monkeypatch: pytest.MonkeyPatch) -> int:
    """The variations of x are 10 x, 10 x + 1, ... of the first kind only; return how many there are."""
    count = 12

    def ten(problem: object, x: np.ndarray) -> Iterator[InitialGuess]:
        return iter([InitialGuess(str(n), 10.0 * x + n) for n in range(count)])

    monkeypatch.setattr(variations, "mirrored_joints", ten)
    monkeypatch.setattr(variations, "low_cost_postures", lambda *_: [])
    monkeypatch.setattr(variations, "via_postures", lambda *_: [])
    monkeypatch.setattr(variations, "alternative_paths", lambda *_: [])
    return count


def _vary(solver: Any, optima: list[SolverResult], idle: float, deadline: Deadline = NEVER) -> list[float]:
    nothing: Any = SimpleNamespace(kinematics=None)
    tried = list(vary([solver], nothing, nothing, optima, idle, 0, deadline))
    assert [float(start.x[0]) for start, _ in tried] == [value for value, _ in solver.asked]
    return [value for value, _ in solver.asked]


def test_the_best_is_varied_first_and_none_that_is_too_far_above_it(tenfold: int) -> None:
    solver = Table({})
    optima = [_result(1.0, 10.0), _result(2.0, 11.0), _result(3.0, 1.01 * NEAR * 10.0)]
    asked = _vary(solver, optima, 100)
    ones, twos = ([10.0 * k + n for n in range(tenfold)] for k in (1, 2))
    # A turn of the first makes it worth 10.5, two 11.0: only then it is the second's.
    assert asked == [*ones, *twos]
    assert {incumbent for _, incumbent in solver.asked} == {10.0}


def test_what_is_better_is_varied_next_and_becomes_the_incumbent_of_the_next_turn(tenfold: int) -> None:
    solver = Table({13.0: 8.0, 131.0: 7.0})
    asked = _vary(solver, [_result(1.0, 10.0)], 2 * TURN)
    assert asked[:TURN] == [10.0 + n for n in range(TURN)]
    assert asked[TURN : 2 * TURN] == [130.0 + n for n in range(TURN)]
    assert asked[2 * TURN : 3 * TURN] == [1310.0 + n for n in range(TURN)]
    assert [incumbent for _, incumbent in solver.asked[::TURN]][:3] == [10.0, 8.0, 7.0]


def test_it_ends_after_so_many_without_a_gain_and_at_once_without_time_or_patience(tenfold: int) -> None:
    assert len(_vary(Table({}), [_result(float(n), 10.0) for n in range(1, 9)], 2 * TURN)) == 2 * TURN
    # A gain of less than a thousandth is none.
    small = Table({10.0: 9.995})
    assert len(_vary(small, [_result(float(n), 10.0) for n in range(1, 9)], 2 * TURN)) == 2 * TURN
    assert _vary(Table({}), [_result(1.0, 10.0)], 2 * TURN, Deadline.after(-1.0)) == []
    assert _vary(Table({}), [_result(1.0, 10.0)], 0) == []


def test_an_optimum_that_is_known_is_not_varied_again(tenfold: int) -> None:
    solver = Table({float(n): 10.0 for n in range(10, 22)})
    assert _vary(solver, [_result(1.0, 10.0)], 1000) == [10.0 + n for n in range(tenfold)]


def test_kinds_take_turns_and_each_is_made_when_it_is_its_turn() -> None:
    made: list[str] = []

    def kind(name: str, count: int) -> Any:
        def make() -> Iterator[InitialGuess]:
            made.append(name)
            return iter([InitialGuess(f"{name}{n}", np.zeros(1)) for n in range(count)])

        return make

    starts = variations._in_turns([kind("a", 3), kind("b", 0), kind("c", 2)])
    assert next(starts).name == "a0" and made == ["a"]
    assert [start.name for start in starts] == ["c0", "a1", "c1", "a2"]
