"""Rows that keep bodies apart. Pinocchio in double precision, finite differences and CasADi's sums are the oracles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from liftopt.collocation.codegen.kernels import Kernel
from liftopt.collocation.kkt import first_order, kkt_error
from liftopt.collocation.kkt_poses import link_poses, object_pose
from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.separating_planes import (
    IDLE,
    WORLD,
    Body,
    PosePart,
    SeparatingPlanes,
    Separation,
    pose_parts,
)
from liftopt.collocation.solvers.banded import Banded
from liftopt.collocation.solvers.deadline import NEVER
from liftopt.collocation.solvers.ipopt import Ipopt
from liftopt.collocation.solvers.result import Multipliers, SolverResult
from liftopt.collocation.spline import RestToRestSpline
from liftopt.collocation.task import LiftTask
from liftopt.multibody.agent import Agent

Unknowns = Callable[[Problem, np.random.Generator], np.ndarray]
WRIST, LINK, OBJECT = Body(0, 10), Body(1, 5), Body(2, 1)


@pytest.fixture(scope="session")
def poses(team: Team) -> tuple[PosePart, ...]:
    return pose_parts(team.agents, team.object, ((3, 6, 8, 10), tuple(range(1, 8)), (1,)))


def separation(one: Body, other: Body, rows: int, knots: int, rng: np.random.Generator) -> Separation:
    """Return rows with other planes and points at every knot, the last of which asks for nothing at odd knots."""
    normal = rng.normal(size=(knots, rows, 3))
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    normal[1::2, -1] = 0.0
    points = 0.2 * rng.normal(size=(2, knots, rows, 3))
    return Separation(one, other, normal, *points, 0.1 * rng.normal(size=(knots, rows)), ((("",) * rows),) * knots)


def planes(poses: tuple[PosePart, ...], knots: int, rng: np.random.Generator) -> SeparatingPlanes:
    pairs = ((WRIST, OBJECT, 3), (WRIST, LINK, 2), (Body(1, 7), Body(WORLD, 0), 1), (Body(WORLD, 0), OBJECT, 2))
    pairs += ((Body(0, 3), Body(0, 8), 2),)
    return SeparatingPlanes(poses, tuple(separation(*pair, knots, rng) for pair in pairs))


@pytest.fixture(scope="session")
def kept_apart(team: Team, poses: tuple[PosePart, ...], make_task: Callable[..., LiftTask]) -> Problem:
    return Problem(team, make_task(), RestToRestSpline(8).mesh(), planes=planes(poses, 9, np.random.default_rng(5)))


def placed(problem: Problem, body: Body, k: int, x: np.ndarray) -> pin.SE3:
    """Return the body's pose in the world at a knot by Pinocchio."""
    if body.part == WORLD:
        return pin.SE3.Identity()
    q = problem.mesh.basis[0][k] @ problem.unpack(x)[0][:, problem.layout.columns(body.part)]
    if body.part == len(problem.team.agents):
        rx, ry, rz = (pin.exp3(angle * axis) for angle, axis in zip(q[3:], np.eye(3), strict=True))
        return pin.SE3(rx @ ry @ rz, q[:3])
    model = problem.team.agents[body.part].reduced()
    data = model.createData()
    pin.forwardKinematics(model, data, q)
    return data.oMi[body.joint]


def test_rows_are_distances_along_the_normals(
    kept_apart: Problem, random_unknowns: Unknowns, rng: np.random.Generator
) -> None:
    """Forward kinematics; what is fixed in the world stands in the bounds, idle rows are far from theirs."""
    x = random_unknowns(kept_apart, rng)
    g = kept_apart.nlp.jac_g(x, kept_apart.parameters)[0].full().ravel()
    slack = (g - kept_apart.constraints.lower)[
        next(b.rows.start for b in kept_apart.constraints.blocks if b.name == "clearance") :
    ]
    assert kept_apart.planes is not None
    expected = []
    for pair in kept_apart.planes.separations:
        for k in range(9):
            one, other = (placed(kept_apart, body, k, x) for body in (pair.one, pair.other))
            for j in range(pair.rows):
                gap = one.act(pair.point_one[k, j]) - other.act(pair.point_other[k, j])
                idle = not pair.normal[k, j].any()
                expected.append(-IDLE if idle else pair.normal[k, j] @ gap - pair.distance[k, j])
    np.testing.assert_allclose(slack, expected, rtol=0, atol=1e-12)


def test_derivatives_by_finite_differences(kept_apart: Problem, check_derivatives: Callable[[Problem], None]) -> None:
    check_derivatives(kept_apart)


