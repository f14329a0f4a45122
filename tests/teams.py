"""Lifts by other teams than one person and one robot: motions that hold the object, made without a solver."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
from scipy.interpolate import CubicSpline
from scipy.optimize import least_squares

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
WHOLE = {"kind": "person", "stature": 1.75, "mass": 75.0, "sex": "male", "body": "whole"}
BOX = {"name": "box", "mass": 8.0, "depth": 0.4, "width": 0.5, "height": 0.3}
SQUAT = {
    "schema": 2,
    "name": "squat",
    "duration": 2.0,
    "agents": {"human": WHOLE},
    "object": BOX,
    "task": {
        "standing_distance": 1.9,
        "start": {"height": 0.25, "human_distance": 0.3},
        "end": {"height": 0.9, "human_distance": 0.35},
    },
}
TWO_WHOLE = SQUAT | {
    "name": "two_whole",
    "agents": {
        "anna": {"kind": "person", "stature": 1.62, "mass": 58.0, "sex": "female", "body": "whole", "hands": ["right"]},
        "ben": WHOLE,
    },
    "object": BOX | {"depth": 0.6, "grasps": {"ben_right": "handle", "ben_left": "side"}},
    "task": {"standing_distance": 1.3, **TASK},
}


def _with_arm(model: str, x: float, z: float, direction: str = "z", **more: Any) -> dict[str, Any]:
    """Return the lift of a person and a robot whose model is in example-robot-data."""
    tool = {"length": 0.1, "mass": 0.5, "direction": direction}
    arm = {"kind": "robot", "model": model, "base": {"x": x, "z": z}, "tool": tool}
    return {
        "schema": 2,
        "name": model,
        "duration": 2.0,
        "agents": {"human": {"kind": "person", "stature": 1.75, "mass": 75.0, "sex": "male"}, "arm": arm | more},
        "object": {"name": "table", "mass": 2.0, "depth": 0.45, "width": 0.31, "height": 0.02},
        "task": {"standing_distance": x, **TASK},
        "objective": {"preset": "paper"},
    }


TEAMS: dict[str, dict[str, Any]] = {
    "two_people": TWO_PEOPLE,
    "two_robots": TWO_ROBOTS,
    "squat": SQUAT,
    "two_whole": TWO_WHOLE,
    "ur10": _with_arm("ur10", 1.6, 0.6),
    "panda": _with_arm("panda", 1.4, 0.6),
    "tiago_lifting": _with_arm("tiago_lifting", 1.5, 0.0, "x"),
    "tiago": _with_arm("tiago", 1.5, 0.0, "x", locked={"torso_lift_joint": 0.2}),
}
# How far those with legs bend their knees at the start and at the end of a lift from the floor [deg].
KNEES = (115.0, 15.0)


class Team(NamedTuple):
    """A lift and the models of who does it."""

    solution: Solution
    agents: tuple[Agent, ...]


def made(name: str, pattern: Solution) -> Team:
    """Return a lift straight up that every hand follows.

    Args:
        name: of the team: ``"two_people"``, ``"two_robots"`` (and a person), ``"squat"`` (a person with legs, alone),
            ``"two_whole"`` (two with legs, one of whom holds with one hand), ``"ur10"``, ``"panda"``, ``"tiago"`` or
            ``"tiago_lifting"`` (a person and that robot).
        pattern: whose solver's figures are borrowed.
    """
    scenario = scenario_from_dict(TEAMS[name])
    knots, agents, lifted = len(pattern.time), agents_of(scenario), object_of(scenario)
    time = np.linspace(0.0, scenario.duration, knots)
    share = time / time[-1]
    start, end = scenario.task.start, scenario.task.end
    box, grasps = scenario.object, [agent.name for agent in agents for _ in agent.grasps]
    height = start.height + (end.height - start.height) * share**2 * (3.0 - 2.0 * share)
    pose = np.zeros((knots, 6))
    pose[:, 0], pose[:, 2] = start.human_distance + box.depth / 2, height + box.height / 2
    x, xdot, xddot = _rates(time, pose)
    points = object_trajectory(lifted, x, xdot, xddot, np.zeros((knots, 3 * len(grasps)))).grasp_position
    lift = box.mass * (GRAVITY + xddot[:, 2]) / len(grasps)
    forces = np.zeros((knots, len(grasps), 3))
    forces[:, :, 2] = lift[:, None] + 4.0 * np.sin(np.pi * share)[:, None] * np.linspace(1.0, -1.0, len(grasps))
    forces[:, :, 0] = 12.0 * np.sin(np.pi * share)[:, None] * np.where(points[0, :, 0] < x[0, 0], 1.0, -1.0)
    tracks = []
    for agent in agents:
        own = [g for g, whose in enumerate(grasps) if whose == agent.name]
        follow = _followed if agent.stance is None else _squatted
        motion = _rates(time, follow(agent, points[:, own]))
        tracks.append(agent_trajectory(agent, *motion, forces[:, own]))
    names = [agent.name for agent in agents]
    terms = [*names, "acceleration", "force"]
    solution = replace(
        pattern,
        scenario=scenario,
        time=time,
        agents=tuple(tracks),
        object=object_trajectory(lifted, x, xdot, xddot, forces),
        urdfs={agent.name: agent.urdf for agent in agents} | {lifted.name: lifted.urdf},
        objective_terms=dict.fromkeys(terms, 100.0),
        objective_weights=dict.fromkeys(terms, 1.0),
    )
    return Team(assessed(solution), agents)


def _followed(agent: Agent, points: Array) -> Array:
    """Return joint angles (K, n) that bring the hand to ``points`` (K, 1, 3), each from the one before."""
    model = agent.reduced()
    data, frame, q, rows = model.createData(), model.getFrameId(agent.hands[0]), np.array(agent.posture), []
    for point in points[:, 0]:
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


def _squatted(agent: Agent, points: Array) -> Array:
    """Return joint angles (K, n) of one with legs whose hands hold at ``points`` (K, grasps, 3).

    The knees are bent as much as the hands are low, the hands nearly as they hold a level object.
    """
    model, low = agent.reduced(), points[:, :, 2].mean(axis=1)
    data, joints = model.createData(), [name.removeprefix(f"{agent.name}_") for name in agent.moving_joints]
    frames = [model.getFrameId(grasp.frame) for grasp in agent.grasps]
    bend = {"knee": 1.0, "ankle": 0.25, "hip": 0.6}
    weight = np.array([{"knee": 1.0, "ankle": 0.3, "Q1": 0.5, "Q3": 0.5}.get(joint, 0.05) for joint in joints])
    far = (low - low.min()) / max(np.ptp(low), 0.5)

    def off(q: Array, wanted: Array, held: Array) -> Array:
        pin.framesForwardKinematics(model, data, q)
        found = [weight * (q - wanted), [5.0 * (pin.centerOfMass(model, data, q) - ahead) @ agent.T_world_base[:3, 0]]]
        for frame, point, grasp in zip(frames, held, agent.grasps, strict=True):
            at = data.oMf[frame]
            found += [30.0 * (at.translation - point), 0.5 * pin.log3(at.rotation @ grasp.R_hand_object)]
        return np.concatenate(found)

    rows, ahead = [], agent.T_world_base[:3, 3] + 0.06 * agent.T_world_base[:3, 0]
    limits = agent.limits
    for share, held in zip(far, points, strict=True):
        knee = np.radians(KNEES[0] + share * (KNEES[1] - KNEES[0]))
        wanted = np.array([bend.get(joint, 0.0) * knee for joint in joints])
        wanted += np.where([joint in bend for joint in joints], 0.0, agent.posture)
        first = np.clip(wanted, limits.q_lower + 1e-3, limits.q_upper - 1e-3)
        found = least_squares(off, first, bounds=(limits.q_lower, limits.q_upper), args=(wanted, held))
        rows.append(found.x)
        pin.framesForwardKinematics(model, data, found.x)
        for frame, point in zip(frames, held, strict=True):
            assert np.linalg.norm(data.oMf[frame].translation - point) < 0.02, agent.name
    return np.array(rows)


def _rates(time: Array, values: Array) -> tuple[Array, Array, Array]:
    """Return values (K, n) at rest at both ends with their first and second rates."""
    curve = CubicSpline(time, values, bc_type="clamped")
    return np.asarray(curve(time)), np.asarray(curve(time, 1)), np.asarray(curve(time, 2))
