"""How one who stands is borne by the floor over a motion."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from liftopt.multibody.agent import Agent
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.types import Array


def rooted(model: pin.Model, T_world_base: Array) -> pin.Model:
    """Return a tree on a free-flyer at its base: what RNEA says of the root is what the ground must do.

    It is force and moment about the base's origin, in its axes. Joints keep their order after the root; no frames.
    """
    base = pin.SE3(T_world_base)
    tree = pin.Model()
    tree.gravity = model.gravity
    root = tree.addJoint(0, pin.JointModelFreeFlyer(), base, "floating_base")
    for j in range(1, model.njoints):
        parent, placement = model.parents[j], model.jointPlacements[j]
        placement = placement if parent else base.inverse() * placement
        tree.addJoint(parent + root, model.joints[j], placement, model.names[j])
        tree.appendBodyToJoint(j + root, model.inertias[j], pin.SE3.Identity())
    return tree


def ground_in_base(agent: Agent, trajectory: AgentTrajectory) -> Array:
    """Return force and moment (K, 6) of the ground about the feet's origin, in the axes of the agent's base [N, Nm]."""
    rotation = agent.T_world_base[:3, :3]
    return np.hstack([trajectory.ground_force @ rotation, trajectory.ground_moment @ rotation])


def pressure_in_base(agent: Agent, trajectory: AgentTrajectory) -> Array:
    """Return the centre of pressure (K, 2), X and Y from the feet's origin in the axes of the agent's base [m].

    NaN where the ground would have to pull.
    """
    pressure = trajectory.centre_of_pressure
    if pressure is None:
        raise ValueError(f"{agent.name} does not stand on soles")
    T_world_base = agent.T_world_base
    return np.asarray((pressure - T_world_base[:3, 3]) @ T_world_base[:3, :3])[:, :2]


def support_margin(agent: Agent, trajectory: AgentTrajectory) -> Array:
    """Return how far the centre of pressure (K,) is within the rectangle around the soles [m]; negative outside."""
    if agent.stance is None:
        raise ValueError(f"{agent.name} does not stand on soles")
    (x, y), (back, ahead, aside) = pressure_in_base(agent, trajectory).T, agent.stance.support
    inside = np.min([x - back, ahead - x, aside - np.abs(y)], axis=0)
    return np.where(np.isnan(inside), -np.inf, inside)
