"""The terms of a natural motion in the NLP: closed forms, finite differences, CasADi's own derivatives, Pinocchio."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import radians

import casadi as ca
import numpy as np
import pytest

from liftopt.collocation.batch import Batch
from liftopt.collocation.kkt import first_order, kkt_error
from liftopt.collocation.motion import motion_at, objective_terms, objective_weights
from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.solvers.banded import WARM, Banded, BandedOptions, elimination_order
from liftopt.collocation.solvers.banded_nlp import callback_nlp, kernels_for_simd
from liftopt.collocation.solvers.deadline import NEVER
from liftopt.collocation.solvers.ipopt import Ipopt
from liftopt.collocation.solvers.result import Multipliers, SolverResult
from liftopt.collocation.solvers.simd_nlp import simd_nlp
from liftopt.collocation.spline import RestToRestSpline
from liftopt.collocation.task import LiftTask
from liftopt.multibody.agent import Comfort
from liftopt.search.initial_guess import InitialGuess

Unknowns = Callable[[Problem, np.random.Generator], np.ndarray]
NATURAL = dict(
    shares=True, agent_weights=(1600.0, 16.0), acceleration_weight=5.0, force_weight=0.1, range_weight=100.0,
    tilt_weight=30.0,
)  # fmt: skip
N = 10


def comfort_of(n: int) -> Comfort:
    """Return rooms that differ by side and joint, with squares and fourth powers."""
    count = np.arange(1.0, n + 1.0)
    return Comfort(0.1 * count - 0.2, 0.3 * count, 0.5 * count, count, 0.5 * count)


@pytest.fixture(scope="module")
def natural(small_lift: Problem, make_task: Callable[..., LiftTask]) -> Problem:
    """Return the lift of Table 5 on 10 intervals with point grasps and the terms of a natural motion."""
    return replace(small_lift, task=make_task(**NATURAL))


@pytest.fixture(scope="module")
def optimum(natural: Problem, starts: list[InitialGuess]) -> SolverResult:
    return Banded(natural, BandedOptions(tolerance=1e-8)).solve(starts[0].x, deadline=NEVER)


def test_a_joint_costs_its_weight_at_the_end_of_its_room() -> None:
    """Closed form: u^4 and u^2 of the room on either side."""
    comfort = Comfort(
        neutral=np.radians([-80.0, 0.0]), room_lower=np.radians([70.0, 20.0]), room_upper=np.radians([80.0, 60.0]),
        weight=np.array([1.0, 4.0]), square_weight=np.array([0.0, 3.0]),
    )  # fmt: skip
    q = np.radians([[-80.0, 0.0], [-150.0, 0.0], [0.0, 0.0], [-40.0, 0.0], [-80.0, -20.0], [-80.0, 30.0]])
    np.testing.assert_allclose(comfort.cost(q), [0.0, 1.0, 1.0, 1 / 16, 7.0, 4 / 16 + 3 / 4])


def test_weights_are_the_closed_forms(natural: Problem) -> None:
    """By hand from the task, for one joint of the person and for the object, over phase instead of time."""
    human, task = natural.team.agents[0], natural.task
    own, lifted = natural.weights(0), natural.weights(2)
    np.testing.assert_allclose(own.above, 1600.0 * 2.0 / human.limits.tau_upper**2)
    np.testing.assert_allclose(own.below, 1600.0 * 2.0 / human.limits.tau_lower**2)
    assert (own.above != own.below).any()
    comfort = human.comfort
    assert comfort is not None
    y, expected = np.zeros(own.variable.shape), np.zeros(len(human.posture))
    y[3], expected = comfort.neutral[3] - radians(30.0), comfort.weight * (comfort.neutral / comfort.room_lower) ** 4
    expected = np.where(comfort.neutral < 0.0, comfort.weight * (comfort.neutral / comfort.room_upper) ** 4, expected)
    expected[3] = comfort.weight[3] * (radians(30.0) / comfort.room_lower[3]) ** 4
    np.testing.assert_allclose(own.range_cost(y), task.range_weight * task.duration * expected)
    np.testing.assert_allclose(lifted.variable[:6], np.array([0, 0, 0, 1, 1, 0]) * 30.0 * 2.0 / radians(10.0) ** 2)
    assert lifted.range.size == 0 == natural.weights(1).range.size


def test_without_them_the_weights_are_one_number(small_lift: Problem) -> None:
    """The paper's eq. 10: the same weight on either side, no term of the range or the tilt."""
    for part in range(3):
        own = small_lift.weights(part)
        np.testing.assert_array_equal(own.above, own.below)
        assert own.range.size == 0
    np.testing.assert_array_equal(small_lift.weights(0).above, np.full(10, 2.0))
    np.testing.assert_array_equal(small_lift.weights(2).variable[:6], np.zeros(6))


