"""A robot as its URDF describes it: links, joints and the tree that they make, in its own names and frames."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pinocchio as pin

from liftopt.errors import InputError
from liftopt.files.suggestions import did_you_mean, nearest
from liftopt.multibody.dh import BodyInertia
from liftopt.multibody.robots.robot_shape import MeshFile, RobotShape
from liftopt.types import Array

ONE_AXIS = ("revolute", "continuous", "prismatic")
LARGEST_NUMBER = 1e6  # in SI units: no robot has a larger one, and readers of results take none
KINDS = (*ONE_AXIS, "fixed", "floating", "planar")
MOST_NAMES = 16  # that a message lists


@dataclass(frozen=True)
class RobotLink:
    """One link.

    Attributes:
        name: its own name.
        body: mass properties in the link's frame, zero where the link has none; what is missing of them is NaN.
        visuals: what it is drawn with.
        collisions: what it collides with.
    """

    name: str
    body: BodyInertia
    visuals: tuple[RobotShape, ...] = ()
    collisions: tuple[RobotShape, ...] = ()

    @property
    def meshes(self) -> tuple[MeshFile, ...]:
        """The meshes that it is drawn with."""
        return tuple(shape.mesh for shape in self.visuals if shape.mesh is not None)


@dataclass(frozen=True)
class Mimic:
    """A joint that follows another: its position is ``multiplier`` times that one's, plus ``offset``."""

    joint: str
    multiplier: float
    offset: float


@dataclass(frozen=True)
class RobotJoint:
    """One joint; what its URDF does not say is None. Units: rad or m, rad/s or m/s, Nm or N.

    Attributes:
        name: its own name.
        kind: as in URDF, one of ``KINDS``.
        parent, child: names of links.
        placement: (4, 4) T_parent_child where the joint is at zero.
        axis: (3,) unit vector in the child's frame.
        lower, upper: ends of its range.
        velocity, effort: largest, in both directions.
        soft_lower, soft_upper: ends of the range of its safety controller.
        mimic: which joint it follows.
    """

    name: str
    kind: str
    parent: str
    child: str
    placement: Array
    axis: Array
    lower: float | None = None
    upper: float | None = None
    velocity: float | None = None
    effort: float | None = None
    soft_lower: float | None = None
    soft_upper: float | None = None
    mimic: Mimic | None = None

    def moved(self, position: float) -> Array:
        """Return (4, 4) how far it moves its child to a position from zero; joints of several ways stay there."""
        moved = np.eye(4)
        if self.kind == "prismatic":
            moved[:3, 3] = self.axis * position
        elif self.kind in ONE_AXIS and position != 0.0:
            moved[:3, :3] = pin.exp3(self.axis * position)
        return moved


@dataclass(frozen=True)
class RobotDescription:
    """A robot from outside, as it was read; nothing is judged yet.

    Attributes:
        name: in its URDF.
        source: its file, or what stands for it in messages.
        links, joints: in the order of the file.
    """

    name: str
    source: str
    links: tuple[RobotLink, ...]
    joints: tuple[RobotJoint, ...]

    @cached_property
    def _links(self) -> dict[str, RobotLink]:
        return {link.name: link for link in self.links}

    @cached_property
    def _above(self) -> dict[str, RobotJoint]:
        return {joint.child: joint for joint in self.joints}

    @cached_property
    def _below(self) -> dict[str, list[RobotJoint]]:
        below: dict[str, list[RobotJoint]] = {}
        for joint in self.joints:
            below.setdefault(joint.parent, []).append(joint)
        return below

    @property
    def roots(self) -> tuple[str, ...]:
        """Names of the links that no joint carries."""
        return tuple(link.name for link in self.links if link.name not in self._above)

    @property
    def leaves(self) -> tuple[str, ...]:
        """Names of the links that carry none."""
        return tuple(link.name for link in self.links if link.name not in self._below)

    @property
    def mass(self) -> float:
        """Of all links together [kg]."""
        return sum(link.body.mass for link in self.links)

    def link(self, name: str, entry: str = "") -> RobotLink:
        """Return a link.

        Raises:
            InputError: there is none of that name; ``entry`` is what names it.
        """
        if name not in self._links:
            raise self._missing(name, entry, "link", list(self._links))
        return self._links[name]

    def joint(self, name: str, entry: str = "") -> RobotJoint:
        """Return a joint.

        Raises:
            InputError: there is none of that name; ``entry`` is what names it.
        """
        joints = {joint.name: joint for joint in self.joints}
        if name not in joints:
            raise self._missing(name, entry, "joint", [one.name for one in self.joints if one.kind in ONE_AXIS])
        return joints[name]

    def _missing(self, name: str, entry: str, what: str, names: list[str]) -> InputError:
        shown = ", ".join(names[:MOST_NAMES]) + (", ..." if len(names) > MOST_NAMES else "")
        meant = did_you_mean(nearest(name, names, 3)) or f"; it has {shown}"
        key = f"{self.source}: {entry}" if entry else self.source
        return InputError(key, name, f"it has no {what} of this name{meant}")

    def below(self, link: str) -> tuple[RobotJoint, ...]:
        """Return the joints that a link carries."""
        return tuple(self._below.get(link, ()))

    def above(self, link: str) -> Iterator[RobotJoint]:
        """Give the joints from a link up to its root, the nearest first."""
        while link in self._above:
            joint = self._above[link]
            yield joint
            link = joint.parent

    def joints_between(self, base: str, link: str) -> tuple[RobotJoint, ...] | None:
        """Return the joints from ``base`` down to ``link``, or None where the one does not carry the other."""
        path: list[RobotJoint] = []
        if base == link:
            return ()
        for joint in self.above(link):
            path.append(joint)
            if joint.parent == base:
                return tuple(reversed(path))
        return None
