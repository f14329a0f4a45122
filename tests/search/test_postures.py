"""Static postures: Pinocchio judges whether they hold the object within every limit."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pinocchio as pin
import pytest

from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.solvers.deadline import NEVER
from liftopt.collocation.spline import RestToRestSpline
from liftopt.collocation.task import LiftTask
from liftopt.errors import SolverError
from liftopt.search import postures
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
    lifted, moment = team.object.model, np.zeros(3)
    for i, agent in enumerate(team.agents):
        model, f = agent.reduced(), posture.force[3 * i : 3 * i + 3]
        q = posture.coordinates[first : first + model.nv]
        first += model.nv
        data, frame = model.createData(), model.getFrameId(agent.hands[0])
        tau = pin.computeGeneralizedGravity(model, data, q).copy()
        tau += pin.computeFrameJacobian(model, data, q, frame, pin.LOCAL_WORLD_ALIGNED)[:3].T @ f
        limits = agent.limits
        assert (q >= limits.q_lower - 1e-9).all() and (q <= limits.q_upper + 1e-9).all()
        assert (tau >= limits.tau_lower - 1e-5).all() and (tau <= limits.tau_upper + 1e-5).all()
        pin.framesForwardKinematics(model, data, q)
        lever = lifted.frames[lifted.getFrameId(team.object.grasp_frames[i])].placement.translation
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