@pytest.fixture(scope="module")
def arms(arm_team: Team, make_task: Callable[..., LiftTask]) -> Problem:
    """Return two random arms, of which one minds its angles, and whose strength differs by direction."""
    one, other = arm_team.agents
    team = replace(arm_team, agents=(one, replace(other, comfort=comfort_of(len(other.posture)))))
    return Problem(team, make_task(**NATURAL), RestToRestSpline(6).mesh(), posture_weight=0.3)


def test_derivatives_by_finite_differences(arms: Problem, check_derivatives: Callable[[Problem], None]) -> None:
    check_derivatives(arms)


def test_derivatives_are_casadis_own(arms: Problem, random_unknowns: Unknowns) -> None:
    """CasADi's automatic differentiation of f and g as one expression, on the virtual machine."""
    rng, nlp, sigma = np.random.default_rng(3), arms.nlp, ca.MX.sym("s")
    lam = ca.MX.sym("l", nlp.g.shape[0])
    hessian, _ = ca.hessian(sigma * nlp.f + ca.dot(lam, nlp.g), nlp.x)
    own = ca.Function("own", [nlp.x, nlp.p, sigma, lam], [ca.gradient(nlp.f, nlp.x), ca.triu(hessian)])
    x, p, multipliers = random_unknowns(arms, rng), arms.parameters, rng.normal(size=lam.shape[0])
    gradient, curvature = (part.full() for part in own(x, p, 0.7, multipliers))
    np.testing.assert_allclose(nlp.grad_f(x, p)[1].full(), gradient, rtol=0, atol=1e-11 * np.abs(gradient).max())
    np.testing.assert_allclose(
        nlp.hess_lag(x, p, 0.7, multipliers).full(), curvature, rtol=0, atol=1e-11 * np.abs(curvature).max()
    )


def test_simd_kernels_give_the_same_functions(natural: Problem, random_unknowns: Unknowns) -> None:
    """The NLP that CasADi assembles, at unknowns where torques and angles are on both sides."""
    kernels = kernels_for_simd(natural)
    if kernels is None:
        pytest.skip("no C compiler that knows vector types")
    rng, simd, plain, p = np.random.default_rng(1), simd_nlp(natural, kernels), natural.nlp, natural.parameters
    x, lam = random_unknowns(natural, rng), rng.normal(size=plain.g.shape[0])
    f = [float(ca.Function("f", [nlp.x, nlp.p], [nlp.f])(x, p)) for nlp in (simd, plain)]
    assert f[0] == pytest.approx(f[1], rel=1e-12)
    for sigma in (0.7, 0.0):
        for one, other in (
            (simd.grad_f(x, p)[1], plain.grad_f(x, p)[1]),
            (simd.hess_lag(x, p, sigma, lam), plain.hess_lag(x, p, sigma, lam)),
        ):
            assert one.sparsity() == other.sparsity()
            reference = other.full()
            np.testing.assert_allclose(one.full(), reference, rtol=0, atol=1e-12 * np.abs(reference).max())


def test_many_at_once_are_the_nlps(natural: Problem, random_unknowns: Unknowns, rng: np.random.Generator) -> None:
    x = np.array([random_unknowns(natural, rng) for _ in range(3)])
    expected = [float(natural.nlp.grad_f(one, natural.parameters)[0]) for one in x]
    np.testing.assert_allclose(Batch(natural).objective(x), expected, rtol=1e-12)


def test_first_order_by_pinocchio_is_the_nlps(natural: Problem, random_unknowns: Unknowns) -> None:
    """Value and gradient without multipliers, against CasADi's kernels."""
    x = random_unknowns(natural, np.random.default_rng(5))
    none = Multipliers(np.zeros(len(x)), np.zeros(natural.constraints.linear.shape[0]))
    at, (f, gradient) = first_order(natural, x, none), natural.nlp.grad_f(x, natural.parameters)
    assert at.objective == pytest.approx(float(f), rel=1e-12)
    reference = gradient.full().ravel()
    np.testing.assert_allclose(at.gradient, reference, rtol=0, atol=1e-11 * np.abs(reference).max())


def test_the_banded_solver_sees_the_same_value(
    natural: Problem, small_lift: Problem, random_unknowns: Unknowns
) -> None:
    """CasADi's, at random unknowns; and the paper's again on the same solver, of which nothing new stays."""
    solver, rng = Banded(small_lift), np.random.default_rng(2)
    for problem in (natural, small_lift, natural):
        x = random_unknowns(problem, rng)
        assert solver.objective(x, problem) == pytest.approx(
            float(problem.nlp.grad_f(x, problem.parameters)[0]), rel=1e-12
        )


def test_the_banded_solver_takes_the_steps_of_casadis_derivatives(
    natural: Problem, optimum: SolverResult, rng: np.random.Generator
) -> None:
    """Gradient and curvature: two Newton steps near an optimum on the functions that the tests above check."""
    import _liftopt_banded

    compiled, called = Banded(natural), Banded(natural)
    compiled.evaluate(optimum.x)
    called._nlp = callback_nlp(_liftopt_banded, natural.nlp, natural.parameters)
    called._solver = _liftopt_banded.InteriorPoint(called._nlp, elimination_order(natural))
    near = optimum.x + 1e-3 * rng.normal(size=optimum.x.shape)
    given = WARM | {"warm": (optimum.multipliers.x, optimum.multipliers.g), "max_iterations": 2}
    found, expected = (solver._run(near, natural, NEVER, given)["x"] for solver in (compiled, called))
    moved = np.abs(expected - near).max()
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-6 * moved)


