"""Alternative paths and via postures: Pinocchio tells whether grasps hold, and that only what should has changed."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from liftopt.collocation.batch import Batch
from liftopt.collocation.layout import OBJECT_SIZE
from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.deadline import NEVER, Deadline
from liftopt.search.alternative_paths import GAP, MOST, SAME_PATH, alternative_paths
from liftopt.search.initial_guess import InitialGuess
from liftopt.search.moves import apart
from liftopt.search.postures import PostureSolver
from liftopt.search.via_postures import APART, TOO_HIGH, low_cost_postures, via_postures


@pytest.fixture(scope="module")
def solver(small_lift: Problem) -> PostureSolver:
    """Static postures of the team."""
    return PostureSolver(small_lift.team, small_lift.task)


def _gaps(problem: Problem, x: np.ndarray) -> np.ndarray:
    """Return the distance between each agent's grasp and its point on the object at every knot, (K, agents) [m]."""
    control, _ = problem.unpack(x)
    coordinates, lifted = problem.mesh.basis[0] @ control, problem.team.object
    gaps = np.zeros((len(coordinates), len(problem.team.agents)))
    for k, row in enumerate(coordinates):
        turn = [pin.utils.rotate(axis, angle) for axis, angle in zip("xyz", row[-3:], strict=True)]
        placement = pin.SE3(turn[0] @ turn[1] @ turn[2], row[-OBJECT_SIZE:-3])
        for i, agent in enumerate(problem.team.agents):
            model = agent.reduced()
            data = model.createData()
            pin.framesForwardKinematics(model, data, row[problem.layout.columns(i)])
            hand = data.oMf[model.getFrameId(agent.hands[0])].translation
            edge = lifted.model.frames[lifted.model.getFrameId(lifted.grasp_frames[i])].placement.translation
            gaps[k, i] = np.linalg.norm(hand - placement.act(edge))
    return gaps


def test_another_way_changes_one_agent_whose_hand_stays_with_the_object(
    small_lift: Problem, solver: PostureSolver, starts: list[InitialGuess]
) -> None:
    """Knot by knot the spline is a fit: what Pinocchio finds may be a little more than the gap allowed on the way."""
    x, layout = starts[0].x, small_lift.layout
    found = alternative_paths(small_lift, solver.kinematics, x, np.random.default_rng(1), NEVER)
    assert len(found) >= 2
    lower, upper = small_lift.bounds()
    for i, agent in enumerate(small_lift.team.agents):
        own = layout.control[:, layout.columns(i)]
        mine = [start for start in found if start.name.startswith(agent.name)]
        assert [start.name for start in mine] == [f"{agent.name} another way {n + 1}" for n in range(len(mine))]
        assert 1 <= len(mine) <= MOST
        for start in mine:
            assert (start.x >= lower).all() and (start.x <= upper).all()
            np.testing.assert_array_equal(np.delete(start.x, own.ravel()), np.delete(x, own.ravel()))
        ways = np.array([small_lift.mesh.basis[0] @ y[own] for y in (x, *(start.x for start in mine))])
        middle = ways.shape[1] // 2
        between = np.max([apart(agent, ways[:, k]) for k in (0, middle, -1)], axis=0)
        assert (between[~np.eye(len(ways), dtype=bool)] > SAME_PATH / 2).all()
        gaps = np.array([_gaps(small_lift, start.x)[:, i] for start in mine])
        assert np.median(gaps) < GAP


def test_equal_random_numbers_give_equal_ways_and_no_time_gives_none(
    small_lift: Problem, solver: PostureSolver, starts: list[InitialGuess]
) -> None:
    x = starts[0].x
    one, two = (alternative_paths(small_lift, solver.kinematics, x, np.random.default_rng(1), NEVER) for _ in range(2))
    for mine, other in zip(one, two, strict=True):
        np.testing.assert_array_equal(mine.x, other.x)
    assert alternative_paths(small_lift, solver.kinematics, x, np.random.default_rng(1), Deadline.after(-1.0)) == []


def test_low_cost_postures_hold_the_object_anywhere_and_the_cheapest_comes_first(
    small_lift: Problem, solver: PostureSolver
) -> None:
    """Nothing at either end costs less than the best of all places, and no two postures are the same."""
    rng, until = np.random.default_rng(0), NEVER
    by = low_cost_postures(small_lift, solver, rng, until)
    costs = [posture.cost for posture in by]
    assert len(by) >= 2 and costs == sorted(costs)
    for pose in (small_lift.task.start, small_lift.task.end):
        held = solver.solve(pose, by[0].coordinates, until)
        assert held is None or held.cost >= costs[0] * (1 - 1e-3)
    q = np.array([posture.coordinates for posture in by])
    columns = [small_lift.layout.columns(i) for i in range(len(small_lift.team.agents))]
    between = np.max([apart(a, q[:, c]) for a, c in zip(small_lift.team.agents, columns, strict=True)], axis=0)
    assert (between[~np.eye(len(by), dtype=bool)] > APART).all()
    assert low_cost_postures(small_lift, solver, rng, Deadline.after(-1.0)) == []


def test_a_path_via_a_posture_passes_the_posture_of_its_leader_and_ends_as_before(
    small_lift: Problem, solver: PostureSolver, starts: list[InitialGuess]
) -> None:
    x, layout = starts[0].x, small_lift.layout
    by = low_cost_postures(small_lift, solver, np.random.default_rng(0), NEVER)
    found = via_postures(small_lift, solver.kinematics, x, by, NEVER)
    assert found
    before, after, middle = x[layout.control], Batch(small_lift), len(layout.mesh.phase) // 2
    limit = TOO_HIGH * after.objective(x[None])[0]
    for start in found:
        name, _, n = start.name.rpartition(" by way of posture ")
        leader = [agent.name for agent in small_lift.team.agents].index(name)
        control = start.x[layout.control]
        coordinates = layout.mesh.basis[0] @ control
        for part in (leader, layout.n_agents):
            columns = layout.columns(part)
            np.testing.assert_allclose(control[[0, -1], columns], before[[0, -1], columns], atol=0.1)
            np.testing.assert_allclose(coordinates[middle, columns], by[int(n) - 1].coordinates[columns], atol=0.1)
        np.testing.assert_array_equal(start.x[layout.force], x[layout.force])
        assert after.objective(start.x[None])[0] < limit
    assert via_postures(small_lift, solver.kinematics, x, [], NEVER) == []
