"""Triangle meshes made by code: smooth tubes through rings, balls and boxes, as the viewer's figures are built of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations, product

import numpy as np
import numpy.typing as npt

from liftopt.types import Array

SIDES, FEW_SIDES = 20, 8  # of a ring: smooth at the size of a screen, for limbs and for fingers
THIN = 0.02  # [m]
CAP_RINGS, MANY_RINGS, LONG = 3, 8, 0.06  # of a rounded end, of one that bulges more than so far [m]


@dataclass(frozen=True)
class Mesh:
    """A triangle mesh.

    Attributes:
        vertices: (n, 3) [m].
        triangles: (m, 3) indices, counter-clockwise seen from outside.
    """

    vertices: Array
    triangles: npt.NDArray[np.int64]

    def seen_from(self, transform: Array) -> Mesh:
        """Return the same mesh in frame A, given T_A_B (4, 4) of its present frame B."""
        return replace(self, vertices=self.vertices @ transform[:3, :3].T + transform[:3, 3])


@dataclass(frozen=True)
class Ring:
    """One cross-section of a tube.

    Attributes:
        centre: (3,) [m].
        across, along: half axes of the section [m]; ``across`` lies in the direction the tube is given.
        squareness: 2 is an ellipse, more is boxier (a superellipse's exponent).
    """

    centre: tuple[float, float, float]
    across: float
    along: float
    squareness: float = 2.0


def tube(rings: Sequence[Ring], across: Sequence[float], *, round_start: float = 0.0, round_end: float = 0.0) -> Mesh:
    """Return a closed tube through ``rings``.

    Args:
        rings: at least two, in order along the axis.
        across: (3,) direction of the rings' first half axis, made orthogonal to the axis at every ring.
        round_start: how far the first end bulges [m]; 0 leaves it flat.
        round_end: the same of the last end.
    """
    centres = np.array([ring.centre for ring in rings])
    tangents = np.gradient(centres, axis=0)
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    sides = SIDES if max(max(ring.across, ring.along) for ring in rings) > THIN else FEW_SIDES
    aside = np.asarray(across, float)
    loops = [_loop(ring, axis, aside, sides) for ring, axis in zip(rings, tangents, strict=True)]
    loops = _cap(loops[0], -tangents[0] * round_start)[::-1] + loops + _cap(loops[-1], tangents[-1] * round_end)
    return _skin(loops)


def capsule(start: npt.ArrayLike, end: npt.ArrayLike, radius: float, end_radius: float | None = None) -> Mesh:
    """Return a round-ended tube from ``start`` to ``end`` (3,), tapering to ``end_radius`` [m]."""
    tip = radius if end_radius is None else end_radius
    a, b = np.asarray(start, float), np.asarray(end, float)
    rings = [Ring(_point(a), radius, radius), Ring(_point(b), tip, tip)]
    return tube(rings, _aside(b - a), round_start=radius, round_end=tip)


def cylinder(
    start: npt.ArrayLike, end: npt.ArrayLike, radius: float, *, end_radius: float | None = None, edge: float = 0.006
) -> Mesh:
    """Return a cylinder, or a cone, from ``start`` to ``end`` (3,) with edges rounded by ``edge`` [m]."""
    tip = radius if end_radius is None else end_radius
    a, b = np.asarray(start, float), np.asarray(end, float)
    step = edge * (b - a) / np.linalg.norm(b - a)
    inset = [Ring(_point(a), max(radius - edge, 1e-4), max(radius - edge, 1e-4))]
    inset += [Ring(_point(a + step), radius, radius), Ring(_point(b - step), tip, tip)]
    inset += [Ring(_point(b), max(tip - edge, 1e-4), max(tip - edge, 1e-4))]
    return tube(inset, _aside(b - a))


def ball(centre: Sequence[float], radii: Sequence[float]) -> Mesh:
    """Return an ellipsoid with half axes ``radii`` (3,) along x, y, z [m]."""
    c, (x, y, z) = np.asarray(centre, float), radii
    flat = (float(c[0]), float(c[1]))
    angles = np.linspace(-np.pi / 2, np.pi / 2, 9)[1:-1]
    rings = [Ring((*flat, float(c[2] + z * np.sin(t))), x * float(np.cos(t)), y * float(np.cos(t))) for t in angles]
    pole = z * (1.0 - float(np.sin(angles[-1])))
    return tube(rings, (1.0, 0.0, 0.0), round_start=pole, round_end=pole)


def block(centre: Sequence[float], size: Sequence[float], *, edge: float = 0.01) -> Mesh:
    """Return a box of ``size`` (3,) along x, y, z with its edges cut off by ``edge`` [m]."""
    half = np.asarray(size, float) / 2.0
    edge = float(min(edge, *(half * 0.9)))
    # Corner c has three vertices, one in the plane of each of its faces.
    signs = np.array(list(product((-1.0, 1.0), repeat=3)))
    vertices = np.repeat(signs * (half - edge), 3, axis=0) + np.tile(edge * np.eye(3), (8, 1)) * np.repeat(signs, 3, 0)
    triangles = [[3 * c, 3 * c + 1, 3 * c + 2] for c in range(8)]
    for axis, sign in product(range(3), (-1.0, 1.0)):
        a, b, c, d = (3 * corner + axis for corner in np.flatnonzero(signs[:, axis] == sign).tolist())
        triangles += [[a, b, d], [a, d, c]]
    for c, d in combinations(range(8), 2):
        differ = np.flatnonzero(signs[c] != signs[d])
        if len(differ) == 1:  # the two ends of an edge: cut between its two faces
            one, other = (axis for axis in range(3) if axis not in differ)
            triangles += [[3 * c + one, 3 * d + one, 3 * d + other], [3 * c + one, 3 * d + other, 3 * c + other]]
    found = np.array(triangles, dtype=np.int64)
    first, second, third = (vertices[found[:, i]] for i in range(3))
    normal = np.cross(second - first, third - first)
    inwards = np.einsum("ti,ti->t", normal, first + second + third) < 0.0
    found[inwards] = found[inwards, ::-1]
    return Mesh(vertices + np.asarray(centre, float), found)


def merged(meshes: Sequence[Mesh]) -> Mesh:
    """Return all ``meshes`` as one."""
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
    triangles = [mesh.triangles + start for mesh, start in zip(meshes, starts, strict=True)]
    return Mesh(np.vstack([mesh.vertices for mesh in meshes]), np.vstack(triangles))


def _loop(ring: Ring, axis: Array, across: Array, sides: int) -> Array:
    first = across - axis * float(across @ axis)
    first /= np.linalg.norm(first)
    second = np.cross(axis, first)
    angle = np.linspace(0.0, 2.0 * np.pi, sides, endpoint=False)
    power = 2.0 / ring.squareness
    c, s = (np.sign(f) * np.abs(f) ** power for f in (np.cos(angle), np.sin(angle)))
    return np.asarray(ring.centre + ring.across * np.outer(c, first) + ring.along * np.outer(s, second))


def _cap(loop: Array, bulge: Array) -> list[Array]:
    """Return the loops that close an end, outward: a dome of height ``bulge``, or flat."""
    centre = loop.mean(axis=0)
    if not bulge.any():
        # The rim once more, so that the flat end does not share its normals with the side.
        return [loop.copy(), centre + 1e-6 * (loop - centre)]
    rings = MANY_RINGS if np.linalg.norm(bulge) > LONG else CAP_RINGS
    angles = np.linspace(0.0, np.pi / 2, rings + 1)[1:]
    return [centre + max(float(np.cos(t)), 1e-6) * (loop - centre) + float(np.sin(t)) * bulge for t in angles]


def _skin(loops: list[Array]) -> Mesh:
    sides = len(loops[0])
    here = np.arange(sides)
    there = (here + 1) % sides
    triangles = []
    for i in range(len(loops) - 1):
        low, high = i * sides, (i + 1) * sides
        triangles.append(np.stack([low + here, low + there, high + there], axis=1))
        triangles.append(np.stack([low + here, high + there, high + here], axis=1))
    return Mesh(np.vstack(loops), np.vstack(triangles))


def _aside(axis: Array) -> tuple[float, float, float]:
    """Return a direction that is not along ``axis``."""
    return (1.0, 0.0, 0.0) if abs(axis[0]) < 0.7 * np.linalg.norm(axis) else (0.0, 1.0, 0.0)


def _point(values: Array) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in values)
    return (x, y, z)
