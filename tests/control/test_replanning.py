"""Replanning: the oracles are Pinocchio's verification and IPOPT started from the same point."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from liftopt.assessment.assess import assess
from liftopt.collocation.solvers.banded import Banded
from liftopt.collocation.solvers.deadline import NEVER
from liftopt.collocation.solvers.ipopt import Ipopt
from liftopt.collocation.solvers.result import SolverResult
from liftopt.control.replanning import WARM, Replanner
from liftopt.scenario.model import Scenario, load_scenario

BASE = ("solver.name=banded", "solver.starts=2")


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    return load_scenario("table5_paper", BASE)


@pytest.fixture(scope="module")
def warm(scenario: Scenario) -> Replanner:
    """Return a replanner that has solved the scenario."""
    replanner = Replanner()
    assert replanner.solve(scenario).solved
    return replanner


def _followed(warm: Replanner, scenario: Scenario, count: int) -> list[int]:
    """Follow random changes, each verified by Pinocchio, and IPOPT that starts there stays; return the iterations."""
    rng, reference, iterations = np.random.default_rng(5), None, []
    ranges = {
        "object.mass": (1.8, 2.2), "task.end.height": (1.38, 1.42), "task.start.height": (0.88, 0.92),
        "human.stature": (1.73, 1.77), "human.mass": (73.0, 77.0), "task.standing_distance": (1.88, 1.92),
        "duration": (1.95, 2.05), "human.weight": (0.9, 1.1),
    }  # fmt: skip
    for _ in range(count):
        changes = {key: round(rng.uniform(*ends), 4) for key, ends in ranges.items()}
        changes["human.weight"] *= scenario.value("human.weight")
        solution = warm.solve(scenario.replace(changes))
        assert solution.solved, solution.status
        assert solution.kept_start == WARM
        iterations.append(solution.iterations)
        candidate = warm.latest
        assert candidate is not None
        reference = reference or Ipopt(candidate.problem)
        found = candidate.result
        polished = reference.solve(found.x, deadline=NEVER, warm=found.multipliers, problem=candidate.problem)
        assert polished.converged
        np.testing.assert_allclose(solution.objective, polished.objective, rtol=1e-6)
    return iterations


def test_ten_random_changes_are_followed_and_verified(warm: Replanner, scenario: Scenario) -> None:
    """From a posture pair it takes about forty iterations."""
    assert np.median(_followed(warm, scenario, 10)) <= 15


def test_changes_of_a_natural_lift_are_followed_and_verified() -> None:
    natural, replanner = load_scenario("table5", BASE), Replanner()
    assert replanner.solve(natural).solved
    assert np.median(_followed(replanner, natural, 5)) <= 15


def test_a_replanned_solution_is_assessed_as_any_other(warm: Replanner, scenario: Scenario) -> None:
    solution = warm.solve(scenario.replace({"object.mass": 2.3}))
    assert solution.kept_start == WARM
    assert solution.assessment == assess(solution)
    assert {finding.code for finding in solution.assessment} >= {"verdict.person", "verdict.robot"}


def test_plan_is_the_solution_at_any_time(warm: Replanner, scenario: Scenario) -> None:
    """The solution's own knots; by finite differences between them; at rest before the start and after the end."""
    solution, candidate = warm.solve(scenario), warm.latest
    assert candidate is not None
    motion = candidate.at(solution.time)
    for agent, known in zip(motion.agents, solution.agents, strict=True):
        np.testing.assert_allclose(agent.q, known.q, rtol=0, atol=1e-12)
        np.testing.assert_allclose(agent.tau, known.tau, rtol=0, atol=1e-9)
    now, ahead, behind = (candidate.at([0.77 + step]).agents[1] for step in (0.0, 1e-5, -1e-5))
    np.testing.assert_allclose(now.v, (ahead.q - behind.q) / 2e-5, rtol=0, atol=1e-6)
    outside, ends = candidate.at([-1.0, 99.0]), candidate.at([0.0, scenario.duration])
    np.testing.assert_array_equal(outside.object.pose, ends.object.pose)
    assert np.abs(outside.agents[0].v).max() < 1e-9


def test_another_structure_is_solved_from_scratch(warm: Replanner, scenario: Scenario) -> None:
    """Other intervals: there is nothing to start from; the next change is warm again."""
    finer = scenario.replace({"solver.intervals": 24})
    assert warm.replan(finer) is None
    solution = warm.solve(finer)
    assert solution.solved and solution.intervals == 24 and solution.kept_start != WARM
    assert warm.solve(finer.replace({"object.mass": 2.1})).kept_start == WARM
    warm.solve(scenario)


def test_another_scale_of_a_constraint_takes_a_new_solver_and_stays_warm(warm: Replanner, scenario: Scenario) -> None:
    """Grasp forces are shares of their cap: the rows of the problem change, their meaning does not."""
    warm.solve(scenario)
    solution = warm.solve(scenario.replace({"limits.max_grasp_force": 150}))
    assert solution.solved and solution.kept_start == WARM
    warm.solve(scenario)


def test_where_the_warm_solve_fails_it_searches_anew(
    warm: Replanner, scenario: Scenario, monkeypatch: pytest.MonkeyPatch
) -> None:
    solve = Banded.solve

    def fail(self: Banded, *args: Any, **options: Any) -> SolverResult:
        result = solve(self, *args, **options)
        return replace(result, converged=False, status="Line_Search_Failed") if options.get("warm") else result

    monkeypatch.setattr(Banded, "solve", fail)
    heavier = scenario.replace({"object.mass": 2.05})
    assert warm.replan(heavier) is None
    solution = warm.solve(heavier)
    assert solution.solved and solution.kept_start != WARM


def test_a_search_that_finds_nothing_does_not_lose_the_last_optimum(warm: Replanner, scenario: Scenario) -> None:
    warm.solve(scenario)
    hasty = warm.solve(scenario.replace({"solver.time_limit": 0.1, "object.mass": 2.1}), cold=True)
    assert not hasty.solved and "time limit of 0.1 s reached" in hasty.status
    assert warm.solve(scenario).kept_start == WARM
