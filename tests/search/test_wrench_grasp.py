"""Lifts whose grasps transmit moments: the share is a choice, and what holds them is verified, saved and read."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.solvers.banded import Banded
from liftopt.collocation.solvers.deadline import NEVER
from liftopt.collocation.solvers.result import SolverResult
from liftopt.collocation.spline import RestToRestSpline
from liftopt.crosscheck.energy import energy_books
from liftopt.errors import InputError
from liftopt.scenario.build import agents_of, object_of, task_of
from liftopt.scenario.model import load_scenario
from liftopt.solution.summary import load_share, summary_dict
from liftopt.solution.verify import verify
from liftopt.storage.reader import load_result

pytestmark = pytest.mark.long
BOTH = ("human.grasp=wrench", "robot.grasp=wrench")
FLAT = (*BOTH, "human.contact=flat", "human.friction=0.3")
CHEAP = ("solver.name=banded", "solver.starts=2")


@pytest.fixture(scope="module")
def wrench(solved: Callable[..., Any]) -> Any:
    return solved("table5_paper", *BOTH, *CHEAP)


@pytest.fixture(scope="module")
def flat() -> tuple[Problem, RestToRestSpline, SolverResult]:
    """A flat hand and a gripper, solved by the banded solver from the first posture pair."""
    from liftopt.search.initial_guess import posture_starts

    scenario, spline = load_scenario("table5_paper", FLAT), RestToRestSpline(20)
    problem = Problem(Team.of(agents_of(scenario), object_of(scenario)), task_of(scenario), spline.mesh())
    deadline = NEVER
    result = Banded(problem).solve(posture_starts(problem, 1, 0, deadline)[0].x, deadline=deadline)
    assert result.converged
    return problem, spline, result


def test_all_six_rows_of_balance_hold(wrench: Any) -> None:
    """Pinocchio: with point grasps the moment about the table's x axis is left over."""
    solution, agents = wrench.solution, wrench.solution.agents
    assert solution.solved, solution.status
    assert np.abs(solution.object.wrench).max() < 1e-6
    assert np.abs(solution.object.pose[:, 3]).max() <= np.radians(10.0) + 1e-9
    for agent, most in zip(agents, (10.0, 5.0), strict=True):
        moment = np.linalg.norm(agent.grasp_moment, axis=2)
        assert 0.1 < moment.max() <= most + 1e-6
    checks = {check.name for check in solution.verification.checks}
    assert {"grasp moment cap", "hand on the object"} <= checks and "unserved moment" not in checks


def test_energy_of_forces_and_moments_is_accounted_for(wrench: Any) -> None:
    """Conservation: the work of torques, forces and moments is the change of mechanical energy, agent by agent."""
    for book in energy_books(wrench.solution, 4):
        total = np.sum(list(book.work.values()), axis=0)
        np.testing.assert_allclose(total, book.change, rtol=0, atol=1e-4 * np.abs(book.change).max())


def test_file_keeps_the_moments(wrench: Any) -> None:
    again = load_result(wrench.folder)
    for one, other in zip(wrench.solution.agents, again.agents, strict=True):
        np.testing.assert_array_equal(one.grasp_moment, other.grasp_moment)
        np.testing.assert_array_equal(one.tau, other.tau)
        np.testing.assert_allclose(one.ground_moment, other.ground_moment, rtol=0, atol=1e-12)
        assert all(grasp.moments for grasp in other.grasps)
    np.testing.assert_allclose(wrench.solution.object.wrench, again.object.wrench, rtol=0, atol=1e-12)
    moments = summary_dict(again)["grasp_moment"]
    assert moments["robot"]["limit_Nm"] == 5.0 and moments["human"]["peak_Nm"] <= 10.0 + 1e-6


def test_both_solvers_agree(solved: Callable[..., Any], wrench: Any) -> None:
    """IPOPT from the same starts: the objective within 5 %, both verified."""
    other = solved("table5_paper", *BOTH, "solver.name=ipopt", *CHEAP[1:]).solution
    assert other.solved and wrench.solution.objective <= 1.05 * other.objective


