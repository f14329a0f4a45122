"""Where all links of a robot are on the bodies that move it: what does not move is one body with what carries it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from liftopt.multibody.robots.chain import RobotChain
from liftopt.multibody.robots.description import RobotLink
from liftopt.types import Array


@dataclass(frozen=True)
class CarriedLink:
    """A link on a body.

    Attributes:
        link: it.
        body: number of the chain's link that carries it, from 0 on; ``BASE`` for the base.
        placement: (4, 4) T_body_link, in the frame of the body's own link.
    """

    link: RobotLink
    body: int
    placement: Array = field(repr=False)


BASE = -1


def carried_links(chain: RobotChain) -> Iterator[CarriedLink]:
    """Give all links that a chain's base carries, itself too, with joints that are held where the chain holds them."""
    starts = [(BASE, chain.base, chain.base_links)]
    starts += [(body, link.joint.child, link.links) for body, link in enumerate(chain.links)]
    for body, start, names in starts:
        for name in names:
            yield CarriedLink(chain.description.link(name), body, _placement(chain, start, name))


def _placement(chain: RobotChain, start: str, name: str) -> Array:
    """Return T_start_name (4, 4) along joints that are held."""
    placement = np.eye(4)
    for joint in chain.description.joints_between(start, name) or ():
        placement = placement @ joint.placement @ joint.moved(chain.held.get(joint.name, 0.0))
    return placement
