"""The solids that must not overlap: collision shapes of an exported URDF on the joints of its model, and obstacles.

A solid is the hull of a few points, made thicker all around by a radius: two points for a capsule, eight for a box.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import product
from typing import Literal
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np
import pinocchio as pin

from liftopt.errors import ModelError
from liftopt.multibody.agent import Agent, LiftedObject
from liftopt.multibody.dh import rotation_z, translation
from liftopt.types import Array

SolidKind = Literal["capsule", "box", "half-space"]
COLLISION = "_collision"  # ends the name of a collision shape
END_SPHERES = ("_start", "_end")  # end the names of the spheres of a capsule, which URDF has not


@dataclass(frozen=True, eq=False)
class Solid:
    """A capsule, a box or the half-space below the floor, fixed to one joint of a model.

    Attributes:
        owner: name of the agent, the object or the obstacle.
        name: of the part, ``"right forearm"``; empty where the owner has no parts.
        joint: index in the owner's reduced model (``Agent.reduced``; of the object in its own), 0 for the world.
        T_joint_solid: (4, 4) placement on that joint. A capsule's axis is its z axis, its origin in the middle; a box's
            origin is its centre, its axes are along its edges; a half-space lies below its origin along z.
        kind: what it is.
        size: capsule: radius, distance between the centres of its round ends; box: its edges x, y, z [m]; half-space:
            nothing.
    """

    owner: str
    name: str
    joint: int
    T_joint_solid: Array = field(repr=False)
    kind: SolidKind
    size: tuple[float, ...]

    @property
    def told(self) -> str:
        """The solid in words: ``"right forearm of human"``, ``"table"``."""
        return f"{self.name} of {self.owner}" if self.name else self.owner

    @property
    def radius(self) -> float:
        """By how much the hull of ``points`` is thicker all around [m]; 0 for a box."""
        return self.size[0] if self.kind == "capsule" else 0.0

    @property
    def points(self) -> Array:
        """(n, 3) corners of the hull in the joint's frame [m]: 2 of a capsule, 8 of a box, 1 of a half-space."""
        if self.kind == "box":
            own = np.array(list(product(*((-edge / 2.0, edge / 2.0) for edge in self.size))))
        elif self.kind == "capsule":
            own = np.array([[0.0, 0.0, -self.size[1] / 2.0], [0.0, 0.0, self.size[1] / 2.0]])
        else:
            own = np.zeros((1, 3))
        return np.asarray(own @ self.T_joint_solid[:3, :3].T + self.T_joint_solid[:3, 3])


FLOOR = Solid("floor", "", 0, np.eye(4), "half-space", ())


def solids_of(agent: Agent) -> tuple[Solid, ...]:
    """Return the solids of an agent on the joints of its reduced model, in the order of its URDF.

    Raises:
        ModelError: a collision shape is no box, cylinder or sphere.
    """
    return _solids(agent.name, agent.urdf, agent.reduced())


def solids_of_object(lifted: LiftedObject) -> tuple[Solid, ...]:
    """Return the solids of the object; errors as ``solids_of``."""
    found = _solids(lifted.name, lifted.urdf, lifted.model)
    return tuple(replace(solid, name="") for solid in found) if len(found) == 1 else found


def placed_box(name: str, size: tuple[float, float, float], position: tuple[float, float, float], yaw: float) -> Solid:
    """Return a box that stands in the world.

    Args:
        name: of the obstacle.
        size: along its axes x, y, z [m].
        position: of its centre in the world [m].
        yaw: about Z from the world's X [rad].
    """
    return Solid(name, "", 0, translation(*position) @ rotation_z(yaw), "box", size)


def _solids(owner: str, urdf: str, model: pin.Model) -> tuple[Solid, ...]:
    """Return the solids of a URDF: of a capsule's three primitives one, and of a cylinder the capsule around it."""
    found = []
    for link in ElementTree.fromstring(urdf).iter("link"):
        shapes = {shape.get("name", ""): shape for shape in link.iter("collision")}
        ends = {
            name.removesuffix(COLLISION) + end + COLLISION
            for name, shape in shapes.items() if shape.find("geometry/cylinder") is not None
            for end in END_SPHERES
        }  # fmt: skip
        if not shapes:
            continue
        frame = model.frames[model.getFrameId(link.get("name", ""), pin.FrameType.BODY)]
        for name, shape in shapes.items():
            if name in ends:
                continue
            T_joint_solid = frame.placement.homogeneous @ placement_of(shape.find("origin"))
            part = name.removesuffix(COLLISION).replace("_", " ")
            found.append(Solid(owner, part, frame.parentJoint, T_joint_solid, *_geometry(owner, part, shape)))
    return tuple(found)


def _geometry(owner: str, part: str, shape: Element) -> tuple[SolidKind, tuple[float, ...]]:
    for tag in ("box", "cylinder", "sphere"):
        geometry = shape.find(f"geometry/{tag}")
        if geometry is None:
            continue
        if tag == "box":
            return "box", numbers_in(geometry.get("size", ""))
        (radius,) = numbers_in(geometry.get("radius", ""))
        return "capsule", (radius, *numbers_in(geometry.get("length", "0.0")))
    raise ModelError(f"{owner}: the collision shape of {part} must be a box, a cylinder or a sphere")


def placement_of(origin: Element | None) -> Array:
    """Return the placement (4, 4) that an ``<origin>`` of a URDF says; none there is at the frame itself."""
    placement = np.eye(4)
    if origin is not None:
        placement[:3, :3] = pin.rpy.rpyToMatrix(np.array(numbers_in(origin.get("rpy", "0 0 0"))))
        placement[:3, 3] = numbers_in(origin.get("xyz", "0 0 0"))
    return placement


def numbers_in(text: str) -> tuple[float, ...]:
    """Return the numbers of an attribute of a URDF."""
    return tuple(map(float, text.split()))
