"""The interior point on lifts: Pinocchio in double precision and IPOPT judge what it returns."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import islice
from typing import Any

import numpy as np
import pytest

from liftopt.collocation.kkt import kkt_error
from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.solvers.banded import Banded, BandedOptions, elimination_order
from liftopt.collocation.solvers.banded_nlp import callback_nlp, knot_rows
from liftopt.collocation.solvers.deadline import NEVER, Deadline
from liftopt.collocation.solvers.ipopt import Ipopt
from liftopt.collocation.solvers.result import SolverResult
from liftopt.collocation.spline import Mesh, RestToRestSpline
from liftopt.collocation.task import LiftTask
from liftopt.errors import SolverError
from liftopt.scenario.build import agents_of, object_of, task_of
from liftopt.scenario.file import shipped_scenarios
from liftopt.scenario.model import Scenario, load_scenario
from liftopt.search.initial_guess import InitialGuess, PostureSolver, blend, naive_guess, seed_coordinates
from liftopt.search.solve import solve

extension = pytest.importorskip("_liftopt_banded")
TOLERANCE = 1e-6


def problem_of(scenario: Scenario, intervals: int = 20) -> Problem:
    team = Team.of(agents_of(scenario), object_of(scenario))
    return Problem(team, task_of(scenario), RestToRestSpline(intervals).mesh())


def posture_pairs(problem: Problem) -> Iterator[np.ndarray]:
    """Give blends of static postures as they are found."""
    postures, rng, task = PostureSolver(problem.team, problem.task), np.random.default_rng(0), problem.task
    for attempt in range(24):
        seed = seed_coordinates(problem, task.start, rng if attempt else None)
        first = postures.solve(task.start, seed, NEVER)
        last = first and postures.solve(task.end, first.coordinates, NEVER)
        if first and last:
            yield blend(problem, first, last)


def posture_pair(problem: Problem) -> np.ndarray:
    """Return one blend of static postures, the first that is found."""
    return next(posture_pairs(problem))


@pytest.fixture(scope="session")
def banded(small_lift: Problem) -> Banded:
    return Banded(small_lift)


@pytest.fixture(scope="session")
def found(banded: Banded, starts: list[InitialGuess]) -> SolverResult:
    return banded.solve(starts[0].x, deadline=NEVER)


def test_small_lift_is_solved(found: SolverResult, small_lift: Problem, solved: SolverResult) -> None:
    """KKT error and objective by Pinocchio; IPOPT from the same start is the yardstick of the objective."""
    assert found.converged and found.status == "Solve_Succeeded" and 0 < found.iterations < 150
    error = kkt_error(small_lift, found.x, found.multipliers)
    assert error.error <= TOLERANCE
    np.testing.assert_allclose(error.objective, found.objective, rtol=1e-12)
    assert found.objective <= 1.05 * solved.objective
    assert 0.0 < found.evaluation_seconds < found.seconds


def test_ipopt_stays_at_its_solution(found: SolverResult, ipopt: Ipopt) -> None:
    polished = ipopt.solve(found.x, deadline=NEVER, warm=found.multipliers)
    assert polished.converged and polished.iterations <= 8
    np.testing.assert_allclose(polished.objective, found.objective, rtol=1e-6)
    np.testing.assert_allclose(polished.x, found.x, rtol=0, atol=5e-3)  # newtons and radians


def test_it_stays_at_ipopts_solution(banded: Banded, solved: SolverResult) -> None:
    again = banded.solve(solved.x, deadline=NEVER, warm=solved.multipliers)
    assert again.converged and again.iterations <= 8
    np.testing.assert_allclose(again.objective, solved.objective, rtol=1e-6)


def test_warm_start_of_a_neighbouring_task(
    banded: Banded, found: SolverResult, small_lift: Problem, make_task: Callable[..., LiftTask]
) -> None:
    task = make_task(agent_weights=(1.0, 1.0), duration=2.05)
    other = replace(small_lift, task=replace(task, end=task.end - np.array([0.0, 0.0, 0.02, 0.0, 0.0, 0.0])))
    warm = banded.solve(found.x, deadline=NEVER, warm=found.multipliers, problem=other)
    assert warm.converged and warm.iterations <= found.iterations / 2
    assert kkt_error(other, warm.x, warm.multipliers).error <= TOLERANCE


def test_a_problem_with_other_rows_is_refused(
    banded: Banded, starts: list[InitialGuess], small_lift: Problem, make_task: Callable[..., LiftTask]
) -> None:
    other = replace(small_lift, task=make_task(agent_weights=(1.0, 1.0), max_grasp_force=50.0))
    with pytest.raises(SolverError, match="other constraint rows"):
        banded.solve(starts[0].x, deadline=NEVER, problem=other)


def test_limits_of_time_and_iterations_are_reported(
    small_lift: Problem, banded: Banded, starts: list[InitialGuess]
) -> None:
    late = banded.solve(starts[0].x, deadline=Deadline.after(-1.0))
    assert not late.converged and late.status == "User_Requested_Stop" and late.iterations == 0
    few = Banded(small_lift, BandedOptions(max_iterations=3)).solve(starts[0].x, deadline=NEVER)
    assert not few.converged and few.status == "Maximum_Iterations_Exceeded" and few.iterations == 3


def test_infeasible_task_is_not_called_solved(
    banded: Banded, starts: list[InitialGuess], small_lift: Problem, make_task: Callable[..., LiftTask]
) -> None:
    """A metre out of reach."""
    task = make_task(agent_weights=(1.0, 1.0), x=-1.5)
    assert not banded.solve(starts[0].x, deadline=NEVER, problem=replace(small_lift, task=task)).converged


def test_any_team_without_a_compiler(arm_team: Team, make_task: Callable[..., LiftTask]) -> None:
    """Two arms of four joints and a box, evaluated by CasADi's virtual machine: Newton's matrix through Python."""
    problem = Problem(arm_team, make_task(), RestToRestSpline(6).mesh())
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CC", "")
        patch.setenv("LIFTOPT_CACHE", "/dev/null/none")
        banded = Banded(problem, BandedOptions(max_iterations=3))
    result = banded.solve(naive_guess(problem).x, deadline=NEVER)
    assert result.iterations == 3 and np.isfinite(result.objective)


def test_derivatives_agree_with_casadis(small_lift: Problem, starts: list[InitialGuess]) -> None:
    """As many iterations by the SIMD kernels and by CasADi's functions through Python, where both take Newton's matrix.

    That is near an optimum: elsewhere the one leaves out curvature, which the other cannot tell from the rest.
    """
    optimum = Banded(small_lift).solve(starts[0].x, deadline=NEVER)
    assert optimum.converged
    near = optimum.x + 1e-5 * np.random.default_rng(0).standard_normal(len(optimum.x))
    options = BandedOptions(max_iterations=8)
    simd = Banded(small_lift, options)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("liftopt.collocation.solvers.banded.kernels_for_simd", lambda *_: None)
        slow = Banded(small_lift, options)
    one, other = (solver.solve(near, deadline=NEVER, warm=optimum.multipliers) for solver in (simd, slow))
    assert one.converged and other.converged and abs(one.iterations - other.iterations) <= 1
    np.testing.assert_allclose(one.objective, other.objective, rtol=1e-9)
    np.testing.assert_allclose(one.x, other.x, rtol=0, atol=1e-5)
    np.testing.assert_allclose(one.multipliers.g, other.multipliers.g, rtol=0, atol=1e-3)


def test_rows_are_measured_as_casadi_has_them(small_lift: Problem, banded: Banded) -> None:
    """Closure's entries have one term each, others up to three, of which the kernels' measure is the largest."""
    x = np.random.default_rng(2).normal(size=small_lift.layout.n_x)
    exact = np.abs(small_lift.nlp.jac_g(x, small_lift.parameters)[1].full()).max(axis=1)
    slow = callback_nlp(extension, small_lift.nlp, small_lift.parameters)
    np.testing.assert_allclose(slow.row_sizes(x), exact, rtol=1e-12)
    banded.evaluate(x, small_lift)
    sizes = banded._nlp.row_sizes(x)
    closure = np.concatenate(
        [np.arange(len(exact))[block.rows] for block in small_lift.constraints.blocks if block.name == "grasp_closure"]
    )
    np.testing.assert_allclose(sizes[closure], exact[closure], rtol=1e-12)
    assert (exact <= 3 * sizes * (1 + 1e-12)).all()


@pytest.mark.parametrize("grasps", [(), ("human.grasp=wrench",)])
def test_rows_of_a_balance_at_rest_are_measured_exactly(grasps: tuple[str, ...]) -> None:
    """By CasADi's Jacobian; on one knot there are no accelerations, so that an entry has one term."""
    scenario = load_scenario("table5_paper", grasps)
    problem = Problem(Team.of(agents_of(scenario), object_of(scenario)), task_of(scenario), Mesh.at_rest())
    solver = Banded(problem)
    x = np.random.default_rng(2).normal(size=problem.layout.n_x)
    solver.evaluate(x, problem)
    exact = np.abs(problem.nlp.jac_g(x, problem.parameters)[1].full()).max(axis=1)
    rows = next(block.rows for block in problem.constraints.blocks if block.name == "balance")
    np.testing.assert_allclose(solver._nlp.row_sizes(x)[rows], exact[rows], rtol=1e-9)


