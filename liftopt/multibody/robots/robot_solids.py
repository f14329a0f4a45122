"""The solids of a robot: fitted to what its links collide with, or tubes along them where that is not at hand."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from liftopt.multibody.robots.carried_links import BASE
from liftopt.multibody.robots.chain import RobotChain
from liftopt.multibody.robots.fitted_solids import MOVING, STANDING
from liftopt.multibody.robots.link_surfaces import body_surfaces
from liftopt.multibody.robots.smallest_capsule import FittedCapsule
from liftopt.multibody.shapes import Box, Capsule, Colour, Shape
from liftopt.multibody.solids import END_SPHERES
from liftopt.multibody.urdf import plain_name
from liftopt.types import Array

GREY = Colour("robot_grey", (0.30, 0.31, 0.33, 1.0))
# Radius of the tubes along the links: a share of the reach, within what arms have [m].
RADIUS_SHARE, THINNEST, THICKEST = 0.05, 0.02, 0.06
LONGEST_NAME = 60


@dataclass(frozen=True)
class RobotSolids:
    """Solids by body.

    Attributes:
        shapes: by number of the chain's link, ``BASE`` for the base, in the frame of the body's own link.
        base: (n, 3) points of all that does not move, in the base's frame; at least one [m].
    """

    shapes: Mapping[int, tuple[Shape, ...]]
    base: Array


def robot_solids(chain: RobotChain) -> RobotSolids:
    """Return the solids of a robot, at most 3 on a link that moves and 10 on the base."""
    surfaces, carried = body_surfaces(chain)
    tubes = _tubes(chain)
    shapes: dict[int, tuple[Shape, ...]] = {}
    for body in (BASE, *range(len(chain.links))):
        if body not in surfaces:
            shapes[body] = tubes[body]
            continue
        found: list[Shape] = []
        names: dict[str, int] = {}
        for solid, owner in (STANDING if body == BASE else MOVING).solids(surfaces[body]):
            plain = _plain(carried[owner].link.name)
            names[plain] = names.get(plain, 0) + 1
            name = plain if names[plain] == 1 else f"{plain}_{names[plain]}"
            if isinstance(solid, FittedCapsule):
                found.append(Capsule(name, GREY, solid.start, solid.end, solid.radius))
            else:
                found.append(Box(name, GREY, solid.placement, tuple(solid.size.tolist())))
        shapes[body] = tuple(found)
    base = surfaces[BASE].points if BASE in surfaces else np.zeros((1, 3))
    return RobotSolids(shapes, base)


def _tubes(chain: RobotChain) -> dict[int, tuple[Shape, ...]]:
    """Return a tube from each body's origin to what it carries next: the next link, at last the grasp frame."""
    radius = float(np.clip(RADIUS_SHARE * chain.reach, THINNEST, THICKEST))
    ends = [*(link.placement for link in chain.links), chain.T_last_grasp]
    names = ["base", *(_plain(link.joint.child) for link in chain.links)]
    return {
        body: tuple(_tube(name, end[:3, 3], radius))
        for body, (name, end) in enumerate(zip(names, ends, strict=True), start=BASE)
    }


def _tube(name: str, end: Array, radius: float) -> Iterator[Shape]:
    """Give a capsule from a link's origin to what it carries, if that is apart."""
    if np.linalg.norm(end) > radius / 2.0:
        yield Capsule(name, GREY, np.zeros(3), end, radius)


def _plain(name: str) -> str:
    """Return a link's name as that of a shape, which does not end as the ends of a capsule do."""
    plain = plain_name(name)[:LONGEST_NAME]
    return f"{plain}_link" if plain.endswith(END_SPHERES) else plain
