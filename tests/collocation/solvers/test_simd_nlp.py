"""The NLP on SIMD kernels: the one CasADi assembles from one-knot kernels is the oracle."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from liftopt.collocation.assembly import Nlp
from liftopt.collocation.codegen.simd_kernels import SimdKernel
from liftopt.collocation.kkt import kkt_error
from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.banded_nlp import kernels_for_simd
from liftopt.collocation.solvers.deadline import NEVER
from liftopt.collocation.solvers.ipopt import Ipopt
from liftopt.collocation.solvers.result import SolverResult
from liftopt.collocation.solvers.simd_nlp import simd_nlp
from liftopt.collocation.task import LiftTask
from liftopt.search.initial_guess import InitialGuess


@pytest.fixture(scope="module")
def kernels(small_lift: Problem) -> list[SimdKernel]:
    found = kernels_for_simd(small_lift)
    if found is None:
        pytest.skip("no C compiler that knows vector types")
    return found


@pytest.fixture(scope="module")
def simd(small_lift: Problem, kernels: list[SimdKernel]) -> Nlp:
    return simd_nlp(small_lift, kernels)


def everything(nlp: Nlp, x: np.ndarray, p: np.ndarray, sigma: float, lam: np.ndarray) -> list[ca.DM]:
    """Return f, g, the gradient, the Jacobian and the Hessian, each as a solver asks for it."""
    f, g = ca.Function("values", [nlp.x, nlp.p], [nlp.f, nlp.g])(x, p)
    gradient, jacobian = nlp.grad_f(x, p)[1], nlp.jac_g(x, p)[1]
    return [f, g, gradient, jacobian, nlp.hess_lag(x, p, sigma, lam)]


@pytest.mark.parametrize("seed", [0, 1])
def test_all_functions_are_those_of_one_knot_kernels(
    small_lift: Problem, simd: Nlp, make_task: Callable[..., LiftTask], seed: int
) -> None:
    """At random unknowns and multipliers; the second time at other parameters, so that nothing old is kept."""
    rng = np.random.default_rng(seed)
    task = small_lift.task if seed == 0 else make_task(duration=1.7, agent_weights=(0.3, 2.0), force_weight=0.2)
    p = replace(small_lift, task=task, posture_weight=0.4 * seed).parameters
    x, lam = rng.normal(size=simd.x.shape[0]), rng.normal(size=simd.g.shape[0])
    for sigma in (0.7, 0.0):
        pairs = zip(everything(simd, x, p, sigma, lam), everything(small_lift.nlp, x, p, sigma, lam), strict=True)
        for actual, expected in pairs:
            assert actual.sparsity() == expected.sparsity()
            reference = expected.full()
            np.testing.assert_allclose(actual.full(), reference, rtol=0, atol=1e-12 * max(1.0, np.abs(reference).max()))


def test_order_of_calls_does_not_matter(small_lift: Problem, simd: Nlp) -> None:
    """Each function at each of two points, in turn, against its first answer."""
    rng = np.random.default_rng(4)
    p, lam = small_lift.parameters, rng.normal(size=simd.g.shape[0])
    points = [rng.normal(size=simd.x.shape[0]) for _ in range(2)]
    first = [everything(simd, x, p, 1.0, lam) for x in points]
    calls = [lambda x: simd.hess_lag(x, p, 1.0, lam), lambda x: simd.jac_g(x, p)[1], lambda x: simd.grad_f(x, p)[1]]
    for i, call in zip((4, 3, 2), calls, strict=True):
        for point in (1, 0, 1):
            np.testing.assert_array_equal(call(points[point]).full(), first[point][i].full())


def test_ipopt_on_wide_kernels_solves_the_same_lift(
    small_lift: Problem, kernels: list[SimdKernel], starts: list[InitialGuess], solved: SolverResult
) -> None:
    """IPOPT on one-knot kernels for the optimum, Pinocchio for the KKT error."""
    found = Ipopt(small_lift, simd=kernels).solve(starts[0].x, deadline=NEVER)
    assert found.converged and kkt_error(small_lift, found.x, found.multipliers).error <= 1e-6
    np.testing.assert_allclose(found.objective, solved.objective, rtol=1e-6)


def test_nan_is_a_failure_and_no_exception(
    small_lift: Problem, kernels: list[SimdKernel], starts: list[InitialGuess]
) -> None:
    x = starts[0].x.copy()
    x[3] = np.nan
    assert not Ipopt(small_lift, simd=kernels).solve(x, deadline=NEVER).converged
