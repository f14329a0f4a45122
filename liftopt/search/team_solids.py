"""The solids of a team and of what stands around it, on the bodies of its problem."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.separating_planes import WORLD, Body, PosePart, pose_parts
from liftopt.multibody.poses import joint_placements, object_placements
from liftopt.multibody.solid_pairs import SolidPair, solid_pairs
from liftopt.multibody.solids import Solid
from liftopt.search.holder_sides import HolderSide, holder_sides
from liftopt.types import Array, Progress

CORNERS = 8  # points of the largest hull; smaller ones repeat theirs


@dataclass(frozen=True, eq=False)
class TeamSolids:
    """The solids of a team and of what stands around, on the bodies of its problem.

    Attributes:
        team: whose.
        obstacles: what stands around.
        pairs: what must keep apart.
        progress: called when kernels must be compiled.
        known: parts whose kernels are used again if they fit.
    """

    team: Team
    obstacles: tuple[Solid, ...]
    pairs: tuple[SolidPair, ...]
    progress: Progress | None = None
    known: tuple[PosePart, ...] = ()

    @staticmethod
    def of(
        team: Team, obstacles: Sequence[Solid], progress: Progress | None = None, like: TeamSolids | None = None
    ) -> TeamSolids:
        """Return the solids of a team and of what stands around; kernels of ``like`` are used again if they fit."""
        known = vars(like).get("parts", like.known) if like else ()
        return TeamSolids(
            team, tuple(obstacles), solid_pairs(team.agents, team.object, obstacles), progress, tuple(known)
        )

    @cached_property
    def parts(self) -> tuple[PosePart, ...]:
        """The poses that planes between any of the solids take; kernels are loaded or compiled."""
        return pose_parts(self.team.agents, self.team.object, self.joints, self.progress, self.known)

    @cached_property
    def solids(self) -> tuple[Solid, ...]:
        """Every solid of a pair, once."""
        return tuple({id(solid): solid for pair in self.pairs for solid in (pair.one, pair.other)}.values())

    @cached_property
    def bodies(self) -> tuple[Body, ...]:
        """The body that carries each solid."""
        return tuple(self._body(solid) for solid in self.solids)

    @cached_property
    def ends(self) -> npt.NDArray[np.int64]:
        """(P, 2) numbers of the solids of each pair."""
        number = {id(solid): i for i, solid in enumerate(self.solids)}
        return np.array([[number[id(p.one)], number[id(p.other)]] for p in self.pairs], dtype=np.int64).reshape(-1, 2)

    @cached_property
    def sides(self) -> dict[int, HolderSide]:
        """On which side of the object parts of its holders belong, by number of the pair, see ``holder_sides``."""
        return holder_sides(self.team, self.solids, self.bodies, self.ends)

    @cached_property
    def points(self) -> Array:
        """(S, 8, 3) corners of each hull in the axes of the joint that carries it [m]."""
        return np.array([solid.points[np.arange(CORNERS) % len(solid.points)] for solid in self.solids])

    @cached_property
    def radius(self) -> Array:
        """(S,) by how much each is thicker than its hull [m]."""
        return np.array([solid.radius for solid in self.solids])

    @cached_property
    def flat(self) -> Array:
        """(S,) whether it is a half-space."""
        return np.array([solid.kind == "half-space" for solid in self.solids])

    @cached_property
    def joints(self) -> tuple[tuple[int, ...], ...]:
        """Joints of each agent, and then of the object, that carry a solid."""
        return tuple(
            tuple(sorted({body.joint for body in self.bodies if body.part == part and body.joint}))
            for part in range(len(self.team.agents) + 1)
        )

    def _body(self, solid: Solid) -> Body:
        owners = [*(agent.name for agent in self.team.agents), self.team.object.name]
        if solid.owner not in owners or solid.joint == 0:
            return Body(WORLD, 0)
        return Body(owners.index(solid.owner), solid.joint)

    @cached_property
    def _models(self) -> list[pin.Model]:
        return [agent.reduced() for agent in self.team.agents]

    def placements(self, problem: Problem, coordinates: Array) -> Array:
        """Return T_world_joint (K, S, 4, 4) of the body of each solid at coordinates (K, n)."""
        found, layout = np.tile(np.eye(4), (len(coordinates), len(self.solids), 1, 1)), problem.layout
        places: dict[Body, Array] = {}
        for i, model in enumerate(self._models):
            own = joint_placements(model, coordinates[:, layout.columns(i)], self.joints[i])
            places |= {Body(i, joint): own[:, n] for n, joint in enumerate(self.joints[i])}
        lifted = object_placements(coordinates[:, layout.columns(layout.n_agents)])
        places |= {Body(layout.n_agents, joint): lifted for joint in self.joints[layout.n_agents]}
        for s, body in enumerate(self.bodies):
            if body in places:
                found[:, s] = places[body]
        return found

    @cached_property
    def spheres(self) -> tuple[Array, Array]:
        """Centre (S, 3) in the axes of its joint and radius (S,) of a sphere around each solid [m]."""
        centre = self.points.mean(axis=1)
        radius = np.linalg.norm(self.points - centre[:, None], axis=2).max(axis=1) + self.radius
        return centre, np.where(self.flat, np.inf, radius)

    @cached_property
    def geometries(self) -> list[Any]:
        """Coal's shape of each solid."""
        from liftopt.multibody.coal_shape import coal_shape

        return [coal_shape(solid) for solid in self.solids]
