"""Joints that turn further than once, held to one turn.

Whole turns of a joint are one and the same to whoever looks at the robot, but not to its cables, and not to a solver:
where little depends on how the wrist is turned, a plan that is solved again may lie a turn away from the one before.
"""

from __future__ import annotations

from dataclasses import replace
from math import pi

from liftopt.multibody.robots.chain import ChainLink, RobotChain
from liftopt.types import Array

A_TURN = 2.0 * pi + 1e-6  # [rad]; a range of just one turn is none too many


def turns_further(chain: RobotChain) -> bool:
    """Whether a joint of a chain turns further than once."""
    return any(map(_is_wide, chain.links))


def within_one_turn(chain: RobotChain, posture: Array) -> RobotChain:
    """Return a chain whose joints turn by half a turn at most either way of a posture (n,), as far as they can."""
    links = [
        _held(link, float(middle)) if _is_wide(link) else link
        for link, middle in zip(chain.links, posture, strict=True)
    ]
    return replace(chain, links=tuple(links))


def _is_wide(link: ChainLink) -> bool:
    ends = link.range
    return link.joint.kind != "prismatic" and ends.upper - ends.lower > A_TURN


def _held(link: ChainLink, middle: float) -> ChainLink:
    ends = link.range
    lower, upper = max(ends.lower, middle - pi), min(ends.upper, middle + pi)
    kind = "revolute"  # one that turns without end has its range by its kind
    joint = replace(link.joint, kind=kind, lower=lower, upper=upper, soft_lower=None, soft_upper=None)
    return replace(link, joint=joint)