def test_a_natural_lift_is_an_optimum(natural: Problem, optimum: SolverResult, starts: list[InitialGuess]) -> None:
    """KKT error by Pinocchio; IPOPT from there finds nothing better near by."""
    assert optimum.converged
    assert kkt_error(natural, optimum.x, optimum.multipliers).error <= 1e-8
    other = Ipopt(natural).solve(optimum.x, deadline=NEVER)
    assert other.converged
    assert other.objective == pytest.approx(optimum.objective, rel=1e-6)


def test_terms_are_the_closed_forms_on_pinocchios_motion(natural: Problem, optimum: SolverResult) -> None:
    """NumPy's trapezoid rule on Pinocchio's torques and angles; the weighted sum is the solver's objective."""
    spline = RestToRestSpline(N)
    motion = motion_at(natural, spline, optimum.x, spline.phase)
    terms, weights = objective_terms(natural, motion), objective_weights(natural)
    assert list(terms) == ["human", "robot", "acceleration", "force", "range", "tilt"] == list(weights)
    assert sum(weights[name] * terms[name] for name in terms) == pytest.approx(optimum.objective, rel=1e-12)
    human, comfort = motion.agents[0], natural.team.agents[0].comfort
    assert comfort is not None
    tau, q = human.tau[:, human.moving], human.q[:, human.moving]
    assert (tau > 0.0).any() and (tau < 0.0).any()
    share = np.maximum(tau / human.limits.tau_upper, tau / human.limits.tau_lower)
    away = q - comfort.neutral
    used = np.maximum(away / comfort.room_upper, -away / comfort.room_lower)
    tilt = np.degrees(motion.object.pose[:, 3:5]) / 10.0
    for name, integrand in (
        ("human", (share**2).sum(axis=1)),
        ("range", (comfort.weight * used**4).sum(axis=1)),
        ("tilt", (tilt**2).sum(axis=1)),
    ):
        assert terms[name] == pytest.approx(np.trapezoid(integrand, motion.time), rel=1e-12)


def test_the_weights_of_range_and_tilt_move_the_motion(
    natural: Problem, optimum: SolverResult, make_task: Callable[..., LiftTask]
) -> None:
    """More of a weight, less of its term: a law of optima."""
    spline = RestToRestSpline(N)

    def terms(**changes: float) -> dict[str, float]:
        problem = replace(natural, task=make_task(**NATURAL | changes))
        found = Banded(problem).solve(optimum.x, deadline=NEVER, warm=optimum.multipliers)
        assert found.converged
        return objective_terms(problem, motion_at(problem, spline, found.x, spline.phase))

    now = terms()
    assert terms(range_weight=200.0)["range"] < now["range"]
    assert terms(tilt_weight=60.0)["tilt"] < now["tilt"]


def test_what_the_spine_bears_has_a_weight_of_its_own(
    natural: Problem, optimum: SolverResult, make_task: Callable[..., LiftTask]
) -> None:
    """By hand: 170 Nm that hold the trunk up count as one, 408 Nm that bend it aside, none that bend it forward."""
    spline = RestToRestSpline(N)

    def solved(weight: float) -> tuple[Problem, SolverResult, dict[str, float]]:
        problem = replace(natural, task=make_task(**NATURAL, spine_weight=weight))
        found = Banded(problem, BandedOptions(tolerance=1e-8)).solve(optimum.x, deadline=NEVER)
        assert found.converged
        return problem, found, objective_terms(problem, motion_at(problem, spline, found.x, spline.phase))

    problem, found, terms = solved(500.0)
    weights = objective_weights(problem)
    assert list(terms) == list(weights)
    assert weights["spine"] == 500.0
    assert sum(weights[name] * terms[name] for name in terms) == pytest.approx(found.objective, rel=1e-12)
    assert kkt_error(problem, found.x, found.multipliers).error <= 1e-8
    motion = motion_at(problem, spline, found.x, spline.phase)
    human = motion.agents[0]
    bend, flexion = (human.tau[:, human.joint_names.index(f"human_{joint}")] for joint in ("Q1", "Q2"))
    integrand = (np.maximum(-flexion, 0.0) / 170.0) ** 2 + (bend / 408.0) ** 2
    assert terms["spine"] == pytest.approx(np.trapezoid(integrand, motion.time), rel=1e-12)
    other = Ipopt(problem).solve(found.x, deadline=NEVER)
    assert other.objective == pytest.approx(found.objective, rel=1e-6)
    assert solved(5000.0)[2]["spine"] < terms["spine"]