def test_linear_systems_of_a_fine_mesh_need_hardly_any_refinement() -> None:
    """Closure acts on positions, balance on accelerations: one penalty for both takes two each iteration."""
    problem = problem_of(load_scenario("table5_paper"), 80)
    solver = Banded(problem)
    result = solver.solve(posture_pair(problem), deadline=NEVER)
    assert result.converged and kkt_error(problem, result.x, result.multipliers).error <= TOLERANCE
    assert solver.details["refinements"] < result.iterations


def test_a_rough_solve_stops_early_near_the_optimum(small_lift: Problem, starts: list[InitialGuess]) -> None:
    """Pinocchio: its KKT error is below the share of the objective that was asked for, its rows hold all the same."""
    share = 1e-4
    exact, rough = (Banded(small_lift, BandedOptions(rough=r)).solve(starts[0].x, deadline=NEVER) for r in (0.0, share))
    assert exact.converged and rough.converged and rough.iterations < exact.iterations
    assert rough.objective == pytest.approx(exact.objective, rel=1e-2)
    assert TOLERANCE < kkt_error(small_lift, rough.x, rough.multipliers).error <= share * rough.objective
    _, g = Banded(small_lift).evaluate(rough.x)
    assert (g >= small_lift.constraints.lower - TOLERANCE).all() and (
        g <= small_lift.constraints.upper + TOLERANCE
    ).all()


