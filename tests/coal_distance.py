"""Distances of solids by coal, for tests."""

from __future__ import annotations

import coal
import numpy as np
import pinocchio as pin

from liftopt.multibody.agent import Agent
from liftopt.multibody.solid_pairs import SolidPair
from liftopt.multibody.solids import Solid
from liftopt.types import Array


def coal_shape(solid: Solid) -> coal.ShapeBase:
    """Return coal's shape of a solid."""
    if solid.kind == "half-space":
        return coal.Halfspace(np.array([0.0, 0.0, 1.0]), 0.0)
    return coal.Box(*solid.size) if solid.kind == "box" else coal.Capsule(*solid.size)


def distance(one: Solid, T_world_one: Array, other: Solid, T_world_other: Array) -> float:
    """Return the signed distance of two solids [m], given where their joints are (4, 4)."""
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    request.enable_signed_distance = True
    places = [T_world_one @ one.T_joint_solid, T_world_other @ other.T_joint_solid]
    placed = [coal.Transform3s(place[:3, :3], place[:3, 3]) for place in places]
    return float(coal.distance(coal_shape(one), placed[0], coal_shape(other), placed[1], request, result))


def joint_placements(agent: Agent, q: Array) -> list[Array]:
    """Return T_world_joint (4, 4) of every joint of an agent's reduced model."""
    model = agent.reduced()
    data = model.createData()
    pin.forwardKinematics(model, data, q)
    return [placement.homogeneous for placement in data.oMi]


def own_distances(agent: Agent, pairs: tuple[SolidPair, ...], q: Array) -> dict[str, float]:
    """Return the distances of the pairs within an agent at ``q``, by the pair in words."""
    at = joint_placements(agent, q)
    own = [pair for pair in pairs if pair.one.owner == pair.other.owner == agent.name]
    return {pair.told: distance(pair.one, at[pair.one.joint], pair.other, at[pair.other.joint]) for pair in own}
