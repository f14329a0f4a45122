"""Passing paths: where the object runs into what stands around, the same motion with it led past on each side.

The shift is as large as the overlap asks for on that side, whole while they overlap, and ebbs away to both ends. The
agents follow by inverse kinematics. What comes of it is far from optimal but passes.
"""

from __future__ import annotations

import numpy as np

from liftopt.collocation.layout import OBJECT_SIZE
from liftopt.collocation.problem import Problem
from liftopt.collocation.separating_planes import WORLD
from liftopt.collocation.solvers.deadline import Deadline
from liftopt.collocation.transfer import nearest_controls
from liftopt.search.inverse_kinematics import FOLLOWING_ITERATIONS, InverseKinematics
from liftopt.search.moves import quintic
from liftopt.search.plane_choice import NEAR
from liftopt.search.solid_distances import gaps, solid_distances
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
    own = len(solids.team.agents)
    pairs = [
        p
        for p, (one, other) in enumerate(solids.ends)
        if solids.bodies[one].part == own and solids.bodies[other].part == WORLD and not solids.flat[other]
    ]
    among = np.array(pairs, dtype=np.int64)
    found = solid_distances(solids, problem, here, NEAR, among)
    sides: list[tuple[float, Array]] = []
    phase = problem.mesh.phase
    for p in pairs:
        inside = np.flatnonzero(found.distance[:, p] < ROOM / 2)
        inside = inside[(inside > 0) & (inside < len(phase) - 1)]
        if not len(inside):
            continue
        first, last = phase[inside[0]], phase[inside[-1]]
        rising, falling = np.minimum(phase / first, 1.0), np.minimum((1.0 - phase) / (1.0 - last), 1.0)
        share = quintic(np.minimum(rising, falling))[:, None]
        standing = solids.solids[solids.ends[p, 1]].T_joint_solid[:3, :3]
        for direction in TO_SIDES @ standing.T:
            along = np.tile(direction, (len(here), 1, 1))
            depth = float(ROOM - gaps(solids, found.points, along, np.array([p]))[inside, 0].min())
            sides.append((depth, share * depth * direction))
    sides.sort(key=lambda side: side[0])
    return [shift for depth, shift in sides if depth < FARTHEST][:SIDES]
