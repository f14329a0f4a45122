"""The surface of each body of a robot: what its links collide with, as triangles."""

from __future__ import annotations

from itertools import product

import numpy as np

from liftopt.errors import InputError
from liftopt.multibody.robots.carried_links import CarriedLink, carried_links
from liftopt.multibody.robots.chain import RobotChain
from liftopt.multibody.robots.fitted_solids import Surface
from liftopt.multibody.robots.mesh_file import Triangles, read_mesh
from liftopt.multibody.robots.robot_shape import RobotShape
from liftopt.types import Array

AROUND = 16  # sides of the prism around a cylinder


def body_surfaces(chain: RobotChain) -> tuple[dict[int, Surface], tuple[CarriedLink, ...]]:
    """Return the surface of every body that has one, in the frame of its own link, and the links in their order.

    Of a link it is what it collides with, or else what it is drawn with; a mesh that cannot be read has none. A
    triangle's owner is the number of its link.
    """
    carried = tuple(carried_links(chain))
    found: dict[int, list[tuple[Array, int]]] = {}
    for number, item in enumerate(carried):
        for shapes in (item.link.collisions, item.link.visuals):
            pieces = [piece for shape in shapes if (piece := shape_triangles(shape)) is not None]
            if pieces:
                corners = np.concatenate(pieces)
                moved = corners @ item.placement[:3, :3].T + item.placement[:3, 3]
                found.setdefault(item.body, []).append((moved, number))
                break
    surfaces = {}
    for body, parts in found.items():
        owner = np.repeat([number for _, number in parts], [len(corners) for corners, _ in parts])
        surfaces[body] = Surface(np.concatenate([corners for corners, _ in parts]), owner)
    return surfaces, carried


def shape_triangles(shape: RobotShape) -> Array | None:
    """Return triangles (m, 3, 3) of a shape in the link's frame, or None where a mesh cannot be read.

    Of a cylinder or a ball they are those of a body with corners around it.
    """
    if shape.kind == "mesh":
        pieces = mesh_pieces(shape)
        if not pieces:
            return None
        corners = np.concatenate([piece.vertices[piece.triangles] for piece in pieces])
    else:
        from scipy.spatial import ConvexHull  # as much work to import as all else here

        points = _corners(shape)
        corners = points[ConvexHull(points).simplices]
    return np.asarray(corners @ shape.placement[:3, :3].T + shape.placement[:3, 3])


def mesh_pieces(shape: RobotShape) -> tuple[Triangles, ...]:
    """Return the pieces of a shape's mesh in the frame of the shape, none where it cannot be read."""
    if shape.mesh is None or shape.mesh.path is None:
        return ()
    try:
        return read_mesh(shape.mesh.path, shape.size, y_up=shape.mesh.y_up)
    except InputError:
        return ()


def _corners(shape: RobotShape) -> Array:
    if shape.kind == "box":
        return np.array(list(product(*((-edge / 2.0, edge / 2.0) for edge in shape.size))))
    angle = 2.0 * np.pi * np.arange(AROUND) / AROUND
    around = np.column_stack([np.cos(angle), np.sin(angle)]) / np.cos(np.pi / AROUND)
    radius = shape.size[0]
    if shape.kind == "cylinder":
        rings = [(radius, sign * shape.size[1] / 2.0) for sign in (-1.0, 1.0)]
    else:
        # A ball's rings are those of a profile with corners around it.
        half = np.pi / AROUND
        slopes = -np.pi / 2.0 + half * np.arange(0.5, AROUND)
        rings = [
            (radius * np.cos(slope) / np.cos(half / 2.0), radius * np.sin(slope) / np.cos(half / 2.0))
            for slope in slopes
        ]
    return np.vstack([np.column_stack([r * around, np.full(AROUND, z)]) for r, z in rings])
