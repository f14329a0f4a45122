"""IPOPT on a small lift: Pinocchio in double precision judges what it returns."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from liftopt.collocation.kkt import kkt_error
from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.deadline import NEVER, Deadline
from liftopt.collocation.solvers.ipopt import Ipopt, IpoptOptions
from liftopt.collocation.solvers.result import STOPPED, Multipliers, SolverResult
from liftopt.collocation.spline import RestToRestSpline
from liftopt.collocation.task import LiftTask
from liftopt.errors import SolverError
from liftopt.search.initial_guess import InitialGuess


def test_small_lift_is_solved(solved: SolverResult, small_lift: Problem) -> None:
    """KKT error by Pinocchio, not by the kernels the solver used."""
    assert solved.converged and solved.status == "Solve_Succeeded" and 0 < solved.iterations < 200
    error = kkt_error(small_lift, solved.x, solved.multipliers)
    assert error.error <= 1e-6
    np.testing.assert_allclose(error.objective, solved.objective, rtol=1e-12)
    assert 0.0 < solved.evaluation_seconds < solved.seconds


def test_solution_is_feasible(solved: SolverResult, small_lift: Problem) -> None:
    """Pinocchio at every knot: closure, torques, grasp forces, joint limits, rest, poses; speeds between knots too."""
    problem, task, team = small_lift, small_lift.task, small_lift.team
    control, force = problem.unpack(solved.x)
    space = RestToRestSpline(10)
    knots, fine = space.phase, np.linspace(0.0, 1.0, 301)
    q, v, a = (space.basis(knots, order) @ control / task.duration**order for order in range(3))
    np.testing.assert_allclose(v[[0, -1]], 0.0, atol=1e-12)
    speed = space.basis(fine, 1) @ control / task.duration
    object_rows = q[:, problem.layout.columns(2)]
    np.testing.assert_allclose(object_rows[0][2:], task.start[2:], atol=1e-12)
    np.testing.assert_allclose(object_rows[-1][2:], task.end[2:], atol=1e-12)
    for i, agent in enumerate(team.agents):
        columns, limits, model = problem.layout.columns(i), agent.limits, agent.reduced()
        data, frame = model.createData(), model.getFrameId(agent.hands[0])
        positions = space.basis(fine) @ control[:, columns]
        assert (positions >= limits.q_lower - 1e-8).all() and (positions <= limits.q_upper + 1e-8).all()
        assert (np.abs(speed[:, columns]) <= limits.velocity + 1e-7).all()
        lever = team.object.model.frames[
            team.object.model.getFrameId(team.object.grasp_frames[i])
        ].placement.translation
        for k in range(len(knots)):
            f = force[k, 3 * i : 3 * i + 3]
            tau = pin.rnea(model, data, q[k, columns], v[k, columns], a[k, columns]).copy()
            tau += pin.computeFrameJacobian(model, data, q[k, columns], frame, pin.LOCAL_WORLD_ALIGNED)[:3].T @ f
            assert (tau >= limits.tau_lower - 1e-5).all() and (tau <= limits.tau_upper + 1e-5).all()
            assert np.linalg.norm(f) <= task.max_grasp_force + 1e-5
            pin.framesForwardKinematics(model, data, q[k, columns])
            point = data.oMf[frame].translation
            turn = [pin.utils.rotate(axis, angle) for axis, angle in zip("xyz", object_rows[k, 3:], strict=True)]
            gap = point - object_rows[k, :3] - turn[0] @ turn[1] @ turn[2] @ lever
            assert np.abs(gap).max() <= 1e-6
            if agent.workspace is not None:
                assert agent.workspace.normal @ point >= agent.workspace.offset - 1e-7


def test_deadline_in_the_past_stops_at_once(ipopt: Ipopt, starts: list[InitialGuess]) -> None:
    began = time.monotonic()
    result = ipopt.solve(starts[0].x, deadline=began - 1.0)
    assert not result.converged and result.status == "User_Requested_Stop" and result.iterations <= 1
    assert time.monotonic() - began < 1.0 and np.isfinite(result.x).all()


def test_solver_goes_on_after_a_stop(ipopt: Ipopt, starts: list[InitialGuess], solved: SolverResult) -> None:
    """A stop leaves nothing behind: the same start gives the same result as before."""
    ipopt.solve(starts[0].x, deadline=Deadline.after(-1.0))
    again = ipopt.solve(starts[0].x, deadline=NEVER)
    assert again.converged
    np.testing.assert_array_equal(again.x, solved.x)


def test_iteration_limit_is_reported(small_lift: Problem, starts: list[InitialGuess]) -> None:
    result = Ipopt(small_lift, IpoptOptions(max_iterations=3)).solve(starts[0].x, deadline=NEVER)
    assert not result.converged and result.status == "Maximum_Iterations_Exceeded" and result.iterations == 3


def test_warm_start_from_the_solution_is_quick(ipopt: Ipopt, solved: SolverResult, small_lift: Problem) -> None:
    """From the solution with its multipliers: a fraction of the iterations, the same point by its KKT error."""
    warm = ipopt.solve(solved.x, deadline=NEVER, warm=solved.multipliers)
    assert warm.converged and warm.iterations <= 8 and warm.iterations < solved.iterations / 2
    np.testing.assert_allclose(warm.objective, solved.objective, rtol=1e-6)
    assert kkt_error(small_lift, warm.x, warm.multipliers).error <= 1e-6


def test_warm_start_of_a_neighbouring_task(
    ipopt: Ipopt, solved: SolverResult, small_lift: Problem, make_task: Callable[..., LiftTask]
) -> None:
    """Another period and end height through parameters and bounds alone, judged as the problem it is."""
    task = make_task(agent_weights=(1.0, 1.0), duration=2.05)
    other = replace(small_lift, task=replace(task, end=task.end - np.array([0.0, 0.0, 0.02, 0.0, 0.0, 0.0])))
    found = ipopt.solve(solved.x, deadline=NEVER, warm=solved.multipliers, problem=other)
    assert found.converged and found.iterations < solved.iterations
    assert kkt_error(other, found.x, found.multipliers).error <= 1e-6


def test_a_warm_start_that_fails_becomes_a_cold_one(
    ipopt: Ipopt, starts: list[InitialGuess], solved: SolverResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two iterations are too few for the warm start; the cold one is the solver's own from there."""
    warmed = Ipopt(ipopt.problem)
    monkeypatch.setattr("liftopt.collocation.solvers.ipopt.WARM_ITERATIONS", 2)
    nothing = Multipliers(np.zeros_like(solved.multipliers.x), np.zeros_like(solved.multipliers.g))
    found = warmed.solve(starts[0].x, deadline=NEVER, warm=nothing)
    assert found.converged
    assert found.status == "Solve_Succeeded (cold, after warm: Maximum_Iterations_Exceeded)"
    assert found.iterations == solved.iterations + 2
    np.testing.assert_array_equal(found.x, solved.x)


