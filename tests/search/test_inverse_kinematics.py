"""Grasps brought to the object from many seeds at once: Pinocchio and the ranges of motion judge where they end."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.solvers.deadline import NEVER, Deadline
from liftopt.collocation.spline import Mesh
from liftopt.collocation.task import LiftTask
from liftopt.multibody.agent import HalfSpace
from liftopt.search.inverse_kinematics import CLOSED, InverseKinematics
from liftopt.search.postures import seed_coordinates


def seeds_of(problem: Problem, count: int) -> np.ndarray:
    rng, pose = np.random.default_rng(3), problem.task.start
    return np.array([seed_coordinates(problem, pose, rng if i else None) for i in range(count)])


def hands_and_points(problem: Problem, coordinates: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return by Pinocchio each agent's grasp point and its point on the object."""
    x, pairs = coordinates[-6:], []
    turn = [pin.utils.rotate(axis, angle) for axis, angle in zip("xyz", x[3:], strict=True)]
    for i, agent in enumerate(problem.team.agents):
        model, lifted = agent.reduced(), problem.team.object
        data = model.createData()
        pin.framesForwardKinematics(model, data, coordinates[problem.layout.columns(i)])
        lever = lifted.model.frames[lifted.model.getFrameId(lifted.grasp_frames[i])].placement.translation
        hand = data.oMf[model.getFrameId(agent.hands[0])].translation.copy()
        pairs.append((hand, x[:3] + turn[0] @ turn[1] @ turn[2] @ lever))
    return pairs


@pytest.fixture(scope="module")
def at_rest(team: Team, make_task: Callable[..., LiftTask]) -> Problem:
    return Problem(team, make_task(agent_weights=(1.0, 1.0)), Mesh.at_rest())


@pytest.mark.parametrize("end", ["start", "end"])
def test_most_seeds_close_within_the_limits(at_rest: Problem, end: str) -> None:
    """Pinocchio: the gaps are what is said, the pose is the asked one, and no joint leaves its range."""
    pose = getattr(at_rest.task, end)
    reach = InverseKinematics(at_rest).reach(pose, seeds_of(at_rest, 24), NEVER, most=25)
    assert (reach.shortfall < CLOSED).sum() >= 16
    limits = [agent.limits for agent in at_rest.team.agents]
    lower, upper = (np.concatenate([getattr(one, side) for one in limits]) for side in ("q_lower", "q_upper"))
    for coordinates, gaps in zip(reach.coordinates, reach.gaps, strict=True):
        assert (coordinates[:-6] >= lower).all() and (coordinates[:-6] <= upper).all()
        given = ~np.isnan(pose)
        np.testing.assert_allclose(coordinates[-6:][given], pose[given], rtol=0, atol=1e-15)
        found = [np.linalg.norm(hand - point) for hand, point in hands_and_points(at_rest, coordinates)]
        np.testing.assert_allclose(found, gaps, rtol=0, atol=1e-12)


def test_many_seeds_at_once_are_as_each_alone(at_rest: Problem) -> None:
    """A seed's result does not depend on its company beyond rounding."""
    kinematics, seeds = InverseKinematics(at_rest), seeds_of(at_rest, 19)
    together = kinematics.reach(at_rest.task.start, seeds, NEVER, most=12)
    for i in (0, 7, 18):
        alone = kinematics.reach(at_rest.task.start, seeds[i : i + 1], NEVER, most=12)
        np.testing.assert_allclose(alone.coordinates[0], together.coordinates[i], rtol=0, atol=1e-9)


def test_a_stretched_arm_is_short_by_the_distance_beyond_it(at_rest: Problem) -> None:
    """Straight lines: an object moved away from a robot's stretched arm by 0.5 m is that much farther from it."""
    kinematics, near = InverseKinematics(at_rest), np.array([-1.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    far = near - np.array([0.5, 0, 0, 0, 0, 0])
    gaps = [kinematics.reach(pose, seeds_of(at_rest, 8), NEVER, most=300).gaps[:, 1].min() for pose in (near, far)]
    assert gaps[0] > 0.1
    assert 0.48 < gaps[1] - gaps[0] <= 0.5 + 1e-6


def test_half_space_holds_the_hand_and_can_be_left_out(at_rest: Problem) -> None:
    """A half-space 0.1 m beyond the grasp point: the hand stays that far from it, or is that far outside."""
    human = at_rest.team.agents[0]
    edge = at_rest.task.start[0] - 0.225
    walled = replace(human, workspace=HalfSpace(np.array([1.0, 0.0, 0.0]), edge + 0.1))
    problem = replace(at_rest, team=replace(at_rest.team, agents=(walled, at_rest.team.agents[1])))
    kinematics, seeds = InverseKinematics(problem), seeds_of(problem, 6)
    held = kinematics.reach(problem.task.start, seeds, NEVER, most=60)
    assert held.shortfall.min() > 0.03
    free = kinematics.reach(problem.task.start, seeds, NEVER, most=60, anywhere=True)
    closed = free.gaps.max(axis=1) < CLOSED
    assert closed.any()
    np.testing.assert_allclose(free.outside[closed], np.tile([0.1, 0.0], (closed.sum(), 1)), rtol=0, atol=1e-5)


def test_any_angle_reaches_what_the_ranges_forbid(at_rest: Problem) -> None:
    """An arm whose elbow is locked straight cannot hold at 0.4 m ahead of the feet; one that bends can."""
    human = at_rest.team.agents[0]
    limits = human.limits
    q_lower, q_upper = limits.q_lower.copy(), limits.q_upper.copy()
    q_lower[:3], q_upper[:3], q_lower[6], q_upper[6] = -0.01, 0.01, -0.01, 0.0
    stiff = replace(human, limits=replace(limits, q_lower=q_lower, q_upper=q_upper))
    problem = replace(at_rest, team=replace(at_rest.team, agents=(stiff, at_rest.team.agents[1])))
    kinematics, seeds = InverseKinematics(problem), seeds_of(problem, 6)
    assert kinematics.reach(problem.task.start, seeds, NEVER, most=60).shortfall.min() > 1e-3
    loose = kinematics.reach(problem.task.start, seeds, NEVER, most=60, any_angle=True)
    assert loose.shortfall.min() < CLOSED


def test_a_passed_deadline_leaves_the_seeds(at_rest: Problem) -> None:
    seeds = seeds_of(at_rest, 3)
    reach = InverseKinematics(at_rest).reach(at_rest.task.start, seeds, Deadline.after(-1.0), most=60)
    np.testing.assert_array_equal(reach.coordinates[:, :-6], seeds[:, :-6])
