"""How a link of a robot looks, or what it collides with, as its URDF says: a mesh in a file, or a plain shape."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal
from xml.etree.ElementTree import Element

import numpy as np
import pinocchio as pin

from liftopt.multibody.robots.package_files import file_of
from liftopt.types import Array

ShapeKind = Literal["mesh", "box", "cylinder", "sphere"]
Rgb = tuple[float, float, float]
# Attributes of plain shapes that are lengths.
LENGTHS: dict[ShapeKind, tuple[str, ...]] = {"box": ("size",), "cylinder": ("radius", "length"), "sphere": ("radius",)}
LARGEST = 100.0  # [m], and of scales: nothing of a robot is larger
INVISIBLE = 0.05  # opacity below which a shape is there to be hidden


@dataclass(frozen=True)
class MeshFile:
    """A mesh of a link: its address as written, and the file, or None where none was found.

    ``y_up`` says that a file whose y axis is up, as it states, is turned: few robots are meant so.
    """

    address: str
    path: Path | None
    y_up: bool = False


@dataclass(frozen=True)
class RobotShape:
    """One shape on a link.

    Attributes:
        kind: what it is.
        placement: (4, 4) T_link_shape.
        size: edges of a box, radius and length of a cylinder along z, radius of a sphere [m]; scales of a mesh.
        mesh: its file.
        colour: red, green, blue in [0, 1], or None where the URDF has none.
    """

    kind: ShapeKind
    placement: Array = field(repr=False)
    size: tuple[float, ...]
    mesh: MeshFile | None = None
    colour: Rgb | None = None


def shapes_of(
    link: Element, kind: str, materials: Mapping[str, str], path: Path | None, *, y_up: bool = False
) -> Iterator[RobotShape]:
    """Give the shapes of a link that can be understood; those that cannot are no reason to refuse a robot.

    Args:
        link: of the URDF.
        kind: ``"visual"`` or ``"collision"``.
        materials: colours of the robot's named materials, as text.
        path: the URDF's file, beside which meshes are looked for.
        y_up: of its meshes.
    """
    for element in link.iterfind(kind):
        colour = _numbers(_colour_text(element, materials), 4)
        if colour is not None and colour[3] < INVISIBLE:
            continue
        shape = _geometry(element, path, y_up)
        if shape is not None:
            rgb = None if colour is None else (colour[0], colour[1], colour[2])
            yield RobotShape(shape.kind, _placement(element), shape.size, shape.mesh, rgb)


def _geometry(element: Element, path: Path | None, y_up: bool) -> RobotShape | None:
    mesh = element.find("geometry/mesh")
    if mesh is not None:
        address, scale = str(mesh.get("filename")), _numbers(mesh.get("scale", "1 1 1"), 3)
        if scale is None or 0.0 in scale:
            return None
        return RobotShape("mesh", np.eye(4), scale, MeshFile(address, file_of(address, path), y_up))
    for kind, names in LENGTHS.items():
        plain = element.find(f"geometry/{kind}")
        if plain is not None:
            size = _numbers(" ".join(plain.get(name, "") for name in names), 3 if kind == "box" else len(names))
            return None if size is None or min(size) <= 0.0 else RobotShape(kind, np.eye(4), size)
    return None


def _colour_text(element: Element, materials: Mapping[str, str]) -> str:
    material = element.find("material")
    if material is None:
        return ""
    colour = material.find("color")
    return materials.get(str(material.get("name")), "") if colour is None else colour.get("rgba", "")


def _placement(element: Element) -> Array:
    placement, origin = np.eye(4), element.find("origin")
    if origin is not None:
        placement[:3, 3] = _numbers(origin.get("xyz", "0 0 0"), 3) or (0.0, 0.0, 0.0)
        turn = _numbers(origin.get("rpy", "0 0 0"), 3) or (0.0, 0.0, 0.0)
        placement[:3, :3] = pin.rpy.rpyToMatrix(np.array(turn))
    return placement


def _numbers(text: str, count: int) -> tuple[float, ...] | None:
    """Return as many numbers as that, or None where the text is something else or one is beyond reason."""
    try:
        numbers = tuple(float(word) for word in text.split())
    except ValueError:
        return None
    return numbers if len(numbers) == count and all(abs(number) <= LARGEST for number in numbers) else None
