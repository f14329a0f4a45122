"""Primitive shapes that links are drawn and collided with."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol
from xml.etree.ElementTree import Element

import numpy as np

from liftopt.types import Array

SHORTEST = 1e-9  # [m]: what is shorter has no direction


@dataclass(frozen=True)
class Colour:
    """A named material: ``rgba`` in [0, 1]."""

    name: str
    rgba: tuple[float, float, float, float]


class Shape(Protocol):
    """Something that can be moved to another frame and written as URDF geometries."""

    @property
    def name(self) -> str:
        """Name of the part, unique on its link."""

    @property
    def colour(self) -> Colour:
        """Its material."""

    def seen_from(self, transform: Array) -> Shape:
        """Return the same shape in frame A, given T_A_B (4, 4) of its present frame B."""

    def parts(self) -> list[tuple[str, Array, Element]]:
        """Return name, placement (4, 4) in the shape's frame and geometry of each URDF primitive it consists of."""


@dataclass(frozen=True)
class Capsule:
    """A cylinder from ``start`` (3,) to ``end`` (3,) with round ends [m]; URDF has none, so it is three primitives."""

    name: str
    colour: Colour
    start: Array
    end: Array
    radius: float

    def seen_from(self, transform: Array) -> Capsule:
        """Return the same capsule in frame A, given T_A_B (4, 4) of its present frame B."""
        return replace(self, start=_moved(transform, self.start), end=_moved(transform, self.end))

    def parts(self) -> list[tuple[str, Array, Element]]:
        """Return the cylinder and its two end spheres."""
        axis = self.end - self.start
        length = float(np.linalg.norm(axis))
        middle = _turned_to(axis, (self.start + self.end) / 2.0)
        return [
            (self.name, middle, _cylinder(self.radius, length)),
            (f"{self.name}_start", _at(self.start), _sphere(self.radius)),
            (f"{self.name}_end", _at(self.end), _sphere(self.radius)),
        ]


@dataclass(frozen=True)
class Box:
    """A box of ``size`` (3,) [m] along the axes of ``placement`` (4, 4), which is at its centre."""

    name: str
    colour: Colour
    placement: Array
    size: tuple[float, float, float]

    def seen_from(self, transform: Array) -> Box:
        """Return the same box in frame A, given T_A_B (4, 4) of its present frame B."""
        return replace(self, placement=transform @ self.placement)

    def parts(self) -> list[tuple[str, Array, Element]]:
        """Return the box."""
        return [(self.name, self.placement, Element("box", size=urdf_numbers(*np.round(self.size, 6))))]


@dataclass(frozen=True)
class Cylinder:
    """A flat-ended cylinder from ``start`` (3,) to ``end`` (3,) [m]."""

    name: str
    colour: Colour
    start: Array
    end: Array
    radius: float

    def seen_from(self, transform: Array) -> Cylinder:
        """Return the same cylinder in frame A, given T_A_B (4, 4) of its present frame B."""
        return replace(self, start=_moved(transform, self.start), end=_moved(transform, self.end))

    def parts(self) -> list[tuple[str, Array, Element]]:
        """Return the cylinder."""
        axis = self.end - self.start
        length = float(np.linalg.norm(axis))
        middle = _turned_to(axis, (self.start + self.end) / 2.0)
        return [(self.name, middle, _cylinder(self.radius, length))]


def box_at(name: str, colour: Colour, centre: Array, size: tuple[float, float, float]) -> Box:
    """Return a box along the axes of its frame, centred at ``centre`` (3,) [m]."""
    return Box(name, colour, _at(centre), size)


def urdf_numbers(*values: float) -> str:
    """Return numbers as a URDF has them, all their digits; no zero has a sign."""
    return " ".join(str(float(value) + 0.0) for value in values)


def _cylinder(radius: float, length: float) -> Element:
    return Element("cylinder", radius=urdf_numbers(_um(radius)), length=urdf_numbers(_um(length)))


def _sphere(radius: float) -> Element:
    return Element("sphere", radius=urdf_numbers(_um(radius)))


def _um(length: float) -> float:
    """Return a drawn length [m] to the micrometre."""
    return round(float(length), 6)


def _at(position: Array) -> Array:
    placement = np.eye(4)
    placement[:3, 3] = position
    return placement


def _moved(transform: Array, point: Array) -> Array:
    moved: Array = transform[:3, :3] @ point + transform[:3, 3]
    return moved


def _turned_to(axis: Array, position: Array) -> Array:
    """Return a placement at ``position`` whose z axis is along ``axis`` (3,), by the smallest turn."""
    length = float(np.linalg.norm(axis))
    x, y, z = axis / length if length > SHORTEST else (0.0, 0.0, 1.0)
    placement = _at(position)
    if z > -1.0 + 1e-9:
        k = 1.0 / (1.0 + z)
        placement[:3, :3] = [[1 - k * x * x, -k * x * y, x], [-k * x * y, 1 - k * y * y, y], [-x, -y, z]]
    else:
        placement[:3, :3] = np.diag([1.0, -1.0, -1.0])
    return placement
