"""Starts: Pinocchio judges the postures, and equal seeds must give equal starts."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
import pinocchio as pin
import pytest

from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.solvers.deadline import NEVER, Deadline
from liftopt.collocation.solvers.result import Multipliers, SolverResult
from liftopt.collocation.spline import RestToRestSpline
from liftopt.collocation.task import LiftTask
from liftopt.errors import SolverError
from liftopt.search import postures
from liftopt.search.initial_guess import (
    PRESSED,
    InitialGuess,
    initial_guesses,
    naive_guess,
    posture_starts,
    recombined,
    turned_back,
)
from liftopt.search.moves import ELSEWHERE, SAME_MOVE, Move, _least_there, apart, combinations
from liftopt.search.postures import PostureSolver, seed_coordinates


@pytest.mark.parametrize("end", ["start", "end"])
def test_posture_holds_the_object(end: str, team: Team, make_task: Callable[..., LiftTask]) -> None:
    """Pinocchio: closure, static balance on the five rows, torque and joint limits, the pose asked for."""
    task = make_task(agent_weights=(1.0, 1.0))
    pose = getattr(task, end)
    solver, rng = PostureSolver(team, task), np.random.default_rng(0)
    problem = Problem(team, task, RestToRestSpline(6).mesh())
    seeds = (seed_coordinates(problem, pose, rng) for _ in range(6))
    posture = next(filter(None, (solver.solve(pose, seed, NEVER) for seed in seeds)), None)
    assert posture is not None
    at = posture.coordinates[-6:]
    given = ~np.isnan(pose)
    np.testing.assert_allclose(at[given], pose[given], atol=1e-9)
    turn = [pin.utils.rotate(axis, angle) for axis, angle in zip("xyz", at[3:], strict=True)]
    rotation, first = turn[0] @ turn[1] @ turn[2], 0
    held, moment = team.object.model, np.zeros(3)
    for i, agent in enumerate(team.agents):
        model, f = agent.reduced(), posture.force[3 * i : 3 * i + 3]
        q = posture.coordinates[first : first + model.nv]
        first += model.nv
        data, frame = model.createData(), model.getFrameId(agent.grasp_frame)
        tau = pin.computeGeneralizedGravity(model, data, q).copy()
        tau += pin.computeFrameJacobian(model, data, q, frame, pin.LOCAL_WORLD_ALIGNED)[:3].T @ f
        limits = agent.limits
        assert (q >= limits.q_lower - 1e-9).all() and (q <= limits.q_upper + 1e-9).all()
        assert (tau >= limits.tau_lower - 1e-5).all() and (tau <= limits.tau_upper + 1e-5).all()
        pin.framesForwardKinematics(model, data, q)
        lever = held.frames[held.getFrameId(team.object.grasp_frames[i])].placement.translation
        np.testing.assert_allclose(data.oMf[frame].translation, at[:3] + rotation @ lever, atol=1e-7)
        assert np.linalg.norm(f) <= task.max_grasp_force
        moment += np.cross(lever, rotation.T @ f)
    np.testing.assert_allclose(posture.force.reshape(-1, 3).sum(axis=0), [0.0, 0.0, 2.0 * 9.81], atol=1e-6)
    np.testing.assert_allclose(moment[1:], 0.0, atol=1e-6)


def test_free_coordinates_of_a_pose_are_found(team: Team, make_task: Callable[..., LiftTask]) -> None:
    """NaN leaves fore-aft and sideways to the solver; the height stays the asked one."""
    task = make_task(x=np.nan, agent_weights=(1.0, 1.0))
    problem = Problem(team, task, RestToRestSpline(6).mesh())
    seed = seed_coordinates(problem, task.start, None)
    posture = PostureSolver(team, task).solve(task.start, seed, NEVER)
    assert posture is not None and np.isfinite(posture.coordinates).all()
    assert posture.coordinates[-4] == pytest.approx(0.91, abs=1e-9)


def test_pose_out_of_reach_has_no_posture(team: Team, make_task: Callable[..., LiftTask]) -> None:
    """Sawyer reaches about 1.3 m with its tool; the object is three metres away from it."""
    task = make_task(x=-1.2, agent_weights=(1.0, 1.0))
    seed = seed_coordinates(Problem(team, task, RestToRestSpline(6).mesh()), task.start, None)
    assert PostureSolver(team, task).solve(task.start, seed, NEVER) is None


def test_what_inverse_kinematics_cannot_close_costs_no_solve(
    team: Team, make_task: Callable[..., LiftTask], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Three metres away no seed closes, so the solver is never asked."""
    task = make_task(x=-1.2, agent_weights=(1.0, 1.0))
    solver, problem = PostureSolver(team, task), Problem(team, task, RestToRestSpline(6).mesh())
    monkeypatch.setattr(solver, "_solvers", [None])
    seeds = [seed_coordinates(problem, task.start, np.random.default_rng(i)) for i in range(5)]
    assert list(solver.search(task.start, seeds, NEVER)) == [None] * 5


