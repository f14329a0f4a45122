"""A vector of unknowns as a motion: the solver's own objective and SciPy's spline are the oracles."""

from __future__ import annotations

import numpy as np

from liftopt.collocation.motion import motion_at, objective_terms, objective_weights
from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.result import SolverResult
from liftopt.collocation.spline import RestToRestSpline


def test_terms_add_up_to_the_solvers_objective(small_lift: Problem, solved: SolverResult) -> None:
    """Weighted integrals by Pinocchio against f of the NLP."""
    spline = RestToRestSpline(10)
    terms = objective_terms(small_lift, motion_at(small_lift, spline, solved.x, spline.phase))
    weights = objective_weights(small_lift)
    assert list(terms) == ["human", "robot", "acceleration", "force"] == list(weights)
    np.testing.assert_allclose(sum(weights[name] * terms[name] for name in terms), solved.objective, rtol=1e-12)


def test_rates_are_derivatives_and_forces_are_linear(small_lift: Problem, solved: SolverResult) -> None:
    """Finite differences between knots; the middle of two knots has the mean of their forces."""
    spline, h = RestToRestSpline(10), 1e-5
    middle = (spline.phase[1:] + spline.phase[:-1]) / 2
    now, ahead, behind = (motion_at(small_lift, spline, solved.x, middle + step) for step in (0.0, h, -h))
    span = 2 * h * small_lift.task.duration
    at_knots = motion_at(small_lift, spline, solved.x, spline.phase)
    np.testing.assert_allclose(at_knots.time, np.linspace(0.0, 2.0, 11), atol=1e-15)
    for i, agent in enumerate(now.agents):
        np.testing.assert_allclose(agent.v, (ahead.agents[i].q - behind.agents[i].q) / span, atol=1e-7)
        np.testing.assert_allclose(agent.a, (ahead.agents[i].v - behind.agents[i].v) / span, atol=1e-6)
        force = at_knots.agents[i].load
        np.testing.assert_allclose(agent.load, (force[1:] + force[:-1]) / 2, atol=1e-12)
    np.testing.assert_allclose(now.object.pose_velocity, (ahead.object.pose - behind.object.pose) / span, atol=1e-7)


def test_agents_and_object_meet_and_balance(small_lift: Problem, solved: SolverResult) -> None:
    """Pinocchio on the full models: closure at its knots, and the five served rows of the object's balance."""
    spline = RestToRestSpline(10)
    motion = motion_at(small_lift, spline, solved.x, spline.phase)
    for i, agent in enumerate(motion.agents):
        gap = agent.p_world_hold - motion.object.grasp_position[:, i]
        assert np.abs(gap[spline.closure_knots]).max() <= 1e-6
    assert np.abs(motion.object.wrench[:, [0, 1, 2, 4, 5]]).max() <= 1e-6