def test_far_from_a_solution_it_finds_one_where_ipopt_stays(small_lift: Problem, banded: Banded, ipopt: Ipopt) -> None:
    """From the naive start Newton's matrix is indefinite and curvature is left out; the end must not tell."""
    found = banded.solve(naive_guess(small_lift).x, deadline=NEVER)
    assert found.converged and kkt_error(small_lift, found.x, found.multipliers).error <= TOLERANCE
    stays = ipopt.solve(found.x, deadline=NEVER, warm=found.multipliers)
    assert stays.converged and stays.objective == pytest.approx(found.objective, rel=1e-6)


def test_forces_first_is_the_cheaper_order(small_lift: Problem, banded: Banded) -> None:
    """The count of multiplications, against control points first."""
    order = elimination_order(small_lift)
    knots = len(small_lift.mesh.phase)
    other = extension.InteriorPoint(banded._nlp, order[knots:] + order[:knots])
    assert banded.multiplications < 0.8 * other.multiplications()


def test_work_is_linear_in_the_intervals(team: Team, make_task: Callable[..., LiftTask]) -> None:
    counts = [Banded(Problem(team, make_task(), RestToRestSpline(n).mesh())).multiplications for n in (10, 20, 40)]
    np.testing.assert_allclose((counts[2] - counts[1]) / (counts[1] - counts[0]), 2.0, rtol=0.01)


def test_knot_rows_make_up_the_constraints(small_lift: Problem) -> None:
    """Every row of G is one of a knot or empty, and none is left out."""
    constraints, knots = small_lift.constraints, len(small_lift.mesh.weights)
    sizes = [kernel.n_c for kernel in small_lift.team.kernels]
    first = np.concatenate([[0], np.cumsum(sizes) * knots])
    rebuilt = np.zeros(constraints.combine.shape)
    for terms, rows in knot_rows(small_lift):
        for knot in np.flatnonzero(rows >= 0):
            for part, output, factor in terms:
                rebuilt[rows[knot], first[part] + knot * sizes[part] + output] += factor
    np.testing.assert_array_equal(rebuilt, constraints.combine.toarray())


def test_objective_and_rows_agree_with_casadis(
    small_lift: Problem, banded: Banded, starts: list[InitialGuess], make_task: Callable[..., LiftTask]
) -> None:
    """And with those of a neighbouring task, set without building anything."""
    other = replace(small_lift, task=make_task(agent_weights=(1.0, 1.0), duration=2.5))
    for problem in (small_lift, other, small_lift):
        f, _ = problem.nlp.grad_f(starts[0].x, problem.parameters)
        g, _ = problem.nlp.jac_g(starts[0].x, problem.parameters)
        found, rows = banded.evaluate(starts[0].x, problem)
        np.testing.assert_allclose(found, float(f), rtol=1e-12)
        np.testing.assert_allclose(rows, g.full().ravel(), rtol=0, atol=1e-9)
        assert banded.objective(starts[0].x, problem) == found


