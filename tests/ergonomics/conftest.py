"""A lift to measure, and the same lift with the person in another posture."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

from liftopt.ergonomics.posture import ArmPosture, Posture
from liftopt.multibody.trajectory import agent_trajectory
from liftopt.scenario.build import agents_of
from liftopt.solution.solution import Solution


@pytest.fixture(scope="session")
def solution(solved: Callable[..., Any]) -> Any:
    return solved("table5", "solver.intervals=10", "solver.starts=1").solution


@pytest.fixture
def posed(solution: Any) -> Callable[..., Solution]:
    """Return a function that gives the lift with the person still, joints by name in deg, and a force on the object."""

    def pose(force: tuple[float, float, float] = (0.0, 0.0, 10.0), **degrees: float) -> Solution:
        agent = agents_of(solution.scenario)[0]
        knots = len(solution.time)
        q = np.zeros((knots, len(agent.moving_joints)))
        for joint, angle in degrees.items():
            q[:, agent.moving_joints.index(f"human_{joint}")] = np.radians(angle)
        still = np.zeros_like(q)
        human = agent_trajectory(agent, q, still, still, np.tile(force, (knots, 1)))
        return replace(solution, agents=(human, solution.agents[1]))

    return pose


@pytest.fixture
def one_armed() -> Callable[..., Posture]:
    """Return a function that makes a posture with the right arm.

    It is upright, the elbow at 80 deg, thumb up, without load, but for what it is given.
    """

    def posture(**values: float) -> Posture:
        names = [field.name for field in (*fields(Posture), *fields(ArmPosture)) if field.name not in ("arms", "side")]
        given = dict.fromkeys(names, 0.0) | {"elbow_flexion": 80.0, "wrist_across": -0.2, "heavier_foot": 0.5} | values
        arrays = {name: np.array([value]) for name, value in given.items()}
        arm = {field.name: arrays.pop(field.name) for field in fields(ArmPosture) if field.name != "side"}
        return Posture(**arrays, arms=(ArmPosture("right", **arm),))

    return posture