def test_the_banded_solver_has_the_same_functions(
    kept_apart: Problem, poses: tuple[PosePart, ...], random_unknowns: Unknowns, rng: np.random.Generator
) -> None:
    """CasADi's rows, and products with its Jacobian by one Newton step's worth; other planes need no other solver."""
    pytest.importorskip("_liftopt_banded")
    solver, x = Banded(kept_apart), random_unknowns(kept_apart, rng)
    moved = kept_apart.apart(planes(poses, 9, np.random.default_rng(6)))
    assert solver.takes(moved) and not Ipopt(kept_apart).takes(moved)
    for problem in (kept_apart, moved, kept_apart):
        f, g = solver.evaluate(x, problem)
        np.testing.assert_allclose(f, float(problem.nlp.grad_f(x, problem.parameters)[0]), rtol=1e-12)
        np.testing.assert_allclose(g, problem.nlp.jac_g(x, problem.parameters)[0].full().ravel(), rtol=0, atol=1e-9)
        sizes, exact = solver._nlp.row_sizes(x), np.abs(problem.nlp.jac_g(x, problem.parameters)[1].full())
        clearance = slice(next(b.rows.start for b in problem.constraints.blocks if b.name == "clearance"), None)
        assert (exact.max(axis=1)[clearance] <= 24 * sizes[clearance] + 1e-12).all()


def test_poses_by_pinocchio_and_their_slopes(
    human: Agent, poses: tuple[PosePart, ...], rng: np.random.Generator
) -> None:
    """The compiled kernels against the functions that verify them, whose slopes are central differences."""
    h = 1e-6
    for part, found in ((poses[0], lambda q: link_poses(human, (3, 6, 8, 10), q)), (poses[2], object_pose)):
        kernel: Kernel = part.kernel
        q = rng.normal(size=(1, kernel.n_y))
        p = np.concatenate([[2.0], part.topology.parameters])
        outputs, slopes = found(q)
        np.testing.assert_allclose(kernel.value(q[0], p).full().ravel(), outputs[0], rtol=0, atol=1e-12)
        np.testing.assert_allclose(kernel.jacobian(q[0], p).full(), slopes[0], rtol=0, atol=1e-12)
        numeric = [(found(q + h * e)[0] - found(q - h * e)[0])[0] / (2 * h) for e in np.eye(kernel.n_y)]
        np.testing.assert_allclose(slopes[0].T, numeric, rtol=0, atol=1e-8)


def test_first_order_conditions_cover_the_rows(
    kept_apart: Problem, random_unknowns: Unknowns, rng: np.random.Generator
) -> None:
    """The Lagrangian's gradient by the kernels against that by Pinocchio, with multipliers on every row."""
    nlp, p, x = kept_apart.nlp, kept_apart.parameters, random_unknowns(kept_apart, rng)
    lam = rng.normal(size=kept_apart.constraints.linear.shape[0])
    at = first_order(kept_apart, x, Multipliers(np.zeros(len(x)), lam))
    gradient = nlp.grad_f(x, p)[1].full().ravel() + nlp.jac_g(x, p)[1].full().T @ lam
    np.testing.assert_allclose(at.gradient, gradient, rtol=0, atol=1e-9 * np.abs(gradient).max())


def test_a_plane_that_binds_is_kept(small_lift: Problem, poses: tuple[PosePart, ...], solved: SolverResult) -> None:
    """The object may not come nearer to a wall ahead than 2 cm beyond its path: both solvers, judged by Pinocchio."""
    pytest.importorskip("_liftopt_banded")
    x_object = small_lift.mesh.basis[0] @ small_lift.unpack(solved.x)[0][:, small_lift.layout.columns(2)]
    wall = float(x_object[5, 2]) + 0.05
    knots = len(small_lift.mesh.phase)
    normal, point, distance = np.zeros((knots, 1, 3)), np.zeros((knots, 1, 3)), np.zeros((knots, 1))
    normal[5], point[5], distance[5] = [0.0, 0.0, 1.0], [0.0, 0.0, wall], 0.02
    pair = Separation(OBJECT, Body(WORLD, 0), normal, 0.0 * point, point, distance, (("box and wall",),) * knots)
    problem = small_lift.apart(SeparatingPlanes(poses[2:], (pair,)))
    for solver in (Banded(problem), Ipopt(problem)):
        result = solver.solve(solved.x, deadline=NEVER)
        assert result.converged and kkt_error(problem, result.x, result.multipliers).error <= 1e-6
        height = (problem.mesh.basis[0] @ problem.unpack(result.x)[0])[5, problem.layout.columns(2)][2]
        assert height == pytest.approx(wall + 0.02, abs=1e-5)
        assert result.objective > solved.objective
    other = problem.apart(SeparatingPlanes(poses[2:], (replace(pair, distance=0.9 * distance),)))
    warm = Banded(problem).solve(result.x, deadline=NEVER, warm=result.multipliers, problem=other)
    assert warm.converged and warm.iterations < 15
