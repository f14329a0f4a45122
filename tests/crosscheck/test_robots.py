"""Robots from outside under the crosschecks. Oracles: MuJoCo, the change of energy, sums by NumPy."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
import pytest

from liftopt.collocation.motion import motion_at, objective_terms, objective_weights
from liftopt.collocation.problem import Problem, Team
from liftopt.crosscheck.energy import energy_books
from liftopt.crosscheck.instant import Coordinates
from liftopt.crosscheck.integrand import integrand
from liftopt.crosscheck.motion_report import motion_report, render
from liftopt.crosscheck.mujoco_dynamics import inverse_dynamics
from liftopt.crosscheck.mujoco_forward import Deviation, Followed, Windows
from liftopt.crosscheck.transcriptions import points_of
from liftopt.multibody.joint_units import LEVER
from liftopt.scenario.build import agents_of, motions_of, object_of, task_of

WEIGHTS = {"shoulder": 3.0, "roll": 0.0}


@pytest.fixture
def mujoco() -> Any:
    return pytest.importorskip("mujoco", minversion="3.7", reason="mujoco is in the extra 'crosscheck'")


@pytest.mark.usefixtures("mujoco")
def test_a_lift_with_a_robot_from_outside_passes_every_check(ur10: Any) -> None:
    checks = motion_report(ur10.solution)
    assert all(check.passed for check in checks), render(checks)


@pytest.mark.usefixtures("mujoco")
def test_forces_of_a_joint_that_slides_are_mujocos(on_a_column: Any) -> None:
    _, robot, box = inverse_dynamics(on_a_column.solution)
    assert robot.labels[0] == "robot_column"
    assert np.abs(robot.ours[:, 0]).max() > 100.0
    assert robot.relative < 1e-6 and robot.gap < 1e-9
    assert box.relative < 1e-6
    assert all(book.relative < 1e-6 for book in energy_books(on_a_column.solution, 8))


@pytest.mark.usefixtures("mujoco")
def test_units_of_the_report_are_the_joints(on_a_column: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    off = Deviation(0.001, 0.0, 0.0)
    names = tuple(name for agent in on_a_column.solution.agents for name in agent.moving_joints)
    share = np.where([name == "robot_column" for name in names], 0.05, 0.01)
    place = "liftopt.crosscheck.mujoco_forward.Simulation"
    monkeypatch.setattr(f"{place}.windows", lambda *_, **__: Windows(off, 0.0, 40))
    monkeypatch.setattr(f"{place}.follow", lambda _: Followed(off, names, 100.0 * share, share, 0.0))
    found = {check.name: check for check in motion_report(on_a_column.solution)}
    assert found["MuJoCo open loop, joints"].unit == "rad or m"
    told = found["MuJoCo with feedback, torque added"].where
    assert told == "robot_column, 5.000 N; at most 1.000 Nm in any joint, 5.000 N in any joint that slides"


@pytest.mark.parametrize("preset", ["paper", "natural"])
def test_weights_of_joints_are_in_both_transcriptions(on_a_column: Any, preset: str) -> None:
    """A sliding joint counts 1 N as LEVER Nm in preset paper, and as a share of its limit in natural."""
    given = {"objective.preset": preset, "robot.joint_weights": WEIGHTS, "robot.grasp": "point", "human.grasp": "point"}
    scenario = on_a_column.solution.scenario.replace(given)
    agents, lifted = agents_of(scenario, on_a_column.solution.urdfs), object_of(scenario, on_a_column.solution.urdfs)
    task, spline = task_of(scenario), motions_of(scenario, 6)
    problem = Problem(Team.of(agents, lifted), task, spline.mesh())
    rng = np.random.default_rng(4)
    x = np.clip(rng.normal(0.0, 0.2, problem.layout.n_x), *problem.bounds())
    motion = motion_at(problem, spline, x, spline.phase)
    terms, weights = objective_terms(problem, motion), objective_weights(problem)
    robot = motion.agents[1]
    names = [name.removeprefix("robot_") for name in robot.moving_joints]
    sliding = LEVER**2 if preset == "paper" else 1.0
    factors = np.array([WEIGHTS.get(name, 1.0) * (sliding if name == "column" else 1.0) for name in names])
    unit = np.ones(7) if preset == "paper" else robot.limits.tau_upper
    effort = np.trapezoid((factors * (robot.tau / unit) ** 2).sum(axis=1), motion.time)
    assert terms["robot"] == pytest.approx(effort, rel=1e-12)
    at = Coordinates.of(agents, task)
    points = points_of(motion, at)
    columns = np.hstack([points.q, points.v, points.a, points.force, points.moment, points.tau]).T
    costs = np.array(integrand(agents, task, at, ca.DM(columns), ca.DM(0, len(motion.time)))).ravel()
    total = sum(weights[name] * value for name, value in terms.items())
    assert np.trapezoid(costs, motion.time) == pytest.approx(total, rel=1e-9)
    bare = replace(agents[1], joint_weights=None)
    without = np.array(integrand((agents[0], bare), task, at, ca.DM(columns), ca.DM(0, len(motion.time)))).ravel()
    assert np.trapezoid(without, motion.time) != pytest.approx(total, rel=1e-6)