def test_ipopt_finds_the_same_posture_where_the_banded_solver_is_missing(
    team: Team, make_task: Callable[..., LiftTask], monkeypatch: pytest.MonkeyPatch
) -> None:
    """From several postures that one solver found the other finds some again; from the rest it goes elsewhere."""
    task = make_task(agent_weights=(1.0, 1.0))
    problem, rng = Problem(team, task, RestToRestSpline(6).mesh()), np.random.default_rng(0)
    seeds = [seed_coordinates(problem, task.start, rng) for _ in range(20)]
    found = list(filter(None, PostureSolver(team, task).search(task.start, seeds, NEVER)))

    def missing(*_: object) -> None:
        raise SolverError("not installed")

    monkeypatch.setattr(postures, "Banded", missing)
    solver = PostureSolver(team, task)
    again = [solver.solve(task.start, posture.coordinates, NEVER) for posture in found]
    same = [one and np.isclose(one.cost, posture.cost, rtol=1e-4) for one, posture in zip(again, found, strict=True)]
    assert sum(map(bool, same)) >= 2


def test_postures_held_two_at_a_time_are_the_same_bit_by_bit(team: Team, make_task: Callable[..., LiftTask]) -> None:
    task, rng = make_task(), np.random.default_rng(3)
    problem = Problem(team, task, RestToRestSpline(6).mesh())
    seeds = [seed_coordinates(problem, task.start, rng) for _ in range(12)]
    alone = PostureSolver(team, task)
    both = PostureSolver(team, task, like=alone, workers=2)
    one, other = (list(solver.search(task.start, seeds, NEVER)) for solver in (alone, both))
    assert sum(posture is not None for posture in one) > 2
    for first, second in zip(one, other, strict=True):
        assert (first is None) == (second is None)
        if first and second:
            np.testing.assert_array_equal(first.coordinates, second.coordinates)
            np.testing.assert_array_equal(first.force, second.force)


def _moves(*promises: float, at: float = 0.0) -> list[Move]:
    return [Move(n, n, promise, (at, 0.0, 0.0, at, 0.0, 0.0)) for n, promise in enumerate(promises)]


def test_agents_change_their_moves_in_turn() -> None:
    """By hand: the best of each, then one agent's second, the other's second, and so on until one has no more."""
    moves = [_moves(1.0, 2.0, 3.0), _moves(1.0, 5.0)]
    assert combinations(moves, 10) == [(None, (0, 0)), (0, (1, 0)), (1, (0, 1)), (0, (2, 0))]
    assert combinations(moves, 2) == [(None, (0, 0)), (0, (1, 0))]
    assert combinations([_moves(1.0)], 5) == [(None, (0,))]


def test_moves_go_with_those_that_have_the_object_nearby() -> None:
    """By hand: 3 + 1 a metre apart counts 8, 3 + 4 in one place 7."""
    moves = [_moves(3.0), [*_moves(1.0, at=1.0), *_moves(4.0)]]
    assert combinations(moves, 10) == [(None, (0, 1)), (1, (0, 0))]


def test_what_others_need_with_the_object_there_comes_from_the_nearest_good_posture() -> None:
    """By hand: a posture that needs 2 at 0.1 m, doubled by the distance, is better than 5 here."""
    places = np.array([[0.0, 0.0, 0.0], [ELSEWHERE, 0.0, 0.0]])
    np.testing.assert_allclose(_least_there(np.array([[5.0, 2.0], [1.0, 9.0]]), places), [[4.0, 2.0], [1.0, 2.0]])