def test_share_moves_with_the_weights_only_where_it_can(solved: Callable[..., Any]) -> None:
    """The dearer the person's torques, the less of the load; point grasps on a level table share it equally at rest.

    Closed form: two forces at the ends of a level body that is at rest balance its weight midway only by halves.
    """
    shares = {}
    for grasps, several in (((), (0.1, 10.0)), (BOTH, (0.1, 1.0, 10.0))):
        for weight in several:
            weights = f"human.weight={weight**0.5}", f"robot.weight={weight**-0.5}"
            still = ("solver.intervals=10", "task.rest=acceleration")
            solution = solved("table5_paper", *grasps, *weights, *CHEAP, *still).solution
            assert solution.solved, solution.status
            shares[bool(grasps), weight] = np.array(load_share(solution)["agents"]["human"]["share"])
    for weight in (0.1, 10.0):
        np.testing.assert_allclose(shares[False, weight][[0, -1]], 0.5, atol=1e-6)
    dear, even, cheap = (shares[True, weight] for weight in (10.0, 1.0, 0.1))
    assert (dear[[0, -1]] < even[[0, -1]] - 0.02).all() and (even[[0, -1]] < cheap[[0, -1]] - 0.02).all()
    assert dear.mean() < even.mean() - 0.1 < cheap.mean() - 0.2


def test_flat_hand_neither_pulls_slides_nor_tips(flat: tuple[Problem, RestToRestSpline, SolverResult]) -> None:
    """Every way to break a hold is put in on purpose; the verification names it, and names nothing before."""
    problem, spline, result = flat
    assert verify(problem, spline, result, 1e-6).passed
    layout, knot = problem.layout, 9
    force, moment = layout.force[knot, :3], layout.force[knot, 3:6]
    x = result.x
    assert x[layout.force[:, 2]].min() > 0.0

    def failing(at: np.ndarray | int, value: np.ndarray | float) -> set[str]:
        spoiled = x.copy()
        spoiled[at] = value
        found = verify(problem, spline, replace(result, x=spoiled), 1e-6)
        return {check.name for check in found.checks if not check.passed}

    assert "friction of the hand" in failing(force[0], 0.5 * x[force[2]])
    assert "friction of the hand" in failing(force[2], -1.0)
    assert "pressure of the hand" in failing(moment[1], 0.06 * x[force[2]])
    assert "grasp moment cap" in failing(layout.force[knot, 9:], np.full(3, 4.0))
    wrist = layout.control[knot, layout.columns(0)][7]
    assert "hand on the object" in failing(wrist, x[wrist] + 3.0)


def test_mixed_holds_are_the_same_in_both_evaluations(rng: np.random.Generator) -> None:
    """CasADi's assembly against the extension's, where one hold has moments and the other none."""
    for overrides in (["human.grasp=wrench"], ["human.contact=flat"], ["robot.grasp=wrench"]):
        scenario = load_scenario("table5_paper", overrides)
        team = Team.of(agents_of(scenario), object_of(scenario))
        problem = Problem(team, task_of(scenario), RestToRestSpline(6).mesh())
        x = np.clip(rng.normal(size=problem.layout.n_x), *problem.bounds())
        f, g = Banded(problem).evaluate(x)
        rows, p = problem.nlp.jac_g(x, problem.parameters)[0], problem.parameters
        np.testing.assert_allclose(g, rows.full().ravel(), rtol=0, atol=1e-10)
        np.testing.assert_allclose(f, float(problem.nlp.grad_f(x, p)[0]), rtol=1e-11)


@pytest.mark.parametrize("key", ["human.grasp=palm", "human.max_grasp_moment=0", "robot.grasp_turn_deg=181",
                                 "human.contact=glue", "human.friction=0", "limits.table_roll_deg=61"])  # fmt: skip
def test_keys_are_checked(key: str) -> None:
    with pytest.raises(InputError) as caught:
        load_scenario("table5_paper", [key])
    assert key.partition("=")[0] in str(caught.value)


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(5)
