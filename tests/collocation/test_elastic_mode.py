"""What the motion that breaks least breaks: oracles are the shared weight, inverse kinematics, finite differences."""

from __future__ import annotations

import numpy as np
import pytest

from liftopt.collocation.batch import Batch
from liftopt.collocation.elastic_mode import SoftProblem, solve_elastic
from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.solvers.deadline import NEVER
from liftopt.collocation.spline import RestToRestSpline
from liftopt.scenario.build import agents_of, object_of, task_of
from liftopt.scenario.model import load_scenario
from liftopt.search.feasibility_screen import screen_ends
from liftopt.search.initial_guess import naive_guess

N = 10
STILL = ("task.end.height=0.92", "duration=10")


def _problem(*overrides: str) -> Problem:
    scenario = load_scenario("table5_paper", overrides)
    return Problem(Team.of(agents_of(scenario), object_of(scenario)), task_of(scenario), RestToRestSpline(N).mesh())


def test_a_lift_that_is_possible_breaks_nothing_and_meets_every_row() -> None:
    problem = _problem()
    found = solve_elastic(problem, naive_guess(problem).x, NEVER)
    assert found.converged and found.violations == ()
    g = Batch(problem).rows(found.x[None])[0]
    assert (problem.constraints.lower - g).max() < 1e-3
    assert (g - problem.constraints.upper).max() < 1e-3


@pytest.mark.parametrize(("cap", "mass"), [(8.0, 4.0), (5.0, 2.0)])
def test_grasps_lack_half_the_weight_less_their_cap(cap: float, mass: float) -> None:
    """Two hands at the edges of a level body that hardly moves carry half its weight each."""
    problem = _problem(f"limits.max_grasp_force={cap}", f"object.mass={mass}", *STILL)
    found = solve_elastic(problem, naive_guess(problem).x, NEVER)
    assert found.converged
    assert {(v.constraint, v.who, v.unit) for v in found.violations} == {
        ("grasp_force", "human", "N"), ("grasp_force", "robot", "N")
    }  # fmt: skip
    for violation in found.violations:
        lacking = mass * 9.81 / 2 - cap
        assert lacking - 0.01 < violation.amount < 1.02 * mass * 9.81 / 2 - cap
        assert violation.share == pytest.approx(violation.amount / cap)


def test_a_robot_too_far_away_leaves_the_gap_of_inverse_kinematics_and_the_object_in_balance() -> None:
    """Nothing but closure is broken; the gap is no smaller than the shortest, and the balance is never for sale."""
    problem = _problem("task.standing_distance=2.3", *STILL)
    reasons, _ = screen_ends(problem, 0, NEVER)
    found = solve_elastic(problem, naive_guess(problem).x, NEVER)
    first = found.violations[0]
    assert found.converged
    assert (first.constraint, first.unit) == ("grasp_closure", "m")
    gaps = sum(v.amount for v in found.violations if v.constraint == "grasp_closure")
    # The price is on the sum of the components, which is up to sqrt(3) of the distance.
    shortest = min(reason.amount for reason in reasons)
    assert shortest - 1e-4 < gaps < 3**0.5 * max(reason.amount for reason in reasons)
    balance = next(block for block in problem.constraints.blocks if block.name == "balance")
    rows = Batch(problem).rows(found.x[None])[0][balance.rows]
    assert np.abs(rows).max() < 1e-3


def test_derivatives_are_those_of_finite_differences() -> None:
    soft = SoftProblem(*(lambda p: (p.team, p.task, p.mesh))(_problem()))
    rng = np.random.default_rng(0)
    nlp, p = soft.nlp, soft.parameters
    z = soft.start(naive_guess(soft.plain).x) + 0.01 * rng.random(nlp.x.numel())
    step, lam = 1e-6 * rng.standard_normal(len(z)), rng.standard_normal(nlp.g.numel())

    def lagrangian_slope(at: np.ndarray) -> np.ndarray:
        slope = nlp.grad_f(at, p)[1].full().ravel()
        return np.asarray(slope + nlp.jac_g(at, p)[1].T.full() @ lam)

    f = [float(nlp.grad_f(z + s * step, p)[0]) for s in (1, -1)]
    g = [nlp.jac_g(z + s * step, p)[0].full().ravel() for s in (1, -1)]
    assert (f[0] - f[1]) / 2 == pytest.approx(nlp.grad_f(z, p)[1].full().ravel() @ step, rel=1e-5)
    np.testing.assert_allclose((g[0] - g[1]) / 2, nlp.jac_g(z, p)[1].full() @ step, rtol=1e-4, atol=1e-9)
    upper = nlp.hess_lag(z, p, 1.0, lam).full()
    hessian = upper + np.triu(upper, 1).T
    slopes = (lagrangian_slope(z + step) - lagrangian_slope(z - step)) / 2
    np.testing.assert_allclose(slopes, hessian @ step, rtol=1e-4, atol=1e-7)
