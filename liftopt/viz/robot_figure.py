"""A robot with its own meshes, as few triangles as a page can bear: what its links are drawn with, body by body."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

import numpy as np

from liftopt.multibody.robots.carried_links import carried_links
from liftopt.multibody.robots.chain import RobotChain
from liftopt.multibody.robots.link_surfaces import mesh_pieces, shape_triangles
from liftopt.multibody.robots.mesh_file import Triangles
from liftopt.multibody.robots.robot_shape import MeshFile, RobotShape
from liftopt.multibody.robots.robot_urdf import turned
from liftopt.types import Array
from liftopt.viz.scene_mesh import Mesh, merged
from liftopt.viz.scene_part import Colour
from liftopt.viz.simplified_mesh import creased, simplified

Known = dict[tuple[MeshFile, tuple[float, ...]], tuple[Triangles, ...]]
GREY: Colour = (0.66, 0.67, 0.69)  # of what has no colour
MOST_TRIANGLES = 40_000  # of a robot: some 1.5 MB of a page
SAME = 2e-4  # [m]: vertices so near are one, as those of neighbouring triangles of an STL are
FINEST, COARSER = 0.003, 1.25  # cell of the grid of the first try [m], and how much coarser each next one is
FAR = 1.5  # times as many triangles as are allowed, from which on two steps are one
FEWEST = 10  # cells along a mesh's largest extent


@dataclass(frozen=True)
class FigurePiece:
    """What is drawn in one colour of one body.

    Attributes:
        joint: number of the joint of the chain that moves it, from 0 on; ``BASE`` of what stands still.
        colour: of it.
        mesh: in the frame of that joint in liftopt's model, or in that of the base link.
    """

    joint: int
    colour: Colour
    mesh: Mesh = field(repr=False)


def figure_of(chain: RobotChain) -> tuple[FigurePiece, ...]:
    """Return what a robot is drawn with, all that hangs on its base; nothing where none of its meshes can be read."""
    pieces = [FigurePiece(piece.joint, piece.colour, _fewer(piece.mesh, SAME)) for piece in _pieces(chain)]
    if not pieces:
        return ()
    cell = FINEST
    while (count := sum(len(piece.mesh.triangles) for piece in pieces)) > MOST_TRIANGLES:
        pieces = [FigurePiece(piece.joint, piece.colour, _fewer(piece.mesh, cell)) for piece in _with_triangles(pieces)]
        cell *= COARSER if count < FAR * MOST_TRIANGLES else COARSER**2
    groups: dict[tuple[int, Colour], list[Mesh]] = {}
    for piece in _with_triangles(pieces):
        groups.setdefault((piece.joint, piece.colour), []).append(creased(piece.mesh))
    return tuple(FigurePiece(joint, colour, merged(meshes)) for (joint, colour), meshes in groups.items())


def _with_triangles(pieces: Iterable[FigurePiece]) -> list[FigurePiece]:
    """Return the pieces of which something is left: a small one may have gone."""
    return [piece for piece in pieces if len(piece.mesh.triangles)]


def _fewer(mesh: Mesh, cell: float) -> Mesh:
    return simplified(mesh, min(cell, float(np.ptp(mesh.vertices, axis=0).max()) / FEWEST + 1e-6))


def _pieces(chain: RobotChain) -> Iterator[FigurePiece]:
    turns = {number: np.asarray(np.linalg.inv(turned(link))) for number, link in enumerate(chain.links)}
    read: Known = {}
    for carried in carried_links(chain):
        placement = turns.get(carried.body, np.eye(4)) @ carried.placement
        for shape in carried.link.visuals:
            for colour, mesh in _drawn(shape, read):
                yield FigurePiece(carried.body, colour, mesh.seen_from(placement))


def _drawn(shape: RobotShape, read: Known) -> Iterator[tuple[Colour, Mesh]]:
    """Give colour and mesh, in the link's frame, of what a shape is drawn with; ``read`` are meshes that are known."""
    if shape.mesh is None:
        corners = shape_triangles(shape)
        if corners is not None:
            yield shape.colour or GREY, _outward(corners)
    else:
        if (shape.mesh, shape.size) not in read:
            read[shape.mesh, shape.size] = mesh_pieces(shape)
        for piece in read[shape.mesh, shape.size]:
            mesh = Mesh(piece.vertices, piece.triangles).seen_from(shape.placement)
            yield piece.colour or shape.colour or GREY, mesh


def _outward(corners: Array) -> Mesh:
    """Return a convex body of triangles (m, 3, 3), each turned outward."""
    first, second, third = (corners[:, i] for i in range(3))
    inward = np.einsum("ti,ti->t", np.cross(second - first, third - first), first - corners.mean(axis=(0, 1))) < 0.0
    corners = np.where(inward[:, None, None], corners[:, ::-1], corners)
    vertices, index = np.unique(np.round(corners.reshape(-1, 3), 7), axis=0, return_inverse=True)
    return Mesh(vertices, index.reshape(-1, 3).astype(np.int64))
