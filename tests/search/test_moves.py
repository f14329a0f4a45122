"""Moves of each agent: ranked and combined as by hand, apart by Pinocchio's forward kinematics."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.solvers.deadline import NEVER
from liftopt.search.initial_guess import initial_guesses
from liftopt.search.moves import ELSEWHERE, SAME_MOVE, Move, _least_there, apart, combinations


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
