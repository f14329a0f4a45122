"""Passing paths: where the object runs into what stands around, the same motion with it led past on each side.

Where it runs into who holds it, a person's thighs or belly, it is led away from them, ahead of the feet.

The shift is as large as the overlap asks for on that side, whole while they overlap, and ebbs away to both ends. The
agents follow by inverse kinematics. What comes of it is far from optimal but passes.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from liftopt.collocation.layout import OBJECT_SIZE
from liftopt.collocation.problem import Problem
from liftopt.collocation.separating_planes import WORLD
from liftopt.collocation.solvers.deadline import Deadline
from liftopt.collocation.transfer import nearest_controls
from liftopt.search.holder_sides import is_of_an_arm
from liftopt.search.inverse_kinematics import FOLLOWING_ITERATIONS, InverseKinematics
from liftopt.search.moves import quintic
from liftopt.search.plane_choice import NEAR
from liftopt.search.solid_distances import SolidDistances, gaps, solid_distances
from liftopt.search.team_solids import TeamSolids
from liftopt.types import Array

# Room that a passing object leaves [m]; shifts that are larger than this are not tried, nor more than so many sides.
ROOM, FARTHEST, SIDES = 0.04, 0.9, 4
# Up, and to all four sides of what stands around.
TO_SIDES = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])


def passing_paths(
    problem: Problem, kinematics: InverseKinematics, solids: TeamSolids, x: Array, deadline: Deadline
) -> list[Array]:
    """Return motions (n_x,) past what the object runs into, the smallest shift first; none if it does not.

    Args:
        problem: the lift.
        kinematics: of its team.
        solids: of its team and of what stands around.
        x: the motion (n_x,).
        deadline: past which inverse kinematics stops.
    """
    here = problem.mesh.basis[0] @ problem.unpack(x)[0]
    shifts = _shifts(problem, solids, here)
    if not shifts:
        return []
    way = np.tile(here[:, None], (1, len(shifts), 1))
    for n, shift in enumerate(shifts):
        way[:, n, -OBJECT_SIZE : -OBJECT_SIZE + 3] += shift
    lower, upper = problem.task.pose_lower, problem.task.pose_upper
    way[:, :, -OBJECT_SIZE:] = np.clip(way[:, :, -OBJECT_SIZE:], lower, upper)
    last = np.tile(here[0], (len(shifts), 1))
    for there in way:
        pose = there[:, -OBJECT_SIZE:].copy()
        seeds = np.hstack([last[:, :-OBJECT_SIZE], pose])
        last = kinematics.reach(pose, seeds, deadline, most=FOLLOWING_ITERATIONS).coordinates
        there[:] = last
    found = np.tile(x, (len(shifts), 1))
    found[:, problem.layout.control] = nearest_controls(problem, way)
    return list(found)


def _shifts(problem: Problem, solids: TeamSolids, here: Array) -> list[Array]:
    """Return shifts (K, 3) of the object's path [m], the smallest first."""
    sides = [*_past_what_stands(problem, solids, here), *_away_from_holders(problem, solids, here)]
    sides.sort(key=lambda side: side[0])
    return [shift for depth, shift in sides if depth < FARTHEST][:SIDES]


def _past_what_stands(problem: Problem, solids: TeamSolids, here: Array) -> Iterator[tuple[float, Array]]:
    """Give depths and shifts to each side of what stands around."""
    own = len(solids.team.agents)
    pairs = [
        p
        for p, (one, other) in enumerate(solids.ends)
        if solids.bodies[one].part == own and solids.bodies[other].part == WORLD and not solids.flat[other]
    ]
    found = solid_distances(solids, problem, here, NEAR, np.array(pairs, dtype=np.int64))
    for p in pairs:
        inside = _inside(found.distance[:, p])
        if not inside.any():
            continue
        share = _while_inside(problem, inside)
        standing = solids.solids[solids.ends[p, 1]].T_joint_solid[:3, :3]
        for direction in TO_SIDES @ standing.T:
            depth = float(_depths(solids, found, p, direction)[inside].max())
            yield depth, share[:, None] * depth * direction


def _away_from_holders(problem: Problem, solids: TeamSolids, here: Array) -> Iterator[tuple[float, Array]]:
    """Give depths and shifts away from who stands on soles and holds the object."""
    own = len(solids.team.agents)
    for part, agent in enumerate(solids.team.agents):
        if agent.stance is None:
            continue
        pairs = [
            p
            for p, (one, other) in enumerate(solids.ends)
            if solids.bodies[one].part == part
            and solids.bodies[other].part == own
            and not is_of_an_arm(solids.team, solids.bodies[one])
        ]
        found = solid_distances(solids, problem, here, NEAR, np.array(pairs, dtype=np.int64))
        inside = {p: _inside(found.distance[:, p]) for p in pairs}
        ahead = agent.T_world_base[:3, 0]
        depths = [float(_depths(solids, found, p, -ahead)[at].max()) for p, at in inside.items() if at.any()]
        if depths:
            share = _while_inside(problem, np.any(list(inside.values()), axis=0))
            yield max(depths), share[:, None] * max(depths) * ahead


def _inside(distance: Array) -> npt.NDArray[np.bool_]:
    """Return at which knots (K,), but for the ends, solids are nearer than they should pass."""
    near = distance < ROOM / 2
    near[[0, -1]] = False
    return near


def _while_inside(problem: Problem, inside: npt.NDArray[np.bool_]) -> Array:
    """Return how much (K,) of a shift there is at each knot: all of it while it is inside."""
    phase, at = problem.mesh.phase, np.flatnonzero(inside)
    first, last = phase[at[0]], phase[at[-1]]
    rising, falling = np.minimum(phase / first, 1.0), np.minimum((1.0 - phase) / (1.0 - last), 1.0)
    return np.asarray(quintic(np.minimum(rising, falling)))


def _depths(solids: TeamSolids, found: SolidDistances, p: int, direction: Array) -> Array:
    """Return how far (K,) the first solid of a pair has to move along a direction, or the second against it [m]."""
    along = np.tile(direction, (len(found.distance), 1, 1))
    return np.asarray(ROOM - gaps(solids, found.points, along, np.array([p]))[:, 0])
