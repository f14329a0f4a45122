"""Initial guesses: they join the postures that they name, and equal seeds must give equal ones."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.deadline import NEVER, Deadline
from liftopt.collocation.solvers.result import Multipliers, SolverResult
from liftopt.collocation.task import LiftTask
from liftopt.search.initial_guess import (
    PRESSED,
    InitialGuess,
    initial_guesses,
    naive_guess,
    posture_starts,
    recombined,
    turned_back,
)


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
