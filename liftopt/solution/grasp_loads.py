"""Who bears what through the grasps: parts of the load, and forces that only work against each other."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from liftopt.multibody.trajectory import AgentTrajectory, cross
from liftopt.types import Array

FREE_FALL = 1e-3  # N; below this the vertical load is too small to be shared out


def shares(agents: Sequence[AgentTrajectory]) -> Array:
    """Return each agent's part (agents, K) of the vertical grasp force; NaN where there is no load to share."""
    vertical = np.stack([agent.load[:, 2] for agent in agents])
    load = vertical.sum(axis=0)
    part: Array = np.full_like(vertical, np.nan)
    np.divide(vertical, load, out=part, where=np.abs(load) > FREE_FALL)
    return part


def squeeze(agents: Sequence[AgentTrajectory], name: str | None = None) -> Array:
    """Return the part (K,) of the grasp forces that cancels [N]; positive presses the object together.

    Between two grasps it lies along the line that joins them. With more it is the internal part of the forces, which
    adds no force and no moment to the object (Kerr & Roth, 1986, Int J Robotics Research 4(4):3-17); a hand's is
    positive towards the middle of the grasps.

    Args:
        agents: all that hold the object, with two grasps or more.
        name: whose; None takes the largest at every time, as with the name of one who holds with several hands. With
            two grasps both have the same.
    """
    force, points = (
        np.concatenate([getattr(agent, what).swapaxes(0, 1) for agent in agents])
        for what in ("grasp_force", "grasp_position")
    )
    if len(points) == 2:
        line = points[1] - points[0]
        line = line / np.linalg.norm(line, axis=1, keepdims=True)
        return np.asarray(0.5 * np.einsum("ki,ki->k", force[0] - force[1], line))
    inner = internal_forces(agents)
    inward = np.einsum("aki,aki->ak", inner, points.mean(axis=0) - points)
    size = np.copysign(np.linalg.norm(inner, axis=2), inward)
    holders = [agent.name for agent in agents for _ in agent.grasps]
    size = size[[name in (None, holder) for holder in holders]]
    return np.asarray(size[np.argmax(np.abs(size), axis=0), np.arange(size.shape[1])])


def internal_forces(agents: Sequence[AgentTrajectory]) -> Array:
    """Return the part (grasps, K, 3) of the grasp forces that moves nothing: no force and no moment on the object."""
    force = np.concatenate([agent.grasp_force for agent in agents], axis=1)
    point = np.concatenate([agent.grasp_position for agent in agents], axis=1)
    grasp_map = np.zeros((len(force), 6, 3 * force.shape[1]))
    for i in range(force.shape[1]):
        lever = point[:, i] - point.mean(axis=1)
        grasp_map[:, :3, 3 * i : 3 * i + 3] = np.eye(3)
        grasp_map[:, 3:, 3 * i : 3 * i + 3] = cross(lever[:, None, :], np.eye(3)).swapaxes(1, 2)
    load = force.reshape(len(force), -1, 1)
    inner = load - np.linalg.pinv(grasp_map) @ (grasp_map @ load)
    return np.asarray(inner.reshape(force.shape).swapaxes(0, 1))
