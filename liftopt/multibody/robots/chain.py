"""The part of a robot that lifts: the joints from its base to its grasp frame, and what each of them carries.

All else stays where it is: joints beside the chain, fingers for instance, are held, and their links count with the
link of the chain that carries them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite

import numpy as np

from liftopt.errors import NO_VALUE, InputError
from liftopt.multibody.dh import BodyInertia
from liftopt.multibody.robots.description import ONE_AXIS, RobotDescription, RobotJoint
from liftopt.multibody.robots.joint_ranges import JointRange, range_of
from liftopt.types import Array

OTHERS = ("floating", "planar")  # joints of more than one axis
SAME_PLACE = 1e-6  # rad or m


@dataclass(frozen=True)
class ChainLink:
    """A joint of the chain that moves, and all that it moves up to the next one.

    Attributes:
        joint: that moves it.
        placement: (4, 4) T_parent_link where the joint is at zero; the parent is the one before, first the base.
        body: mass properties of all together, in the frame of the joint's child.
        links: names of those that are one body with it.
    """

    joint: RobotJoint
    placement: Array
    body: BodyInertia
    links: tuple[str, ...]

    @property
    def range(self) -> JointRange:
        """Between which ends the joint moves."""
        return range_of(self.joint)


@dataclass(frozen=True)
class RobotChain:
    """A robot from its base to its grasp frame.

    Attributes:
        description: that it is of.
        base, grasp_frame: names of links.
        base_body: mass properties of all that does not move, in the base's frame.
        base_links: names of those links.
        links: what moves, from the base on.
        T_last_grasp: (4, 4) the grasp frame in the frame of the last link.
        held: position of every joint that could move and is held [rad, m].
    """

    description: RobotDescription
    base: str
    grasp_frame: str
    base_body: BodyInertia
    base_links: tuple[str, ...]
    links: tuple[ChainLink, ...]
    T_last_grasp: Array
    held: Mapping[str, float]

    @property
    def joints(self) -> tuple[RobotJoint, ...]:
        """Those that move."""
        return tuple(link.joint for link in self.links)

    @property
    def ranges(self) -> tuple[JointRange, ...]:
        """Between which ends they move."""
        return tuple(link.range for link in self.links)

    @property
    def lengths(self) -> Array:
        """(n,) distance from each joint that moves to the next, from the last to the grasp frame [m]."""
        ends = [*(link.placement for link in self.links[1:]), self.T_last_grasp]
        return np.array([np.linalg.norm(end[:3, 3]) for end in ends])

    @property
    def reach(self) -> float:
        """Length of all links of the chain, one after the other, and of the ways of its prismatic joints [m]."""
        ways = [r.upper - r.lower for r in self.ranges if r.joint.kind == "prismatic" and r.upper > r.lower]
        return float(np.sum(self.lengths) + np.sum(ways))

    @property
    def moving_mass(self) -> float:
        """Of all that moves [kg]."""
        return float(sum(link.body.mass for link in self.links))


def robot_chain(
    description: RobotDescription,
    grasp_frame: str,
    *,
    base: str | None = None,
    locked: Mapping[str, float] | None = None,
) -> RobotChain:
    """Return the chain of a robot.

    Args:
        description: of the robot.
        grasp_frame: name of the link that it holds with.
        base: name of the link that is bolted down, by default the root; what carries it is left out.
        locked: positions of joints that are held, on the chain or beside it [rad, m]; beside it the others stay at
            zero, or at the end of their range that is nearest to zero.

    Raises:
        InputError: there is no such link or joint, the base does not carry the grasp frame, or a joint of the chain
            is of a kind that cannot move here.
    """
    given, source = dict(locked or {}), description.source
    for name, value in given.items():
        joint = description.joint(name, "locked")
        if not isfinite(value) or joint.kind not in ONE_AXIS:
            raise InputError(f"{source}: locked {name}", value, "must be a number, of a revolute or prismatic joint")
        ends = range_of(joint)
        bounded = ends.source != "endless" and ends.lower < ends.upper
        if bounded and not ends.lower - SAME_PLACE <= value <= ends.upper + SAME_PLACE:
            raise InputError(
                f"{source}: locked {name}",
                value,
                f"must be from {ends.lower:g} to {ends.upper:g}, where the joint can be",
            )
    base = base_of(description, base)
    path = description.joints_between(base, description.link(grasp_frame, "grasp_frame").name)
    if path is None:
        raise InputError(f"{source}: grasp_frame", grasp_frame, f"the base {base!r} does not carry this link")
    moving = [joint for joint in path if _moves(joint, given, description)]
    if not moving:
        raise InputError(f"{source}: grasp_frame", grasp_frame, f"no joint moves between it and the base {base!r}")
    with np.errstate(all="ignore"):  # masses that are no numbers are found later
        return _assembled(description, base, grasp_frame, moving, given)


def _assembled(
    description: RobotDescription, base: str, grasp_frame: str, moving: list[RobotJoint], given: Mapping[str, float]
) -> RobotChain:
    held: dict[str, float] = {}
    below = {joint.child for joint in moving}
    base_body, base_links = _lumped(description, base, below, given, held)
    links, start, before = [], base, np.eye(4)
    for joint in moving:
        placement = before @ _still(description, start, joint.parent, given, held) @ joint.placement
        body, names = _lumped(description, joint.child, below, given, held)
        links.append(ChainLink(joint, placement, body, names))
        start, before = joint.child, np.eye(4)
    last = _still(description, start, grasp_frame, given, held)
    return RobotChain(description, base, grasp_frame, base_body, base_links, tuple(links), last, held)


def base_of(description: RobotDescription, base: str | None) -> str:
    """Return the link that is bolted down: the one that is named, or the root.

    Raises:
        InputError: there is no such link, or there are several roots and none is named.
    """
    if base is not None:
        return description.link(base, "base_link").name
    if len(description.roots) != 1:
        roots = ", ".join(description.roots)
        likely = max(description.roots, key=lambda root: _carried(description, root))
        raise InputError(
            description.source,
            NO_VALUE,
            f"has several roots ({roots}); say which is bolted down: base = {likely!r} carries the most joints",
        )
    return description.roots[0]


def _carried(description: RobotDescription, link: str) -> int:
    """Return how many joints that can move a link carries, near and far."""
    return sum((joint.kind in ONE_AXIS) + _carried(description, joint.child) for joint in description.below(link))


def _moves(joint: RobotJoint, given: Mapping[str, float], description: RobotDescription) -> bool:
    """Return whether a joint between base and grasp frame moves by itself."""
    place = f"{description.source}: joint {joint.name}"
    if joint.kind in OTHERS:
        raise InputError(
            place,
            joint.kind,
            f"such a base does not stay where it is; say base = {joint.child!r} to bolt that link down",
        )
    if joint.kind == "fixed" or joint.name in given:
        return False
    if joint.mimic is None:
        return True
    followed = joint.mimic.joint
    if followed in given:
        return False
    raise InputError(
        place, f"mimic of {followed}", "joints of the chain move by themselves; lock it, or the one that it follows"
    )


def _position(joint: RobotJoint, given: Mapping[str, float], description: RobotDescription) -> float:
    """Return where a joint is held that could move."""
    if joint.name in given:
        return float(given[joint.name])
    if joint.mimic is not None:
        followed = description.joint(joint.mimic.joint)
        at = 0.0 if followed.mimic is not None else _position(followed, given, description)
        return joint.mimic.multiplier * at + joint.mimic.offset
    ends = range_of(joint)
    return float(np.clip(0.0, ends.lower, ends.upper)) if ends.lower <= ends.upper else 0.0


def _at(joint: RobotJoint, given: Mapping[str, float], description: RobotDescription, held: dict[str, float]) -> Array:
    """Return T_parent_child (4, 4) of a joint that does not move, and note where it is held."""
    position = _position(joint, given, description) if joint.kind in ONE_AXIS else 0.0
    if joint.kind in (*ONE_AXIS, *OTHERS):
        held[joint.name] = position
    return np.asarray(joint.placement @ joint.moved(position))


def _still(
    description: RobotDescription, start: str, end: str, given: Mapping[str, float], held: dict[str, float]
) -> Array:
    """Return T_start_end (4, 4) along joints that do not move."""
    placement = np.eye(4)
    for joint in description.joints_between(start, end) or ():
        placement = placement @ _at(joint, given, description, held)
    return placement


def _lumped(
    description: RobotDescription, link: str, stops: set[str], given: Mapping[str, float], held: dict[str, float]
) -> tuple[BodyInertia, tuple[str, ...]]:
    """Return a link and all that it carries and does not move, in its frame; ``stops`` are not entered."""
    body, names, ahead = BodyInertia.zero(), [], [(link, np.eye(4))]
    while ahead:
        name, placement = ahead.pop()
        own = description.link(name).body
        if own.mass != 0.0:  # moments of inertia without a mass are none
            body += own.transformed(placement[:3, :3], placement[:3, 3])
        names.append(name)
        for joint in description.below(name):
            if joint.child not in stops:
                ahead.append((joint.child, placement @ _at(joint, given, description, held)))
    return body, tuple(names)
