"""How far a robot reaches towards what it cannot reach, in words."""

from __future__ import annotations

import numpy as np

from liftopt.collocation.problem import Problem
from liftopt.multibody.trajectory import agent_trajectory, object_trajectory
from liftopt.types import Array


def how_far_it_reaches(problem: Problem, coordinates: Array, which: int) -> str:
    """Return how far from a robot's first joint its grasp on the object is, and how far from it the robot reaches.

    Args:
        problem: the lift.
        coordinates: (n,) joints of every agent and the object's six where the grasps come nearest to their points.
        which: number of the grasp that stays short.

    Returns:
        A clause to follow what it explains; nothing of a grasp that is no robot's.
    """
    team, layout = problem.team, problem.layout
    owner = next(i for i, _ in enumerate(team.agents) if which in layout.grasps_of(i))
    agent = team.agents[owner]
    if agent.kind != "robot":
        return ""
    q, pose = coordinates[None, layout.columns(owner)], coordinates[None, layout.columns(len(team.agents))]
    own, none = which - layout.grasps_of(owner)[0], np.zeros((1, len(team.grasps), 3))
    held = agent_trajectory(agent, q, 0 * q, 0 * q, none[:, : len(agent.grasps)]).grasp_position[0, own]
    wanted = object_trajectory(team.object, pose, 0 * pose, 0 * pose, none).grasp_position[0, which]
    origin = agent.reduced().jointPlacements[1].translation
    away, reached = (float(np.linalg.norm(point - origin)) for point in (wanted, held))
    if away <= reached:  # too near, or on the other side
        return ""
    return f" ({away:.2f} m from its first joint, where it reaches {reached:.2f} m)"