def test_a_warm_start_past_its_deadline_stays_stopped(
    ipopt: Ipopt, starts: list[InitialGuess], solved: SolverResult
) -> None:
    found = ipopt.solve(starts[0].x, deadline=Deadline.after(-1.0), warm=solved.multipliers)
    assert not found.converged and found.status == STOPPED


def test_a_problem_with_other_rows_is_refused(
    ipopt: Ipopt, solved: SolverResult, small_lift: Problem, make_task: Callable[..., LiftTask]
) -> None:
    """The cap scales a row, which is a constant of the built NLP."""
    _, force = small_lift.unpack(solved.x)
    peak = float(np.linalg.norm(force.reshape(-1, 3), axis=1).max())
    other = replace(small_lift, task=make_task(agent_weights=(1.0, 1.0), max_grasp_force=0.97 * peak))
    with pytest.raises(SolverError, match="other constraint rows"):
        ipopt.solve(solved.x, deadline=NEVER, problem=other)


def test_nan_in_the_start_is_a_failure_and_no_exception(ipopt: Ipopt, starts: list[InitialGuess]) -> None:
    x = starts[0].x.copy()
    x[3] = np.nan
    assert not ipopt.solve(x, deadline=NEVER).converged


def test_infeasible_task_does_not_converge(
    ipopt: Ipopt, starts: list[InitialGuess], small_lift: Problem, make_task: Callable[..., LiftTask]
) -> None:
    """A metre out of reach."""
    task = make_task(agent_weights=(1.0, 1.0), x=-1.5)
    result = ipopt.solve(starts[0].x, deadline=NEVER, problem=replace(small_lift, task=task))
    assert not result.converged