def test_moves_of_an_agent_differ_and_the_most_promising_comes_first(small_lift: Problem) -> None:
    """Pinocchio's forward kinematics: no two moves begin and end with all links within a few centimetres."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("liftopt.search.moves.OTHERS_WEIGHT", 0.0)
        found = initial_guesses(small_lift, 8, 0, NEVER)
    assert found is not None
    for i, (agent, moves) in enumerate(zip(small_lift.team.agents, found.moves, strict=True)):
        assert 1 <= len(moves) <= 8
        assert [move.promise for move in moves] == sorted(move.promise for move in moves)
        columns, model = small_lift.layout.columns(i), agent.reduced()
        data = model.createData()

        def places(q: np.ndarray, model: pin.Model = model, data: pin.Data = data) -> np.ndarray:
            pin.forwardKinematics(model, data, q)
            joints = range(1, model.njoints)
            return np.array([data.oMi[j].act(model.inertias[j].lever) for j in joints])

        ends = [
            np.array([places(p[getattr(move, which)].coordinates[columns]) for move in moves])
            for p, which in ((found.first, "first"), (found.last, "last"))
        ]
        for n in range(len(moves)):
            for m in range(n):
                distance = max(np.linalg.norm(end[n] - end[m], axis=1).max() for end in ends)
                assert distance > SAME_MOVE


def test_turning_a_joint_about_its_own_axis_moves_nothing(team: Team) -> None:
    """Sawyer's last joint carries what is on its axis, so postures that differ in it alone are the same."""
    robot = team.agents[1]
    q = np.tile(robot.posture, (2, 1))
    q[1, -1] += 1.0
    assert apart(robot, q).max() < 0.01
    q[1, 0] += 1.0
    between = apart(robot, q)
    assert between[0, 1] == between[1, 0] > SAME_MOVE


def _result(start: InitialGuess, objective: float, converged: bool = True) -> SolverResult:
    return SolverResult(start.x, Multipliers(start.x, start.x), objective, 1, converged, "", 0.0, 0.0)


def test_best_moves_of_all_agents_come_together(small_lift: Problem) -> None:
    """Made-up results: each agent's control points are those of the start in which its move did best."""
    n = small_lift.layout.n_x
    tried = [(None, (0, 0)), (0, (1, 0)), (1, (0, 1)), (0, (2, 0))]
    starts = [InitialGuess(str(i), np.full(n, float(i)), moves, agent) for i, (agent, moves) in enumerate(tried)]
    results = [_result(start, objective) for start, objective in zip(starts, (10.0, 9.0, 8.0, 12.0), strict=True)]
    start = recombined(small_lift, starts, results)
    assert start is not None and start.moves == (1, 1)
    control, force = small_lift.unpack(start.x)
    columns = [small_lift.layout.columns(i) for i in range(3)]
    assert (control[:, columns[0]] == 1.0).all() and (control[:, columns[1]] == 2.0).all()
    assert (control[:, columns[2]] == 1.5).all() and (force == 1.5).all()
    # Where one agent alone did better, or one has no move that led anywhere, there is nothing to combine.
    assert recombined(small_lift, starts[:2], results[:2]) is None
    nowhere = [_result(starts[0], 10.0, False), results[1], _result(starts[2], 8.0, False), results[3]]
    assert recombined(small_lift, starts, nowhere) is None
    # A start between the nearest postures joins no known moves.
    unknown = [InitialGuess("nearest postures", naive_guess(small_lift).x), naive_guess(small_lift)]
    assert recombined(small_lift, unknown, [_result(start, 10.0) for start in unknown]) is None


