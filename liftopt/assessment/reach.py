"""How much of its reach a robot uses: how far its grasp point is from its first joint, and how far it could be."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pinocchio as pin

from liftopt.assessment.who import Who
from liftopt.multibody.agent import Agent
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.scenario.build import agent_of
from liftopt.solution.finding import CAUTION, INFO, ROBOT, Finding, percent
from liftopt.solution.solution import Solution
from liftopt.types import Array

# Of the reach, from which it is a caution; chosen for this model. Of an arm of two equal links the elbow is then
# within 23 deg of straight: little is left to be moved along it, and joints turn fast for little.
STRETCHED = 0.98
STEP, FINEST = 0.02, 1e-3  # [m] by which the point is moved outwards, and to which its end is found
CLOSED = 1e-4  # [m] of the point
ITERATIONS, DAMPING = 60, 1e-3
SOURCE = "the point is moved outwards along that line, within the ranges of the joints, the wrist free to turn"


def reach_findings(fine: Solution, robot: AgentTrajectory, who: Who) -> Iterator[Finding]:
    """Give how near a robot comes to the end of its reach, where its grasp point is farthest from its first joint."""
    agent = agent_of(fine.scenario, robot.name, fine.urdfs)
    origin = np.array(agent.reduced().jointPlacements[1].translation)
    away = robot.grasp_position[:, 0] - origin
    distance = np.linalg.norm(away, axis=1)
    k = int(np.argmax(distance))
    used, farther = float(distance[k]), room_outwards(agent, robot.q[k, robot.moving], away[k] / distance[k])
    share = used / (used + farther)
    yield Finding(
        f"{ROBOT}.reach",
        CAUTION if share >= STRETCHED else INFO,
        f"at {percent(share)} % of its reach",
        f"The gripper of the {who.told} is {used:.2f} m from its first joint at {fine.time[k]:.2f} s, "
        f"{percent(share)} % of the {used + farther:.2f} m that it reaches along that line.",
        robot.name, None, float(fine.time[k]), used, used + farther, "m", SOURCE,
    )  # fmt: skip


def room_outwards(agent: Agent, q: Array, direction: Array) -> float:
    """Return how far an agent's grasp point can be moved along a direction, from one posture to the next [m].

    Args:
        agent: with one grasp.
        q: (n,) posture to start from.
        direction: (3,) unit vector, world axes.
    """
    model = agent.reduced()
    data, frame = model.createData(), model.getFrameId(agent.grasps[0].frame)
    pin.framesForwardKinematics(model, data, q)
    start = np.array(data.oMf[frame].translation)
    reached, step, q = 0.0, STEP, np.array(q)
    while step >= FINEST:
        moved = _moved(agent, model, data, frame, q, start + (reached + step) * direction)
        if moved is None:
            step /= 2.0
        else:
            reached, q = reached + step, moved
    return reached


def _moved(agent: Agent, model: pin.Model, data: pin.Data, frame: int, q: Array, point: Array) -> Array | None:
    """Return the posture near ``q`` whose grasp point is at ``point``, or None if none is found."""
    for _ in range(ITERATIONS):
        pin.computeJointJacobians(model, data, q)
        pin.updateFramePlacement(model, data, frame)
        gap = point - data.oMf[frame].translation
        if np.linalg.norm(gap) <= CLOSED:
            return q
        slopes = pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)[:3]
        step = slopes.T @ np.linalg.solve(slopes @ slopes.T + DAMPING**2 * np.eye(3), gap)
        q = np.clip(q + step, agent.limits.q_lower, agent.limits.q_upper)
    return None
