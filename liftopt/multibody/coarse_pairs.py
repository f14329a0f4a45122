"""Pairs of solids of one robot that overlap in most of its postures: their shapes are too coarse to keep them apart.

The robot itself fits together, so that such an overlap is that of the shapes around its links; mostly they are next but
one to each other in a wrist or a shoulder.
"""

from __future__ import annotations

from collections.abc import Sequence

import coal
import numpy as np

from liftopt.multibody.agent import Agent
from liftopt.multibody.poses import joint_placements
from liftopt.multibody.solids import Solid
from liftopt.types import Array

POSTURES = 32
MOST = 0.5  # of the postures: two solids that overlap in more are not kept apart


def coarse_pairs(agent: Agent, pairs: Sequence[tuple[Solid, Solid]]) -> set[tuple[int, int]]:
    """Return, by the ``id`` of both solids, those pairs of an agent that overlap in most of its postures."""
    solids = list({id(solid): solid for pair in pairs for solid in pair}.values())
    if not solids:
        return set()
    number = {id(solid): i for i, solid in enumerate(solids)}
    joints = sorted({solid.joint for solid in solids})
    placed = joint_placements(agent.reduced(), spread_postures(agent), joints)
    places = np.stack([placed[:, joints.index(solid.joint)] @ solid.T_joint_solid for solid in solids], axis=1)
    around = np.array([np.linalg.norm(solid.size) / 2.0 + solid.radius for solid in solids])
    shapes = [coal.Box(*solid.size) if solid.kind == "box" else coal.Capsule(*solid.size) for solid in solids]
    request, result, found = coal.DistanceRequest(), coal.DistanceResult(), set()
    for one, other in pairs:
        i, j = number[id(one)], number[id(other)]
        near = np.flatnonzero(
            np.linalg.norm(places[:, i, :3, 3] - places[:, j, :3, 3], axis=1) < around[i] + around[j]
        )
        overlaps = 0
        for k in near if len(near) > MOST * POSTURES else ():
            first, second = (coal.Transform3s(places[k, n, :3, :3], places[k, n, :3, 3]) for n in (i, j))
            overlaps += coal.distance(shapes[i], first, shapes[j], second, request, result) < 0.0
            result.clear()
        if overlaps > MOST * POSTURES:
            found.add((id(one), id(other)))
    return found


def spread_postures(agent: Agent) -> Array:
    """Return postures (K, n) all over the ranges of an agent's joints, the same each time.

    Each joint goes through its range by a step of its own, a power of the root of x^(n+1) = x + 1 (M. Roberts, 2018, The
    unreasonable effectiveness of quasirandom sequences).
    """
    low, high = agent.limits.q_lower, agent.limits.q_upper
    count = len(low)
    root = 2.0
    for _ in range(60):
        root = (1.0 + root) ** (1.0 / (count + 1.0))
    steps = root ** -np.arange(1.0, count + 1.0)
    shares = np.mod(0.5 + np.outer(np.arange(1, POSTURES + 1), steps), 1.0)
    return np.asarray(low + shares * (high - low))
