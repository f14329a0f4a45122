"""A lift to measure, and the same lift with the person in another posture."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

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
