"""Bounds, packing and the task's options: NumPy and the task's own numbers are the oracles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.solvers.deadline import NEVER
from liftopt.collocation.solvers.ipopt import Ipopt
from liftopt.collocation.solvers.result import SolverResult
from liftopt.collocation.spline import RestToRestSpline
from liftopt.collocation.task import LiftTask


def test_bounds_are_those_of_agents_and_task(problem: Problem) -> None:
    layout, task = problem.layout, problem.task
    lower, upper = problem.bounds()
    for i, agent in enumerate(problem.team.agents):
        control = layout.control[:, layout.columns(i)]
        assert (lower[control] == agent.limits.q_lower).all() and (upper[control] == agent.limits.q_upper).all()
    assert (lower[layout.force] == -task.max_grasp_force).all() and (upper[layout.force] == task.max_grasp_force).all()
    pose = layout.control[:, layout.columns(2)]
    assert (lower[pose[1:-1]] == task.pose_lower).all() and (upper[pose[1:-1]] == task.pose_upper).all()
    assert (lower <= upper).all()


def test_fixed_ends(problem: Problem) -> None:
    """The task fixes height, fore-aft and attitude; sideways stays free within the range of motion (NaN)."""
    lower, upper = problem.bounds()
    pose = problem.layout.control[:, problem.layout.columns(2)]
    for row, fixed in ((0, problem.task.start), (-1, problem.task.end)):
        given = ~np.isnan(fixed)
        assert given.tolist() == [True, False, True, True, True, True]
        np.testing.assert_array_equal(lower[pose[row]][given], fixed[given])
        np.testing.assert_array_equal(upper[pose[row]][given], fixed[given])
        assert lower[pose[row, 1]] == -5.0 and upper[pose[row, 1]] == 5.0


def test_free_fore_aft(problem: Problem, make_task: Callable[..., LiftTask]) -> None:
    free = replace(problem, task=make_task(x=np.nan))
    lower, upper = free.bounds()
    pose = free.layout.control[:, free.layout.columns(2)]
    for row in (0, -1):
        assert (lower[pose[row, :2]] == -5.0).all() and (upper[pose[row, :2]] == 5.0).all()
    assert np.isfinite(lower).all() and np.isfinite(upper).all()


def test_the_ends_of_the_motion_are_the_poses(problem: Problem, rng: np.random.Generator) -> None:
    """Closed form: at phases 0 and 1 the spline is its first and last control point."""
    control, force = problem.unpack(rng.normal(size=problem.layout.n_x))
    control, _ = problem.unpack(problem.pack(control, force))
    space = RestToRestSpline(8)
    ends = space.basis(np.array([0.0, 1.0])) @ control[:, problem.layout.columns(2)]
    np.testing.assert_allclose(ends[0, 2:], problem.task.start[2:], atol=1e-14)
    np.testing.assert_allclose(ends[1, 2:], problem.task.end[2:], atol=1e-14)


def test_pack_and_unpack_round_trip(problem: Problem, rng: np.random.Generator) -> None:
    lower, upper = problem.bounds()
    x = lower + rng.uniform(size=len(lower)) * (upper - lower)
    control, force = problem.unpack(x)
    assert control.shape == (9, 10 + 7 + 6) and force.shape == (9, 6)
    np.testing.assert_array_equal(problem.pack(control, force), x)


def test_pack_clips_to_the_bounds(problem: Problem) -> None:
    lower, upper = problem.bounds()
    layout = problem.layout
    packed = problem.pack(np.full(layout.control.shape, 1e9), np.full(layout.force.shape, -1e9))
    np.testing.assert_array_equal(packed[layout.control], upper[layout.control])
    np.testing.assert_array_equal(packed[layout.force], lower[layout.force])


@pytest.mark.parametrize(("tolerance", "rows"), [(0.0, 5), (1.0, 6)])
def test_balance_rows(tolerance: float, rows: int, problem: Problem, make_task: Callable[..., LiftTask]) -> None:
    """Equality leaves out the moment about the line through the grasps; a tolerance asks for all six."""
    changed = replace(problem, task=make_task(balance_tolerance=tolerance))
    (block,) = (block for block in changed.constraints.blocks if block.name == "balance")
    assert len(block.labels) == rows and len(block.lower) == 9 * rows
    assert ("moment x" in block.labels) == (rows == 6)
    assert (block.lower == -tolerance).all() and (block.upper == tolerance).all()


def test_parameters_hold_period_models_and_weights(problem: Problem, make_task: Callable[..., LiftTask]) -> None:
    """Sizes from the kernels, squares weighted on either side of zero, T first in each part; NaN nowhere."""
    p = problem.parameters
    sizes = [part.kernel.n_p + 2 * part.kernel.n_squared + part.kernel.n_y for part in problem.parts]
    assert len(p) == sum(sizes) == problem.nlp.p.shape[0] and np.isfinite(p).all()
    assert (p[np.cumsum([0, *sizes[:-1]])] == problem.task.duration).all()
    slow = replace(problem, task=make_task(duration=4.0)).parameters
    assert (slow[np.cumsum([0, *sizes[:-1]])] == 4.0).all()


def test_bare_objective_is_selectable(
    small_lift: Problem, solved: SolverResult, make_task: Callable[..., LiftTask]
) -> None:
    """With all other weights 0 the objective is the integral of one agent's squared torques alone; it still solves."""
    x = solved.x

    def objective(**weights: object) -> float:
        changed = replace(small_lift, task=make_task(**weights))
        return float(small_lift.nlp.grad_f(x, changed.parameters)[0])

    none = {"acceleration_weight": 0.0, "force_weight": 0.0}
    terms = [
        objective(**none, agent_weights=(1.0, 0.0)),
        objective(**none, agent_weights=(0.0, 1.0)),
        objective(acceleration_weight=0.5, force_weight=0.0, agent_weights=(0.0, 0.0)),
        objective(acceleration_weight=0.0, force_weight=0.01, agent_weights=(0.0, 0.0)),
    ]
    assert min(terms) > 0.0
    np.testing.assert_allclose(sum(terms), solved.objective, rtol=1e-12)
    assert objective(**none, agent_weights=(0.0, 0.0)) == 0.0


def test_bare_objective_solves(
    ipopt: Ipopt, small_lift: Problem, solved: SolverResult, make_task: Callable[..., LiftTask]
) -> None:
    """The paper's eq. 10 without regularisation, from a neighbouring solution: lower torques than with it."""
    bare = replace(small_lift, task=make_task(acceleration_weight=0.0, force_weight=0.0, agent_weights=(1.0, 1.0)))
    before = float(small_lift.nlp.grad_f(solved.x, bare.parameters)[0])
    result = ipopt.solve(solved.x, deadline=NEVER, problem=bare)
    assert result.converged and result.objective < before


def test_functions_are_finite_at_the_zero_of_everything(problem: Problem) -> None:
    """The paper's naive guess is where the solver starts: no NaN there."""
    x, p = np.zeros(problem.layout.n_x), problem.parameters
    lam = np.ones(problem.constraints.linear.shape[0])
    for part in (*problem.nlp.grad_f(x, p), *problem.nlp.jac_g(x, p), problem.nlp.hess_lag(x, p, 1.0, lam)):
        assert np.isfinite(ca.DM(part).full()).all()


def test_team_shares_equal_kernels(team: Team) -> None:
    """Kernels come in the agents' order, and a team of the same structure gets the very same sizes."""
    assert [kernel.n_y for kernel in team.kernels] == [33, 24, 24]
    assert [kernel.n_c for kernel in team.kernels] == [14, 11, 12]
