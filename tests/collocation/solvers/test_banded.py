"""The interior point on random block-banded problems: IPOPT and the KKT conditions recomputed here are the oracles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
import pytest

from liftopt.collocation.assembly import Nlp
from liftopt.collocation.solvers.banded_nlp import callback_nlp

extension = pytest.importorskip("_liftopt_banded")
TOLERANCE = 1e-6
SEEDS = range(8)


@dataclass
class Banded:
    """A random problem: T blocks of n unknowns, neighbours coupled; rows g with bounds, bounds on x, a start."""

    x: Any
    f: Any
    g: Any
    lower: np.ndarray
    upper: np.ndarray
    lower_g: np.ndarray
    upper_g: np.ndarray
    blocks: list[list[int]]
    start: np.ndarray

    def nlp(self) -> Nlp:
        """Return it with exact derivatives by CasADi."""
        p, sigma, lam = ca.SX.sym("p", 0), ca.SX.sym("s"), ca.SX.sym("l", self.g.shape[0])
        gradient = ca.densify(ca.gradient(self.f, self.x))
        hessian = ca.triu(ca.hessian(sigma * self.f + ca.dot(lam, self.g), self.x)[0])
        return Nlp(
            self.x, p, self.f, self.g,
            grad_f=ca.Function("grad_f", [self.x, p], [self.f, gradient]),
            jac_g=ca.Function("jac_g", [self.x, p], [self.g, ca.jacobian(self.g, self.x)]),
            hess_lag=ca.Function("hessian", [self.x, p, sigma, lam], [hessian]),
        )  # fmt: skip

    def solve(self, **options: Any) -> dict[str, Any]:
        """Solve it by the interior point under test."""
        solver = extension.InteriorPoint(callback_nlp(extension, self.nlp(), np.zeros(0)), self.blocks)
        arguments = dict(lower_x=self.lower, upper_x=self.upper, lower_g=self.lower_g, upper_g=self.upper_g)
        found: dict[str, Any] = solver.solve(**arguments, **dict(x0=self.start, objective_scaling=1.0) | options)
        return found

    def ipopt(self, x0: np.ndarray, warm: dict[str, Any] | None = None) -> dict[str, Any]:
        """Solve it by IPOPT."""
        options: dict[str, Any] = dict(print_level=0, sb="yes", tol=1e-9, bound_relax_factor=0.0)
        extra = {}
        if warm:
            options |= dict(warm_start_init_point="yes", mu_init=1e-8, warm_start_bound_push=1e-10)
            options |= dict(warm_start_slack_bound_push=1e-10, warm_start_mult_bound_push=1e-10)
            options |= dict(warm_start_bound_frac=1e-10, warm_start_slack_bound_frac=1e-10)
            extra = dict(lam_x0=warm["bound_multipliers"], lam_g0=warm["multipliers"])
        solver = ca.nlpsol("s", "ipopt", dict(x=self.x, f=self.f, g=self.g), dict(print_time=False, ipopt=options))
        found = solver(x0=x0, lbx=self.lower, ubx=self.upper, lbg=self.lower_g, ubg=self.upper_g, **extra)
        assert solver.stats()["success"]
        return {"x": found["x"].full().ravel(), "f": float(found["f"]), "count": solver.stats()["iter_count"]}

    def kkt(self, found: dict[str, Any]) -> float:
        """Return the largest error of the first-order conditions, unscaled, from CasADi's own derivatives."""
        x, lam, lam_x = found["x"], found["multipliers"], found["bound_multipliers"]
        slope = ca.gradient(self.f, self.x) + ca.mtimes(ca.jacobian(self.g, self.x).T, ca.DM(lam))
        values = ca.Function("kkt", [self.x], [slope, self.g])(x)
        gradient, g = (np.asarray(v.full()).ravel() for v in values)
        errors = [np.abs(gradient + lam_x)]
        for value, multiplier, low, high in ((x, lam_x, self.lower, self.upper), (g, lam, self.lower_g, self.upper_g)):
            errors.append(np.maximum(0.0, np.maximum(low - value, value - high)))
            free = high > low
            for side, gap in ((np.maximum(-multiplier, 0), value - low), (np.maximum(multiplier, 0), high - value)):
                errors.append(np.abs(side * np.where(np.isfinite(gap), gap, 1.0))[free])
        return float(np.concatenate(errors).max())


