"""Planes that keep bodies apart: at each knot, points of one body stay on one side and points of another on the other.

With a unit normal n fixed in the world a row is ``n . (p_one - p_other) >= distance``. Points are fixed on bodies, so
it is a linear combination of the outputs of the pose kernels, with factors that differ from knot to knot: other planes
are other parameters, no other structure. Convex shapes whose points keep a row each are as far apart as the rows say.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from liftopt.collocation.arm_poses import ArmPoseTopology, arm_pose_functions
from liftopt.collocation.codegen.kernels import Builder, Kernel, load_kernels
from liftopt.collocation.dynamics import Topology
from liftopt.collocation.pose_kernels import (
    POSE_SIZE,
    PoseTopology,
    object_pose_functions,
    parameter_free,
    pose_functions,
)
from liftopt.collocation.standing_poses import StandingPoseTopology, standing_pose_functions
from liftopt.multibody.agent import Agent, LiftedObject
from liftopt.types import Array, Progress

WORLD = -1
# A row that asks for nothing: no factor at all, and so far below its value.
IDLE = -1.0


@dataclass(frozen=True, order=True)
class Body:
    """Something that moves as one.

    Attributes:
        part: number of the agent, the number of agents for the object, or ``WORLD``.
        joint: of the agent's reduced model that carries it; 1 of the object, 0 of the world.
    """

    part: int
    joint: int


@dataclass(frozen=True, eq=False)
class Separation:
    """Rows between two bodies, m at each of K knots; those with a normal of zero ask for nothing.

    Attributes:
        one, other: the bodies, at least one of which moves.
        normal: (K, m, 3) unit vectors in the world, towards ``one``.
        point_one, point_other: (K, m, 3) in the axes of the joint that carries the body [m].
        distance: (K, m) that the points keep at least along the normal [m].
        names: (K, m) of what is kept apart there, ``"human chest and table"``; empty where nothing is.
    """

    one: Body
    other: Body
    normal: Array
    point_one: Array
    point_other: Array
    distance: Array
    names: tuple[tuple[str, ...], ...]

    @property
    def rows(self) -> int:
        """Number of rows at a knot."""
        return int(self.distance.shape[1])

    @property
    def active(self) -> Array:
        """Which rows ask for something (K, m)."""
        return np.asarray(np.abs(self.normal).max(axis=2) > 0.0)

    @property
    def lower(self) -> Array:
        """Lower bounds (K, m) of what the moving bodies add to the rows [m]."""
        bound = np.where(self.active, self.distance, IDLE)
        for body, point, sign in self._sides:
            if body.part == WORLD:
                bound = bound - sign * np.einsum("kmi,kmi->km", self.normal, point)
        return bound

    @property
    def factors(self) -> list[tuple[Body, Array]]:
        """Each moving body with the factors (K, m, 12) of its pose's outputs."""
        found = []
        for body, point, sign in self._sides:
            if body.part != WORLD:
                turned = np.einsum("kma,kmb->kmba", self.normal, point).reshape(*point.shape[:2], -1)
                found.append((body, sign * np.concatenate([self.normal, turned], axis=2)))
        return found

    @property
    def _sides(self) -> tuple[tuple[Body, Array, float], ...]:
        return (self.one, self.point_one, 1.0), (self.other, self.point_other, -1.0)


@dataclass(frozen=True, eq=False)
class PosePart:
    """The poses of one agent's links, or of the object, as the NLP takes them.

    Attributes:
        part: number of the agent; the number of agents for the object.
        joints: whose poses its kernel returns, 12 outputs each.
        builder, topology: what the kernel is generated from.
        kernel: for one knot.
    """

    part: int
    joints: tuple[int, ...]
    builder: Builder
    topology: Topology
    kernel: Kernel

    def first_output(self, joint: int) -> int:
        """Return which output a joint's pose begins with."""
        return POSE_SIZE * self.joints.index(joint)


@dataclass(frozen=True, eq=False)
class SeparatingPlanes:
    """All rows that keep bodies apart, and the kernels that they need.

    Attributes:
        parts: whose poses are computed.
        separations: the rows, bodies in order.
    """

    parts: tuple[PosePart, ...]
    separations: tuple[Separation, ...]

    @cached_property
    def structure(self) -> tuple[object, ...]:
        """All but numbers: planes of equal structure are parameters of one solver."""
        kernels = tuple((part.part, part.joints, id(part.kernel)) for part in self.parts)
        return kernels, tuple((s.one, s.other, s.distance.shape) for s in self.separations)

    def output(self, body: Body) -> tuple[int, int]:
        """Return which of ``parts`` has the pose of a body, and its first output there."""
        at = next(i for i, part in enumerate(self.parts) if part.part == body.part)
        return at, self.parts[at].first_output(body.joint)


def pose_request(
    agents: Sequence[Agent], lifted: LiftedObject, part: int, joints: tuple[int, ...]
) -> tuple[Any, PoseTopology]:
    """Return what to generate the kernel of the poses of an agent or the object from: of these joints at least."""
    if part == len(agents):
        return object_pose_functions, parameter_free(lifted.model)
    agent, model = agents[part], agents[part].reduced()
    if agent.shares_kernels:
        return arm_pose_functions, ArmPoseTopology.of_links(model)
    if agent.stance is None:
        return pose_functions, PoseTopology.moving(model, joints)
    return standing_pose_functions, StandingPoseTopology.standing(model, joints, agent.T_world_base)


def pose_parts(
    agents: Sequence[Agent],
    lifted: LiftedObject,
    joints: Sequence[tuple[int, ...]],
    progress: Progress | None = None,
    like: Sequence[PosePart] = (),
) -> tuple[PosePart, ...]:
    """Return the parts whose poses are wanted; kernels are loaded or compiled.

    Args:
        agents: in the team's order.
        lifted: the object.
        joints: of each agent, and then of the object, whose poses are wanted; none leaves the part out.
        progress: called with a line of text when that takes long.
        like: parts whose kernels are used again if they fit.
    """
    wanted = [(part, own) for part, own in enumerate(joints) if own]
    requests = [pose_request(agents, lifted, part, own) for part, own in wanted]
    known = {part.topology.signature(): part.kernel for part in like}
    signatures = [topology.signature() for _, topology in requests]
    missing = [i for i, signature in enumerate(signatures) if signature not in known]
    loaded = load_kernels([requests[i] for i in missing], progress) if missing else []
    known |= {signatures[i]: kernel for i, kernel in zip(missing, loaded, strict=True)}
    return tuple(
        PosePart(part, request[1].joints, *request, known[signature])
        for (part, _), request, signature in zip(wanted, requests, signatures, strict=True)
    )
