"""Pairs of solids of one robot that overlap in most of its postures: their shapes are too coarse to keep them apart.

The robot itself fits together, so that such an overlap is that of the shapes around its links; mostly they are next but
one to each other in a wrist or a shoulder.
"""

from __future__ import annotations

from collections.abc import Sequence

import coal
import numpy as np

from liftopt.multibody.agent import Agent
from liftopt.multibody.coal_shape import coal_shape
from liftopt.multibody.poses import joint_placements
from liftopt.multibody.robots.evenly_spread import evenly_spread
from liftopt.multibody.solids import Solid

POSTURES = 32
MOST = 0.5  # of the postures: two solids that overlap in more are not kept apart


def coarse_pairs(agent: Agent, pairs: Sequence[tuple[Solid, Solid]]) -> set[tuple[int, int]]:
    """Return, by the ``id`` of both solids, those pairs of an agent that overlap in most of its postures."""
    solids = list({id(solid): solid for pair in pairs for solid in pair}.values())
    if not solids:
        return set()
    number = {id(solid): i for i, solid in enumerate(solids)}
    joints = sorted({solid.joint for solid in solids})
    low, high = agent.limits.q_lower, agent.limits.q_upper
    postures = low + evenly_spread(POSTURES, len(low)) * (high - low)
    placed = joint_placements(agent.reduced(), postures, joints)
    places = np.stack([placed[:, joints.index(solid.joint)] @ solid.T_joint_solid for solid in solids], axis=1)
    around = np.array([np.linalg.norm(solid.size) / 2.0 + solid.radius for solid in solids])
    shapes = [coal_shape(solid) for solid in solids]
    request, result, found = coal.DistanceRequest(), coal.DistanceResult(), set()
    for one, other in pairs:
        i, j = number[id(one)], number[id(other)]
        near = np.flatnonzero(np.linalg.norm(places[:, i, :3, 3] - places[:, j, :3, 3], axis=1) < around[i] + around[j])
        overlaps = 0
        for k in near if len(near) > MOST * POSTURES else ():
            first, second = (coal.Transform3s(places[k, n, :3, :3], places[k, n, :3, 3]) for n in (i, j))
            overlaps += coal.distance(shapes[i], first, shapes[j], second, request, result) < 0.0
            result.clear()
        if overlaps > MOST * POSTURES:
            found.add((id(one), id(other)))
    return found