def random_problem(seed: int, convex: bool, rows: Callable[[Any, Any, Any], list[Any]] | None = None) -> Banded:
    """Return a problem of 12 blocks of 5; the nonconvex one has saddles and nonlinear equalities."""
    rng = np.random.default_rng(seed)
    count, n = 12, 5
    x = ca.SX.sym("x", count * n)
    parts = [x[n * t : n * (t + 1)] for t in range(count)]
    f, equal, between = ca.SX(0), [], []
    for t in range(count):
        half = rng.normal(size=(n, n))
        f += 0.5 * ca.sumsqr(ca.mtimes(half, parts[t])) + ca.dot(rng.normal(size=n), parts[t])
        if not convex:
            f += 3.0 * ca.sum1(ca.cos(ca.mtimes(rng.normal(size=(n, n)), parts[t])))
    for t in range(count - 1):
        a, b = rng.normal(size=(2, n)), rng.normal(size=(2, n))
        row = ca.mtimes(a, parts[t]) + ca.mtimes(b, parts[t + 1]) - 0.3 * rng.normal(size=2)
        equal.append(row if convex else row + 0.5 * ca.sin(row) + 0.2 * parts[t][:2] * parts[t + 1][:2])
        between.append(ca.mtimes(rng.normal(size=(2, n)), parts[t + 1] - parts[t]))
    g = ca.vertcat(*equal, *between)
    n_equal = 2 * (count - 1)
    lower_g = np.concatenate([np.zeros(n_equal), np.full(n_equal, -0.8)])
    upper_g = np.concatenate([np.zeros(n_equal), np.full(n_equal, 0.8)])
    lower_g[n_equal::3], upper_g[n_equal + 1 :: 3] = -np.inf, np.inf
    lower, upper = np.full(count * n, -2.0), np.full(count * n, 2.0)
    lower[1::7], upper[2::7] = -np.inf, np.inf
    lower[3] = upper[3] = 0.1
    blocks = [list(range(n * t, n * (t + 1))) for t in range(count)]
    return Banded(x, f, g, lower, upper, lower_g, upper_g, blocks, rng.uniform(-1.0, 1.0, count * n))


@pytest.mark.parametrize("seed", SEEDS)
def test_convex_problems_have_ipopts_solution(seed: int) -> None:
    problem = random_problem(seed, convex=True)
    found, reference = problem.solve(tolerance=1e-9), problem.ipopt(problem.start)
    assert found["status"] == "Solve_Succeeded" and problem.kkt(found) <= 1e-7
    np.testing.assert_allclose(found["objective"], reference["f"], rtol=1e-7, atol=1e-7)
    np.testing.assert_allclose(found["x"], reference["x"], rtol=0, atol=1e-5)


@pytest.mark.parametrize("seed", SEEDS)
def test_nonconvex_problems_end_where_ipopt_stays(seed: int) -> None:
    """Started from the point and its multipliers, IPOPT finds nothing better near it: a minimum, not a saddle."""
    problem = random_problem(seed, convex=False)
    found = problem.solve(tolerance=0.01 * TOLERANCE)  # a hundred products of TOLERANCE would show in the objective
    assert found["status"] == "Solve_Succeeded" and problem.kkt(found) <= TOLERANCE
    polished = problem.ipopt(found["x"], warm=found)
    np.testing.assert_allclose(polished["f"], found["objective"], rtol=1e-6)
    np.testing.assert_allclose(polished["x"], found["x"], rtol=0, atol=1e-4)


def test_error_is_measured_in_the_scaling_of_the_problem_given() -> None:
    """Whatever the objective's factor inside, the multipliers are those of the problem outside."""
    problem = random_problem(1, convex=True)
    for scaling in (1e-3, 1.0, 10.0):
        found = problem.solve(objective_scaling=scaling, tolerance=1e-8)
        assert found["status"] == "Solve_Succeeded" and problem.kkt(found) <= 1e-6


def test_order_of_elimination_does_not_matter() -> None:
    problem = random_problem(2, convex=True)
    forward = problem.solve(tolerance=1e-9)
    problem.blocks = problem.blocks[1::2] + problem.blocks[::2]
    other = problem.solve(tolerance=1e-9)
    assert other["status"] == "Solve_Succeeded"
    np.testing.assert_allclose(other["x"], forward["x"], rtol=0, atol=1e-6)


@pytest.mark.parametrize("joined", (1, 4, 6))
def test_every_instruction_set_gives_the_same(joined: int) -> None:
    """All that this processor can run, bit by bit, on blocks of 5, 20 and 30, which fill no vector."""
    problem = random_problem(2, convex=False)
    alone = problem.solve(tolerance=1e-9)
    problem.blocks = [np.ravel(problem.blocks[i : i + joined]).tolist() for i in range(0, 12, joined)]
    found = []
    try:
        for name in extension.instructions():
            assert extension.choose_instructions(name)
            found.append(problem.solve(tolerance=1e-9))
    finally:
        extension.choose_instructions(extension.instructions()[0])
    for other in found:
        assert other["status"] == "Solve_Succeeded" and other["iterations"] == found[0]["iterations"]
        np.testing.assert_array_equal(other["x"], found[0]["x"])
    np.testing.assert_allclose(found[0]["x"], alone["x"], rtol=0, atol=1e-6)


