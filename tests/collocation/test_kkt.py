"""The KKT check must not believe what is wrong: finite differences and known perturbations are the oracles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from liftopt.collocation.dynamics import KnotFunctions, Topology
from liftopt.collocation.kkt import kkt_error
from liftopt.collocation.kkt_agent import agent_knots
from liftopt.collocation.kkt_object import object_knots
from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.result import Multipliers, SolverResult
from liftopt.multibody.agent import Agent, LiftedObject


@pytest.mark.parametrize("name", ["human", "sawyer", "arm"])
def test_agent_knot_jacobian_by_finite_differences(
    name: str,
    human: Agent,
    sawyer: Agent,
    make_arm: Callable[..., Agent],
    differences: Callable[..., np.ndarray],
    rng: np.random.Generator,
) -> None:
    agent = {"human": human, "sawyer": sawyer, "arm": make_arm(5)}[name]
    y = rng.normal(size=3 * agent.reduced().nv + 3)
    y[-3:] *= 20.0
    jacobian = agent_knots(agent, y[None], 1.7)[1][0]
    numeric = differences(lambda at: agent_knots(agent, at[None], 1.7)[0][0], y)
    np.testing.assert_allclose(jacobian, numeric, rtol=0, atol=1e-9 * np.abs(numeric).max())


def test_object_knot_jacobian_by_finite_differences(
    make_box: Callable[..., LiftedObject],
    table: LiftedObject,
    differences: Callable[..., np.ndarray],
    rng: np.random.Generator,
) -> None:
    for lifted in (table, make_box(rng.normal(size=(3, 3)))):
        y = rng.normal(size=18 + 3 * len(lifted.grasp_frames))
        jacobian = object_knots(lifted, y[None], 1.7, bare=True)[1][0]
        numeric = differences(lambda at, lifted=lifted: object_knots(lifted, at[None], 1.7, bare=True)[0][0], y)
        np.testing.assert_allclose(jacobian, numeric, rtol=0, atol=1e-9 * np.abs(numeric).max())


def test_knots_agree_with_the_uncompiled_functions(
    knot_functions: dict[str, tuple[pin.Model, Topology, KnotFunctions]],
    human: Agent,
    table: LiftedObject,
    rng: np.random.Generator,
) -> None:
    """Pinocchio's values in double precision against CasADi's, an independent path of both."""
    _, topology, functions = knot_functions["human"]
    y = rng.normal(size=33)
    (c,), (jacobian,) = agent_knots(human, y[None], 1.3)
    p = np.r_[1.3, topology.parameters]
    np.testing.assert_allclose(functions.value(y, p).full().ravel(), c, rtol=0, atol=1e-12 * np.abs(c).max())
    expected = functions.jacobian(y, p).full()
    np.testing.assert_allclose(expected, jacobian, rtol=0, atol=1e-12 * np.abs(expected).max())
    _, topology, functions = knot_functions["table"]
    y = rng.normal(size=24)
    (c,), (jacobian,) = object_knots(table, y[None], 1.3, bare=True)
    p = np.r_[1.3, topology.parameters]
    np.testing.assert_allclose(functions.value(y, p).full().ravel(), c, rtol=0, atol=1e-12 * np.abs(c).max())
    expected = functions.jacobian(y, p).full()
    np.testing.assert_allclose(expected, jacobian, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_perturbed_point_is_found_out(small_lift: Problem, solved: SolverResult, rng: np.random.Generator) -> None:
    """Errors grow with the perturbation; a thousandth of a radian is far from a KKT point."""
    good = kkt_error(small_lift, solved.x, solved.multipliers)
    x = solved.x + 1e-3 * rng.normal(size=len(solved.x))
    bad = kkt_error(small_lift, x, solved.multipliers)
    assert good.error <= 1e-6 and bad.violation > 1e-3 and bad.stationarity > 1e-3
    assert bad.error == max(bad.stationarity, bad.violation, bad.complementarity)


def test_wrong_multipliers_are_found_out(small_lift: Problem, solved: SolverResult) -> None:
    """No multipliers, or all of them with the other sign, leave the objective's gradient unbalanced."""
    none = Multipliers(np.zeros_like(solved.multipliers.x), np.zeros_like(solved.multipliers.g))
    negated = Multipliers(-solved.multipliers.x, -solved.multipliers.g)
    for multipliers in (none, negated):
        assert kkt_error(small_lift, solved.x, multipliers).stationarity > 1.0


def test_multiplier_of_an_inactive_row_or_of_the_wrong_side_is_found_out(
    small_lift: Problem, solved: SolverResult
) -> None:
    """Complementarity: a multiplier times a distance that is not zero, also at a bound that does not exist."""
    blocks = {(block.name, block.who): block for block in small_lift.constraints.blocks}
    for key, sign in ((("torque", "human"), 1.0), (("torque", "human"), -1.0), (("grasp_force", "robot"), -1.0),
                      (("workspace", "human"), 1.0)):  # fmt: skip
        g = solved.multipliers.g.copy()
        g[blocks[key].rows.start] += sign
        wrong = kkt_error(small_lift, solved.x, Multipliers(solved.multipliers.x, g))
        assert wrong.complementarity > 1e-2, key


def test_multiplier_of_a_bound_that_is_not_active_is_found_out(small_lift: Problem, solved: SolverResult) -> None:
    lower, upper = small_lift.bounds()
    inside = np.flatnonzero((solved.x - lower > 0.1) & (upper - solved.x > 0.1))[0]
    for sign in (-1.0, 1.0):
        x = solved.multipliers.x.copy()
        x[inside] += sign
        assert kkt_error(small_lift, solved.x, Multipliers(x, solved.multipliers.g)).complementarity > 1e-2


def test_violation_is_the_largest_one(small_lift: Problem, solved: SolverResult) -> None:
    """A fixed pose moved by 0.2 m is a violation of that size at least; a bound exceeded by 0.3 rad likewise."""
    layout = small_lift.layout
    for position, amount in ((layout.control[0, layout.columns(2)][2], 0.2), (layout.control[4, 0], 5.0)):
        x = solved.x.copy()
        x[position] += amount
        assert kkt_error(small_lift, x, solved.multipliers).violation >= 0.2


def test_nan_is_never_small(small_lift: Problem, solved: SolverResult) -> None:
    x = solved.x.copy()
    x[5] = np.nan
    error = kkt_error(small_lift, x, solved.multipliers)
    assert not error.error <= 1e-6


def test_nan_is_a_violation(small_lift: Problem, solved: SolverResult) -> None:
    x = solved.x.copy()
    x[5] = np.nan
    assert not kkt_error(small_lift, x, solved.multipliers).violation <= 1e-6


def test_another_subjects_point_is_not_optimal(small_lift: Problem, solved: SolverResult) -> None:
    """The models are those of the problem: one kilogram more leaves its weight unbalanced at rest."""
    lifted = small_lift.team.object
    model = lifted.model.copy()
    model.inertias[1] = type(model.inertias[1])(3.0, model.inertias[1].lever, model.inertias[1].inertia)
    other = replace(small_lift, team=replace(small_lift.team, object=replace(lifted, model=model)))
    assert kkt_error(other, solved.x, solved.multipliers).violation >= 9.81 - 1e-6
