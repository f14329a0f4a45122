"""Lifts by other teams than one person and one robot: motions that hold the object, made without a solver."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
from scipy.interpolate import CubicSpline

from liftopt.assessment.assess import assessed
from liftopt.multibody.agent import Agent
from liftopt.multibody.trajectory import agent_trajectory, object_trajectory
from liftopt.scenario.build import agents_of, object_of
from liftopt.scenario.model import scenario_from_dict
from liftopt.solution.solution import Solution
from liftopt.types import Array

GRAVITY = 9.81
TASK = {"start": {"height": 0.8, "human_distance": 0.4}, "end": {"height": 1.15, "human_distance": 0.4}}
TWO_PEOPLE = {
    "schema": 2,
    "name": "two_people",
    "duration": 2.0,
    "agents": {
        "anna": {"kind": "person", "stature": 1.62, "mass": 58.0, "sex": "female"},
        "ben": {"kind": "person", "stature": 1.82, "mass": 84.0, "sex": "male"},
    },
    "object": {"name": "box", "mass": 8.0, "depth": 0.5, "width": 0.4, "height": 0.25},
    "task": {"standing_distance": 1.3, **TASK},
    "objective": {"preset": "paper"},
}
TWO_ROBOTS = {
    "schema": 2,
    "name": "two_robots",
    "duration": 2.0,
    "agents": {
        "human": {"kind": "person", "stature": 1.75, "mass": 75.0, "sex": "male"},
        "near": {"kind": "robot", "model": "sawyer", "base": {"x": 1.75, "y": -0.55}},
        "far": {"kind": "robot", "model": "sawyer", "base": {"x": 1.75, "y": 0.55}},
    },
    "object": {
        "name": "plank",
        "mass": 6.0,
        "depth": 0.4,
        "width": 1.0,
        "height": 0.04,
        "grasps": {"near": [0.2, -0.4, -0.02], "far": [0.2, 0.4, -0.02]},
    },
    "task": {"standing_distance": 1.75, **TASK},
    "objective": {"preset": "paper"},
}


TEAMS: dict[str, dict[str, Any]] = {"two_people": TWO_PEOPLE, "two_robots": TWO_ROBOTS}


class Team(NamedTuple):
    """A lift and the models of who does it."""

    solution: Solution
    agents: tuple[Agent, ...]


def made(name: str, pattern: Solution) -> Team:
    """Return a lift straight up that every hand follows.

    Args:
        name: of the team, ``"two_people"`` or ``"two_robots"`` (and a person).
        pattern: whose solver's figures are borrowed.
    """
    scenario = scenario_from_dict(TEAMS[name])
    knots, agents, lifted = len(pattern.time), agents_of(scenario), object_of(scenario)
    time = np.linspace(0.0, scenario.duration, knots)
    share = time / time[-1]
    start, end = scenario.task.start, scenario.task.end
    box = scenario.object
    height = start.height + (end.height - start.height) * share**2 * (3.0 - 2.0 * share)
    pose = np.zeros((knots, 6))
    pose[:, 0], pose[:, 2] = start.human_distance + box.depth / 2, height + box.height / 2
    x, xdot, xddot = _rates(time, pose)
    points = object_trajectory(lifted, x, xdot, xddot, np.zeros((knots, 3 * len(agents)))).grasp_position
    lift = box.mass * (GRAVITY + xddot[:, 2]) / len(agents)
    forces = np.zeros((knots, len(agents), 3))
    forces[:, :, 2] = lift[:, None] + 4.0 * np.sin(np.pi * share)[:, None] * np.linspace(1.0, -1.0, len(agents))
    forces[:, :, 0] = 12.0 * np.sin(np.pi * share)[:, None] * np.where(points[0, :, 0] < x[0, 0], 1.0, -1.0)
    tracks = []
    for i, agent in enumerate(agents):
        motion = _rates(time, _followed(agent, points[:, i]))
        tracks.append(agent_trajectory(agent, *motion, forces[:, i]))
    names = [agent.name for agent in agents]
    terms = [*names, "acceleration", "force"]
    solution = replace(
        pattern,
        scenario=scenario,
        time=time,
        agents=tuple(tracks),
        object=object_trajectory(lifted, x, xdot, xddot, forces.reshape(knots, -1)),
        urdfs={agent.name: agent.urdf for agent in agents} | {lifted.name: lifted.urdf},
        objective_terms=dict.fromkeys(terms, 100.0),
        objective_weights=dict.fromkeys(terms, 1.0),
    )
    return Team(assessed(solution), agents)


def _followed(agent: Agent, points: Array) -> Array:
    """Return joint angles (K, n) that bring the hand to ``points`` (K, 3), each from the one before."""
    model = agent.reduced()
    data, frame, q, rows = model.createData(), model.getFrameId(agent.hands[0]), np.array(agent.posture), []
    for point in points:
        for _ in range(200):
            pin.computeJointJacobians(model, data, q)
            pin.updateFramePlacements(model, data)
            gap = point - data.oMf[frame].translation
            jacobian = pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)[:3]
            step = jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + 1e-4 * np.eye(3), gap)
            q = np.clip(q + 0.5 * step, agent.limits.q_lower, agent.limits.q_upper)
        assert np.linalg.norm(gap) < 1e-3, (agent.name, gap)
        rows.append(q)
    return np.array(rows)


def _rates(time: Array, values: Array) -> tuple[Array, Array, Array]:
    """Return values (K, n) at rest at both ends with their first and second rates."""
    curve = CubicSpline(time, values, bc_type="clamped")
    return np.asarray(curve(time)), np.asarray(curve(time, 1)), np.asarray(curve(time, 2))