def test_unknown_instructions_are_refused() -> None:
    assert not extension.choose_instructions("abacus")


def test_dependent_equalities_do_no_harm() -> None:
    """Every equality twice: multipliers are not unique, the solution is."""
    problem = random_problem(3, convex=True)
    reference = problem.solve(tolerance=1e-8)
    n_equal = int((problem.lower_g == problem.upper_g).sum())
    problem.g = ca.vertcat(problem.g, 2.0 * problem.g[:n_equal])
    problem.lower_g, problem.upper_g = (np.append(b, np.zeros(n_equal)) for b in (problem.lower_g, problem.upper_g))
    found = problem.solve(tolerance=1e-8)
    assert found["status"] == "Solve_Succeeded" and problem.kkt(found) <= 1e-6
    np.testing.assert_allclose(found["x"], reference["x"], rtol=0, atol=1e-5)


def test_contradicting_equalities_are_not_called_solved() -> None:
    """x1 + x2 = 0 and x1 + x2 = 1 in the last block."""
    problem = random_problem(4, convex=True)
    last = problem.blocks[-1]
    row = problem.x[last[0]] + problem.x[last[1]]
    problem.g = ca.vertcat(problem.g, row, row)
    problem.lower_g = problem.upper_g = np.zeros(0)
    n = problem.g.shape[0]
    problem.lower_g, problem.upper_g = np.full(n, -np.inf), np.full(n, np.inf)
    problem.lower_g[-2:] = problem.upper_g[-2:] = (0.0, 1.0)
    found = problem.solve(max_iterations=200)
    assert found["status"] in ("Infeasible_Problem_Detected", "Line_Search_Failed", "Maximum_Iterations_Exceeded")
    assert found["error"] >= 0.4


def test_bounds_that_no_row_can_meet_are_not_called_solved() -> None:
    problem = random_problem(5, convex=True)
    problem.g = ca.vertcat(problem.g, ca.sumsqr(problem.x[:5]))
    problem.lower_g, problem.upper_g = np.append(problem.lower_g, 1e3), np.append(problem.upper_g, np.inf)
    assert problem.solve(max_iterations=200)["status"] != "Solve_Succeeded"


def test_warm_start_from_the_solution_takes_few_iterations() -> None:
    problem = random_problem(6, convex=False)
    cold = problem.solve()
    warm = problem.solve(
        x0=cold["x"], warm=(cold["bound_multipliers"], cold["multipliers"]), mu=1e-6, push=1e-8
    )  # fmt: skip
    assert warm["status"] == "Solve_Succeeded" and warm["iterations"] <= min(6, cold["iterations"] // 2)
    np.testing.assert_allclose(warm["objective"], cold["objective"], rtol=1e-6)


def test_limits_and_bad_numbers_are_reported() -> None:
    problem = random_problem(7, convex=False)
    assert problem.solve(max_iterations=2)["status"] == "Maximum_Iterations_Exceeded"
    assert problem.solve(seconds=-1.0)["status"] == "User_Requested_Stop"
    problem.start[4] = np.nan
    assert problem.solve()["status"] == "Invalid_Number_Detected"


@pytest.mark.parametrize("seed", SEEDS)
def test_an_incumbent_stops_what_is_worse_and_changes_nothing_else(seed: int) -> None:
    """The solve without an incumbent is the oracle; only where a problem is convex is it sure not to be given up."""
    for convex in (True, False):
        problem = random_problem(seed, convex)
        alone = problem.solve()
        beaten = problem.solve(incumbent=alone["objective"] - 100.0)
        assert beaten["status"] == "Worse_Than_Incumbent" and beaten["iterations"] < alone["iterations"]
        if convex:
            ahead = problem.solve(incumbent=alone["objective"] + 1e-6)
            assert ahead["status"] == "Solve_Succeeded"
            np.testing.assert_array_equal(ahead["x"], alone["x"])


def test_misshapen_input_is_refused() -> None:
    problem = random_problem(0, convex=True)
    with pytest.raises(ValueError, match="every unknown once"):
        extension.InteriorPoint(callback_nlp(extension, problem.nlp(), np.zeros(0)), [*problem.blocks[:-1], [0]])
    problem.lower = problem.lower[:-1]
    with pytest.raises(ValueError, match="size"):
        problem.solve()
