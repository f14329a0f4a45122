"""Derivatives of an optimum by a parameter; oracle: the problem solved again on both sides of the parameter."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from liftopt.collocation.motion import motion_at, objective_terms
from liftopt.collocation.parametric import Optimum
from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.banded import Banded, BandedOptions
from liftopt.collocation.solvers.deadline import NEVER
from liftopt.collocation.solvers.result import SolverResult
from liftopt.scenario.model import load_scenario
from liftopt.search.cache import SolverCache
from liftopt.search.session import Session
from liftopt.search.solve import find_lift


class Solved:
    """A lift at an optimum, to a KKT error of 1e-8, and others near by from there."""

    def __init__(self) -> None:
        entries = [
            "objective.preset=paper",
            "limits.clearance=off",
            "solver.name=banded",
            "solver.starts=2",
            "solver.intervals=12",
        ]
        scenario = load_scenario("table5_near", entries)
        candidate = find_lift(Session(scenario, SolverCache())).best
        self.solver = Banded(candidate.problem, BandedOptions(tolerance=1e-8))
        self.problem, self.result = candidate.problem, candidate.result
        self.result = self.near(candidate.problem)

    def near(self, problem: Problem) -> SolverResult:
        """Return the optimum of a problem near the first one's."""
        result = self.solver.solve(self.result.x, deadline=NEVER, warm=self.result.multipliers, problem=problem)
        assert result.converged
        return result


@pytest.fixture(scope="module")
def solved() -> Solved:
    return Solved()


def _at(problem: Problem, **changes: float) -> Problem:
    """Return the problem with its task changed by as much; ``start`` and ``end`` mean the heights there."""
    moved = {}
    for name, change in changes.items():
        value = getattr(problem.task, name)
        moved[name] = value + change * np.eye(6)[2] if name in ("start", "end") else value + change
    return replace(problem, task=replace(problem.task, **moved))


@pytest.mark.parametrize("name", ["duration", "start", "end", "acceleration_weight", "force_weight"])
def test_optimum_moves_as_it_does_when_solved_again(solved: Solved, name: str) -> None:
    """Unknowns, multipliers and objective, by central differences over a tenth of the tangent's reach."""
    optimum = Optimum(solved.problem, solved.result.x, solved.result.multipliers)
    step = 1e-5
    tangent = optimum.tangent(_at(solved.problem, **{name: -step}), _at(solved.problem, **{name: step}), step)
    simd = min(1e-3, 0.1 * tangent.reach)
    low, high = (solved.near(_at(solved.problem, **{name: change})) for change in (-simd, simd))
    moved = (high.x - low.x) / (2 * simd)
    assert np.abs(tangent.x - moved).max() < 1e-3 * np.abs(moved).max()
    pulled = (high.multipliers.g - low.multipliers.g) / (2 * simd)
    assert np.abs(tangent.multipliers.g - pulled).max() < 1e-2 * np.abs(pulled).max()
    assert tangent.objective == pytest.approx((high.objective - low.objective) / (2 * simd), rel=1e-4)


def test_the_objective_rises_by_the_terms_whose_weights_rise() -> None:
    """Envelope theorem: dJ by the weight of a term is its unweighted integral, here by Pinocchio."""
    changes = {"objective.preset": "natural", "objective.spine_weight": 200.0, "solver.starts": 1}
    scenario = load_scenario("table5_near", {**changes, "solver.intervals": 12})
    candidate = find_lift(Session(scenario, SolverCache())).best
    problem, result, step = candidate.problem, candidate.result, 1e-3
    optimum = Optimum(problem, result.x, result.multipliers)
    spline = candidate.spline
    terms = objective_terms(problem, motion_at(problem, spline, result.x, spline.phase))
    for name in ("range", "tilt", "acceleration", "force", "spine"):
        sides = (_at(problem, **{f"{name}_weight": change}) for change in (-step, step))
        assert optimum.tangent(*sides, step).objective == pytest.approx(terms[name], rel=1e-6)


def test_limit_that_comes_first_is_where_it_says(solved: Solved) -> None:
    """Solved again half as far as that, the same limits are active; their count changes a little beyond it."""
    optimum = Optimum(solved.problem, solved.result.x, solved.result.multipliers)
    tangent = optimum.tangent(_at(solved.problem, end=-1e-5), _at(solved.problem, end=1e-5), 1e-5)
    assert tangent.limit
    assert 0 < tangent.reach < 0.2

    def active(change: float) -> np.ndarray:
        problem = _at(solved.problem, end=change)
        result = solved.near(problem)
        lower, upper = problem.bounds()
        x = (result.x - lower < 1e-5) | (upper - result.x < 1e-5)
        g = np.abs(result.multipliers.g) > 1e-3
        return np.concatenate([x, g])

    now = active(0.0)
    for change in (-0.5 * tangent.reach, 0.5 * tangent.reach):
        np.testing.assert_array_equal(active(change), now)
    assert any((active(sign * 1.5 * tangent.reach) != now).any() for sign in (-1, 1))
