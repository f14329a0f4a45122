"""The second transcription. Oracles: Pinocchio in double precision, closed-form motions, the spline collocation."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
import pytest

import liftopt as lo
from liftopt.collocation.flat_hand import flat_hand_rows
from liftopt.collocation.soles import sole_rows
from liftopt.crosscheck.hermite_simpson import HermiteSimpson
from liftopt.crosscheck.holds import FOOT_FORCE_UNIT, FOOT_MOMENT_UNIT, FORCE_UNIT, MOMENT_UNIT
from liftopt.crosscheck.instant import instant
from liftopt.crosscheck.integrand import integrand
from liftopt.crosscheck.transcriptions import MeshRow, MeshStudy, mesh_study, points_of, render
from liftopt.ergonomics.spine import load_through
from liftopt.multibody.standing import ground_in_base
from liftopt.multibody.trajectory import (
    AgentTrajectory,
    agent_trajectory,
    attitude,
    hand_turn,
    object_trajectory,
    turned,
)
from liftopt.scenario.build import agents_of, object_of, task_of
from liftopt.solution.interpolation import resample
from liftopt.types import Array

pytestmark = pytest.mark.long
CHEAP = ("solver.intervals=10", "solver.starts=1")
STATES = 5
WHOLE = {"objective.preset": "natural", "human.body": "whole"}
HANDLES = {"object.grasps": {"human_right": "handle", "human_left": "handle"}}
FLAT = {"objective.preset": "natural", "human.contact": "flat", "human.friction": 0.5}


@pytest.fixture(scope="module")
def solution(solved: Callable[..., Any]) -> Any:
    return solved("table5_paper", *CHEAP).solution


@pytest.fixture(scope="module")
def natural(solved: Callable[..., Any]) -> Any:
    return solved("table5_paper", *CHEAP, "objective.preset=natural", "objective.spine_weight=300").solution


@pytest.fixture(scope="module")
def models(solution: Any) -> tuple[Any, ...]:
    scenario = solution.scenario
    return agents_of(scenario), object_of(scenario), task_of(scenario)


@pytest.fixture(scope="module")
def study(solution: Any) -> MeshStudy:
    return mesh_study(solution, (32, 64))


@pytest.fixture(scope="module")
def still(solved: Callable[..., Any]) -> MeshStudy:
    return mesh_study(solved("table5_paper", *CHEAP, "task.rest=acceleration").solution, (6, 12))


@pytest.mark.parametrize(
    ("keys", "free"),
    [
        ({}, [0, 1, 2, 4, 5]),
        (FLAT, [0, 1, 2, 3, 4, 5]),
        (FLAT | {"robot.grasp": "point"}, [0, 1, 2, 3, 4, 5]),
        (WHOLE, [0, 1, 2, 3, 4, 5]),
        (WHOLE | HANDLES, [0, 1, 2, 3, 4, 5]),
        (WHOLE | FLAT | {"human.hands": ["left"]}, [0, 1, 2, 3, 4, 5]),
        (WHOLE | {"limits.spine_compression": 3000.0}, [0, 1, 2, 3, 4, 5]),
    ],
    ids=[
        "two points",
        "a flat hand and a gripper",
        "a flat hand and a point",
        "two hands",
        "two handles",
        "a flat left hand",
        "a limited spine",
    ],
)
def test_equations_are_those_of_pinocchio_in_double_precision(keys, free):
    scenario = lo.load_scenario("table5_paper", keys)
    agents, lifted, task = agents_of(scenario), object_of(scenario), task_of(scenario)
    written, rng = instant(agents, lifted, task), np.random.default_rng(4)
    at = written.coordinates
    n = sum(len(agent.posture) for agent in agents)
    assert (at.n_q, at.n_joints, list(at.unlocked)) == (n + len(free), n, free)
    q, v, a = rng.uniform(-1.0, 1.0, (3, STATES, at.n_q))
    force = rng.uniform(-50.0, 50.0, (STATES, at.n_force))
    moment, moments = rng.uniform(-5.0, 5.0, (STATES, at.n_moment)), np.zeros((STATES, at.grasps, 3))
    moments[:, at.turning] = moment.reshape(STATES, -1, 3)
    pose, rate, second = np.zeros((3, STATES, 6))
    for six, part in ((pose, q), (rate, v), (second, a)):
        six[:, at.unlocked] = part[:, at.n_joints :]
    table = object_trajectory(lifted, pose, rate, second, force, moments)
    tau, first, grasp, held, feet = np.zeros((STATES, at.n_joints)), 0, 0, [], []
    forces, gaps = force.reshape(STATES, -1, 3), np.asarray(written.closure(q.T)).T.reshape(STATES, -1, 3)
    for i, agent in enumerate(agents):
        own, grasps = slice(first, first + at.joints[i]), slice(grasp, grasp + len(agent.grasps))
        body = agent_trajectory(agent, q[:, own], v[:, own], a[:, own], forces[:, grasps], moments[:, grasps])
        tau[:, own], first, grasp = body.tau[:, body.moving], own.stop, grasps.stop
        np.testing.assert_allclose(gaps[:, grasps], body.grasp_position - table.grasp_position[:, grasps], atol=1e-12)
        held += [_room(body, hand, attitude(pose[:, 3:])[0]) for hand in range(len(agent.grasps))]
        if agent.stance is not None:
            ground, units = ground_in_base(agent, body), (FOOT_FORCE_UNIT, FOOT_MOMENT_UNIT)
            feet += [rows.room(ground) / unit for rows, unit in zip(sole_rows(agent.stance), units, strict=True)]
        if agent.disc is not None:
            load = load_through(agent, body, agent.disc.upright, agent.disc.place)
            passed = np.stack([load.axial, load.lateral, load.extension], axis=1)
            feet.append((3000.0 - passed @ agent.disc.factors.T) / agent.disc.unit)
    y = np.hstack([q, v, a, force, moment, tau]).T
    np.testing.assert_allclose(np.asarray(written.dynamics(y)), 0.0, atol=1e-10)
    np.testing.assert_allclose(np.asarray(written.balance(y)).T, table.wrench, atol=1e-10)
    np.testing.assert_allclose(np.sort(np.asarray(written.hold(y)).T), np.sort(np.hstack([*held, *feet])), atol=1e-10)


def _room(body: AgentTrajectory, hand: int, turn: Array) -> Array:
    """Return what a hold leaves of its limits, by what the verification of a solution takes."""
    grasp, back, left = body.grasps[hand], turn.swapaxes(1, 2), [np.empty((len(turn), 0))]
    if grasp.moments:
        used = np.linalg.norm(body.grasp_moment[:, hand], axis=1) / grasp.max_moment
        angle = hand_turn(grasp, turn, body.grip_rotation[:, hand])
        left.append(np.stack([1 - used**2, np.cos(angle) - np.cos(grasp.max_turn)], axis=1))
    wrench = np.hstack([turned(back, body.grasp_force[:, hand]), turned(back, body.grasp_moment[:, hand])])
    units = {"friction": FORCE_UNIT, "pressure": MOMENT_UNIT}
    return np.hstack([*left, *(rows.room(wrench) / units[rows.name] for rows in flat_hand_rows(grasp))])


def test_defects_vanish_on_motions_of_third_order_and_no_higher(models):
    # Oracle: closed form. Acceleration linear in time is what the middles interpolate exactly; t^4 is beyond them.
    transcription = HermiteSimpson(*models, 4)
    t = np.linspace(0.0, transcription.task.duration, transcription.n_points)[None]

    def defects(order: int) -> list[float]:
        q, v, a = t**order, order * t ** (order - 1), order * (order - 1) * t ** (order - 2)
        return [float(np.abs(defect).max()) for defect in transcription.defects(q, v, a)]

    assert max(defects(3)) < 1e-12
    middle_q, end_q, _, end_v = defects(4)
    assert middle_q > 1e-3
    assert max(end_q, end_v) < 1e-12


def test_both_optima_agree_at_the_limit_to_a_thousandth(study):
    # The second transcription is the oracle; it is there on 32 intervals already.
    coarse, fine = study.rows
    assert study.approaching
    assert coarse.converged and fine.converged
    assert coarse.hermite_simpson == pytest.approx(study.limit, rel=1e-4)
    assert study.order == 2
    assert study.extrapolated == pytest.approx(study.limit, rel=1e-3)
    # Second order: of four parts of the difference one is left.
    assert fine.difference == pytest.approx(coarse.difference / 4, rel=0.1)


def test_ramps_of_acceleration_take_both_optima_to_the_same_limit_from_above(still):
    # Measured: 39 % and 17 % apart; the limit is that of the problem without its ramps over one interval.
    coarse, fine = still.rows
    assert still.approaching
    assert abs(fine.difference) < 0.2
    assert still.limit < fine.hermite_simpson < coarse.hermite_simpson
    assert fine.hermite_simpson < fine.spline < coarse.spline
    for row in still.rows:
        assert row.converged
    # The error is of first order in the step: what a halved step gains is what is left.
    assert still.order == 1
    assert 2 * fine.hermite_simpson - coarse.hermite_simpson == pytest.approx(still.limit, rel=0.01)
    assert still.extrapolated == pytest.approx(still.limit, rel=0.12)


def test_torques_of_the_second_transcription_are_pinocchios_at_its_points(models, solution):
    agents, lifted, task = models
    transcription = HermiteSimpson(agents, lifted, task, 6)
    found = transcription.solve(points_of(resample(solution, 3), transcription.at).every(5))
    assert found.converged
    assert found.violation < 1e-6
    arms = found.points
    first = transcription.at.joints[0]
    human = agent_trajectory(agents[0], arms.q[:, :first], arms.v[:, :first], arms.a[:, :first], arms.force[:, :3])
    np.testing.assert_allclose(human.tau[:, human.moving], arms.tau[:, :first], atol=1e-5)
    assert np.all(arms.v[[0, -1]] == 0.0)
    assert np.all(arms.a[[0, -1]] == 0.0)


@pytest.mark.parametrize("body", [(), ("human.body=whole",)], ids=["an arm", "a whole body"])
def test_integrand_of_a_natural_lift_adds_up_to_its_objective(
    solved: Callable[..., Any], body: tuple[str, ...]
) -> None:
    """By the trapezoid rule over the knots of the spline's own solution, torques and angles on both sides."""
    lift = solved("table5", *CHEAP, "objective.spine_weight=300", *body).solution
    agents, task = agents_of(lift.scenario), task_of(lift.scenario)
    written = instant(agents, object_of(lift.scenario), task)
    at = written.coordinates
    points = points_of(lift, at)
    tilts = written.tilt.map(len(lift.time))(points.q.T)
    values = np.asarray(ca.DM(integrand(agents, task, at, ca.DM(points.y.T), tilts))).ravel()
    assert np.trapezoid(values, lift.time) == pytest.approx(lift.objective, rel=1e-9)


def test_both_optima_of_a_natural_lift_agree_at_the_limit_to_a_thousandth(natural: Any) -> None:
    # Hands that transmit moments and turn on the object. Measured: 0.013 % apart.
    study = mesh_study(natural, (10, 20))
    assert study.approaching
    assert study.order == 2
    assert study.extrapolated == pytest.approx(study.limit, rel=1e-3)
    coarse, fine = study.rows
    assert coarse.hermite_simpson == pytest.approx(fine.hermite_simpson, rel=1e-4)
    assert fine.difference == pytest.approx(coarse.difference / 4, rel=0.2)


def test_verdict_needs_every_mesh_to_bring_the_optima_together():
    rows = [MeshRow(n, 1.0 + d, 1.0, 0.0, (0.0, 0.0), True) for n, d in ((10, 0.2), (20, 0.1), (40, 0.09))]
    assert MeshStudy(tuple(rows[:2]), 1.0, 2).approaching
    stuck = MeshStudy(tuple(rows), 1.0, 2)
    assert not stuck.approaching
    assert "NOT" in render(stuck)
