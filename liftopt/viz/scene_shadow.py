"""Where figures touch the floor it is darker: without that feet and pedestals seem to float.

Real shadows cost too much without a graphics card; this is one flat mesh that is darkest under what stands and fades
around it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from liftopt.types import Array
from liftopt.viz.scene_commands import Command, set_object
from liftopt.viz.scene_mesh import Mesh
from liftopt.viz.scene_part import Colour, Part

TOUCHES = 0.03  # height below which a vertex counts as standing on the floor [m]
APART = 0.10  # between what touches the floor apart [m]
# How dark it is so far outside the half axes of what stands there [m]; under it as at the first.
FADES = ((0.0, 0.50), (0.02, 0.32), (0.05, 0.14), (0.12, 0.0))
HEIGHT = 0.003  # above the floor and its grid [m]
BLACK: Colour = (0.0, 0.0, 0.0)
SIDES = 32


def shadow_commands(root: str, parts: Iterable[Part]) -> list[Command]:
    """Return the command that darkens the floor under parts, which are given where they stand, below a node."""
    spots = [_disc(centre, half) for part in parts for centre, half in _spots(part.mesh)]
    if not spots:
        return []
    count = len(spots[0].vertices)
    triangles = np.vstack([spot.triangles + i * count for i, spot in enumerate(spots)])
    dark = np.concatenate([*(np.full(SIDES, value) for _, value in FADES), [FADES[0][1]]])
    colours = np.column_stack([np.zeros((count, 3)), dark])
    mesh = Mesh(np.vstack([spot.vertices for spot in spots]), triangles)
    return [set_object(f"{root}/shadow", mesh, BLACK, colours=np.tile(colours, (len(spots), 1)))]


def _spots(mesh: Mesh) -> Iterator[tuple[Array, Array]]:
    """Yield centre and half axes (2,) of each place where a part touches the floor."""
    left = np.vstack([mesh.vertices[mesh.vertices[:, 2] < TOUCHES], *_along_edges(mesh)])[:, :2]
    while len(left):
        near, count = left[:1], 0
        while len(near) > count:
            count, low, high = len(near), near.min(axis=0) - APART, near.max(axis=0) + APART
            inside = np.all((low <= left) & (left <= high), axis=1)
            near = left[inside]
        left = left[~inside]
        yield (near.min(axis=0) + near.max(axis=0)) / 2, np.ptp(near, axis=0) / 2


def _along_edges(mesh: Mesh) -> Iterator[Array]:
    """Yield points (n, 3) along each edge on the floor that is longer than what lies apart, as those of a plate are."""
    ends = mesh.vertices[np.concatenate([mesh.triangles[:, [i, (i + 1) % 3]] for i in range(3)])]
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    for edge in np.flatnonzero((lengths > APART) & (ends[:, :, 2] < TOUCHES).all(axis=1)):
        (start, end), count = ends[edge], int(np.ceil(2.0 * lengths[edge] / APART))
        yield start + np.linspace(0.0, 1.0, count)[:, None] * (end - start)


def _disc(centre: Array, half: Array) -> Mesh:
    """Return rings of ``SIDES`` vertices around a last one in the middle, a ring for each of ``FADES``."""
    angle = np.linspace(0.0, 2 * np.pi, SIDES, endpoint=False)
    round_ = np.column_stack([np.cos(angle), np.sin(angle)])
    rings = np.vstack([centre + (half + wider) * round_ for wider, _ in FADES] + [centre[None]])
    here = np.arange(SIDES)
    there = (here + 1) % SIDES
    triangles = [np.column_stack([here, there, np.full(SIDES, len(FADES) * SIDES)])]
    for i in range(len(FADES) - 1):
        low, high = i * SIDES, (i + 1) * SIDES
        triangles.append(np.column_stack([low + here, high + here, high + there]))
        triangles.append(np.column_stack([low + here, high + there, low + there]))
    return Mesh(np.column_stack([rings, np.full(len(rings), HEIGHT)]), np.vstack(triangles))