def test_a_joint_that_presses_against_its_limit_turns_back(small_lift: Problem) -> None:
    """Sawyer's fifth joint has 5.96 rad: at its upper limit, a full turn back is its lower limit, to 0.33 rad."""
    robot, layout = small_lift.team.agents[1], small_lift.layout
    x = naive_guess(small_lift).x
    assert turned_back(small_lift, x) is None
    column = layout.control[:, layout.columns(1)][:, 4]
    x[column] = robot.limits.q_upper[4]
    start = turned_back(small_lift, x)
    assert start is not None
    np.testing.assert_allclose(start.x[column], robot.limits.q_lower[4])
    others = np.setdiff1d(np.arange(len(x)), column)
    np.testing.assert_array_equal(start.x[others], x[others])
    x[column] = robot.limits.q_upper[4] - 2 * PRESSED
    assert turned_back(small_lift, x) is None


def test_starts_join_the_postures_of_their_moves_at_rest(starts: list[InitialGuess], small_lift: Problem) -> None:
    """Within bounds; each agent stands as in its own postures, the object as it does there in the mean."""
    assert 1 <= len(starts) <= 2
    assert [start.name for start in starts] == [f"posture pair {i + 1}" for i in range(len(starts))]
    found = initial_guesses(small_lift, 2, 0, NEVER)
    assert found is not None
    lower, upper = small_lift.bounds()
    for start in starts:
        assert (start.x >= lower).all() and (start.x <= upper).all()
        control, _ = small_lift.unpack(start.x)
        moves = [found.moves[i][move] for i, move in enumerate(start.moves)]
        for row, own in ((0, [found.first[m.first] for m in moves]), (-1, [found.last[m.last] for m in moves])):
            for i, posture in enumerate(own):
                columns = small_lift.layout.columns(i)
                np.testing.assert_allclose(control[row, columns], posture.coordinates[columns], atol=1e-9)
            mean = np.mean([posture.coordinates[-6:] for posture in own], axis=0)
            np.testing.assert_allclose(control[row, -6:], mean, atol=1e-9)


def test_equal_seeds_give_equal_starts(small_lift: Problem, starts: list[InitialGuess]) -> None:
    again = posture_starts(small_lift, 2, 0, NEVER)
    assert len(again) == len(starts)
    for one, other in zip(starts, again, strict=True):
        np.testing.assert_array_equal(one.x, other.x)


def test_two_starts_differ(starts: list[InitialGuess]) -> None:
    if len(starts) == 2:
        assert np.abs(starts[0].x - starts[1].x).max() > 0.05


def test_no_time_no_starts(small_lift: Problem) -> None:
    began = time.monotonic()
    assert posture_starts(small_lift, 4, 0, Deadline.after(-1.0)) == []
    assert time.monotonic() - began < 5.0


def test_naive_start_is_the_papers(small_lift: Problem) -> None:
    """Zeros and 10 N, clipped to the bounds."""
    start = naive_guess(small_lift)
    control, force = small_lift.unpack(start.x)
    lower, upper = small_lift.bounds()
    np.testing.assert_array_equal(control, np.clip(0.0, *(small_lift.unpack(bound)[0] for bound in (lower, upper))))
    assert start.name == "naive" and (force == 10.0).all()


def test_naive_force_is_clipped(small_lift: Problem, make_task: Callable[..., LiftTask]) -> None:
    gentle = Problem(small_lift.team, make_task(max_grasp_force=4.0), small_lift.mesh)
    assert (gentle.unpack(naive_guess(gentle).x)[1] == 4.0).all()


def test_seeds_spread_within_the_ranges_of_motion(small_lift: Problem, rng: np.random.Generator) -> None:
    """Without a generator the comfortable postures and the pose; with one, other joints within their limits."""
    comfortable = seed_coordinates(small_lift, small_lift.task.start, None)
    agents = small_lift.team.agents
    np.testing.assert_array_equal(comfortable[:-6], np.concatenate([agent.posture for agent in agents]))
    np.testing.assert_array_equal(comfortable[-6:], np.nan_to_num(small_lift.task.start))
    spread = seed_coordinates(small_lift, small_lift.task.start, rng)
    lower = np.concatenate([agent.limits.q_lower for agent in agents])
    upper = np.concatenate([agent.limits.q_upper for agent in agents])
    assert (spread[:-6] >= lower).all() and (spread[:-6] <= upper).all()
    assert np.abs(spread[:-6] - comfortable[:-6]).max() > 0.1