def test_kernels_need_no_assembled_problem(team: Team, make_task: Callable[..., LiftTask]) -> None:
    """Neither the solver nor a solution touches the functions that CasADi would assemble."""
    problem = Problem(team, make_task(agent_weights=(1.0, 1.0)), RestToRestSpline(12).mesh())
    Banded(problem, BandedOptions(max_iterations=1)).solve(naive_guess(problem).x, deadline=NEVER)
    assert "nlp" not in vars(problem)


def test_two_threads_solve_on_two_solvers(small_lift: Problem, found: SolverResult, starts: list[InitialGuess]) -> None:
    """The same numbers as alone."""
    from concurrent.futures import ThreadPoolExecutor

    solvers = [Banded(small_lift), Banded(small_lift)]
    with ThreadPoolExecutor(2) as pool:
        results = list(pool.map(lambda solver: solver.solve(starts[0].x, deadline=NEVER), solvers))
    for result in results:
        np.testing.assert_array_equal(result.x, found.x)


@pytest.mark.parametrize("name", [name for name in shipped_scenarios() if name.startswith("table5")])
def test_shipped_scenarios_by_the_papers_objective(name: str) -> None:
    """N = 20 from one posture pair: verified KKT error, and an objective in the band of IPOPT's from the same start."""
    problem = problem_of(load_scenario(name, {"objective.preset": "paper"}))
    x = posture_pair(problem)
    result, reference = Banded(problem).solve(x, deadline=NEVER), Ipopt(problem).solve(x, deadline=NEVER)
    assert result.converged and kkt_error(problem, result.x, result.multipliers).error <= TOLERANCE
    assert result.objective <= 1.3 * reference.objective


@pytest.mark.parametrize("name", ["table5", "table5_near", "table5_free"])
def test_shipped_scenarios_with_a_natural_motion(name: str) -> None:
    """From posture pairs that lead IPOPT to an optimum, as above; one of table5_near's leads neither solver to any."""
    problem = problem_of(load_scenario(name))
    pairs = list(islice(posture_pairs(problem), 3))
    solver, reference = Banded(problem), Ipopt(problem)
    answers = [(solver.solve(x, deadline=NEVER), reference.solve(x, deadline=NEVER)) for x in pairs]
    both = [(found, other) for found, other in answers if other.converged]
    assert len(both) >= 2
    for found, other in both:
        assert found.converged and kkt_error(problem, found.x, found.multipliers).error <= TOLERANCE
        assert found.objective <= 1.3 * other.objective


def test_varied_scenarios_at_the_first_try() -> None:
    """Statures, masses, heights, distances and durations: 19 of 20 at the first try, each KKT error by Pinocchio."""
    rng, base, banded, failed = np.random.default_rng(11), load_scenario("table5_paper"), None, []
    ranges = {
        "human.stature": (1.55, 1.92), "human.mass": (52.0, 98.0), "object.mass": (1.0, 4.0), "duration": (1.4, 3.0),
        "task.start.height": (0.75, 1.0), "task.end.height": (1.2, 1.5), "task.standing_distance": (1.75, 2.05),
    }  # fmt: skip
    for _ in range(20):
        changes = {key: round(rng.uniform(*bounds), 3) for key, bounds in ranges.items()}
        problem = problem_of(base.replace(changes))
        banded = banded or Banded(problem)
        result = banded.solve(posture_pair(problem), deadline=NEVER, problem=problem)
        if not result.converged or kkt_error(problem, result.x, result.multipliers).error > TOLERANCE:
            failed.append((changes, result.status))
    assert len(failed) <= 1, failed


def test_ipopt_takes_over_where_it_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    """The record and the progress say so, and the solution is IPOPT's, verified."""
    own_solve = Banded.solve

    def fail(self: Banded, *args: Any, **options: Any) -> SolverResult:
        return replace(own_solve(self, *args, **options), converged=False, status="Line_Search_Failed")

    monkeypatch.setattr(Banded, "solve", fail)
    lines: list[str] = []
    scenario = load_scenario("table5_paper").replace(
        {"solver.name": "banded", "solver.starts": 2, "solver.intervals": 16}
    )
    solution = solve(scenario, progress=lines.append)
    assert solution.verification.passed and any("IPOPT takes over" in line for line in lines)
    assert {start.status for start in solution.starts[:2]} == {"converged (IPOPT, after banded: Line_Search_Failed)"}
