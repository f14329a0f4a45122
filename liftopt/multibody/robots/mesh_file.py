"""Triangles of a mesh in a file: STL, OBJ or DAE, which trimesh reads; nothing but that one file is opened."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.bounded_read import read_regular
from liftopt.multibody.robots.robot_shape import Rgb
from liftopt.multibody.robots.xacro_text import INSTALL
from liftopt.types import Array

FORMATS = ("stl", "obj", "dae")
LARGEST = 40_000_000  # bytes of one file; the largest of example-robot-data has 8 million
MOST_TRIANGLES = 1_000_000
UPRIGHT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])  # y becomes z
FARTHEST = 100.0  # [m]: no robot is larger


@dataclass(frozen=True)
class Triangles:
    """Triangles of one colour.

    Attributes:
        vertices: (n, 3) [m].
        triangles: (m, 3) indices.
        colour: red, green, blue in [0, 1], or None where the file has none.
    """

    vertices: Array = field(repr=False)
    triangles: npt.NDArray[np.int64] = field(repr=False)
    colour: Rgb | None = None


def can_be_read(path: Path) -> bool:
    """Return whether a file's name ends as those of meshes do that are read here."""
    return path.suffix.lower().removeprefix(".") in FORMATS


def read_mesh(path: Path, scale: Sequence[float] = (1.0, 1.0, 1.0), *, y_up: bool = False) -> tuple[Triangles, ...]:
    """Return the triangles of a file.

    Args:
        path: of the file.
        scale: (3,) by which its coordinates are multiplied to be metres.
        y_up: turn a DAE that says that its y axis is up; as robots' programs do, what it says is left out else.

    Raises:
        InputError: it has another format, cannot be read, or is beyond what a robot needs; it says which.
    """
    shown, kind = str(path), path.suffix.lower().removeprefix(".")
    if not can_be_read(path):
        raise InputError(shown, NO_VALUE, f"a mesh must be one of {', '.join(FORMATS)}")
    try:
        content = read_regular(path, LARGEST, "a mesh is a file of triangles")
    except FileNotFoundError:
        raise InputError(shown, NO_VALUE, "there is no such mesh") from None
    if kind == "dae" and b"<!DOCTYPE" in content.upper():
        raise InputError(shown, NO_VALUE, "declares a document type, which no mesh needs")
    try:
        turn = UPRIGHT if y_up and kind == "dae" and b"<up_axis>Y_UP" in content else np.eye(3)
        found = tuple(_scaled(piece, np.array(scale), turn) for piece in _pieces(content, kind))
    except ImportError:
        raise InputError(shown, NO_VALUE, f"pycollada reads such meshes: {INSTALL}") from None
    except Exception as error:  # trimesh's readers raise whatever a broken file makes them raise
        raise InputError(shown, NO_VALUE, f"cannot be read as {kind.upper()}: {error}") from None
    count = sum(len(piece.triangles) for piece in found)
    if not 0 < count <= MOST_TRIANGLES:
        raise InputError(shown, NO_VALUE, f"has {count} triangles; a mesh has from 1 to {MOST_TRIANGLES}")
    if not all(np.isfinite(piece.vertices).all() and np.abs(piece.vertices).max() <= FARTHEST for piece in found):
        raise InputError(shown, NO_VALUE, f"has a vertex that is no number or farther off than {FARTHEST:g} m")
    return found


def _pieces(content: bytes, kind: str) -> list[Triangles]:
    import trimesh

    # From bytes and without a resolver: what the file names, textures for instance, is not looked for.
    loaded = trimesh.load_scene(BytesIO(content), file_type=kind, resolver=None, process=False)
    pieces = []
    mesh: Any
    for mesh in loaded.dump():
        triangles = np.asarray(getattr(mesh, "faces", np.zeros((0, 3))), dtype=np.int64)
        if len(triangles):
            pieces.append(Triangles(np.asarray(mesh.vertices, dtype=np.float64), triangles, _colour(mesh)))
    return pieces


def _scaled(piece: Triangles, scale: Array, turn: Array) -> Triangles:
    turned = piece.triangles if np.prod(scale) > 0.0 else piece.triangles[:, ::-1]
    return replace(piece, vertices=(piece.vertices @ turn.T) * scale, triangles=turned)


def _colour(mesh: Any) -> Rgb | None:
    """Return the colour of a mesh's material, where it has a plain one."""
    visual = getattr(mesh, "visual", None)
    if visual is None or not visual.defined:
        return None
    material = getattr(visual, "material", None)
    colour = getattr(visual, "main_color", None) if material is None else getattr(material, "main_color", None)
    if colour is None or len(colour) < 3:
        return None
    red, green, blue = (float(value) / 255.0 for value in colour[:3])
    return (red, green, blue)
