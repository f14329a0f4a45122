"""A mesh with fewer triangles that looks much the same, and with edges that look sharp where it has sharp ones.

All vertices in a cell of a grid become one, where it is nearest to the planes of the triangles around them: quadric
error metrics on a grid (Garland & Heckbert 1997; Lindstrom 2000). Nothing moves by more than a cell's diagonal.
"""

from __future__ import annotations

from itertools import product

import numpy as np
import numpy.typing as npt
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from liftopt.types import Array
from liftopt.viz.scene_mesh import Mesh

Indices = npt.NDArray[np.int64]
TO_MEAN = 1e-3  # share of the pull toward the mean of a cell's vertices, which decides where planes do not
SHARP = np.radians(40.0)  # between two triangles: from here on their edge is one


def simplified(mesh: Mesh, cell: float) -> Mesh:
    """Return a mesh whose vertices in each cell of a grid are one, without triangles that are then a line or a point.

    Args:
        mesh: any.
        cell: edge of a cell [m].
    """
    vertices, triangles = mesh.vertices, mesh.triangles
    low = vertices.min(axis=0)
    grid = np.floor((vertices - low) / cell).astype(np.int64)
    size = grid.max(axis=0) + 1
    codes, cluster = np.unique(grid @ np.array([1, size[0], size[0] * size[1]]), return_inverse=True)
    count, corners = len(codes), cluster.ravel()[triangles]
    placed = _nearest_to_planes(vertices, triangles, corners, cluster.ravel(), count)
    centres = low + cell * (np.column_stack([codes % size[0], codes // size[0] % size[1], codes // (size[0] * size[1])])
                            + 0.5)  # fmt: skip
    placed = np.clip(placed, centres - cell / 2.0, centres + cell / 2.0)
    a, b, c = corners.T
    kept = corners[(a != b) & (b != c) & (c != a)]
    # The same triangle twice, whichever corner comes first.
    first = kept[np.arange(len(kept))[:, None], (np.argmin(kept, axis=1)[:, None] + np.arange(3)) % 3]
    kept = np.unique(first, axis=0)
    used, indices = np.unique(kept, return_inverse=True)
    return Mesh(placed[used], indices.reshape(kept.shape).astype(np.int64))


def _nearest_to_planes(vertices: Array, triangles: Indices, corners: Indices, cluster: Indices, count: int) -> Array:
    """Return for each cluster of vertices the point (count, 3) that is nearest to the planes around it."""
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    normal = np.cross(b - a, c - a)
    area = np.linalg.norm(normal, axis=1)
    unit = normal / np.maximum(area, 1e-18)[:, None]
    offset = area * np.einsum("ti,ti->t", unit, a)
    planes, toward = np.zeros((count, 3, 3)), np.zeros((count, 3))
    for corner, i in product(range(3), range(3)):
        toward[:, i] += np.bincount(corners[:, corner], offset * unit[:, i], count)
        for j in range(3):
            planes[:, i, j] += np.bincount(corners[:, corner], area * unit[:, i] * unit[:, j], count)
    many = np.bincount(cluster, minlength=count)
    mean = np.column_stack([np.bincount(cluster, vertices[:, i], count) for i in range(3)]) / many[:, None]
    pull = TO_MEAN * np.trace(planes, axis1=1, axis2=2) + 1e-18
    planes += pull[:, None, None] * np.eye(3)
    return np.asarray(np.linalg.solve(planes, (toward + pull[:, None] * mean)[:, :, None])[:, :, 0])


def creased(mesh: Mesh) -> Mesh:
    """Return a mesh whose vertices on sharp edges are one for each side, so that light does not round them off."""
    triangles = mesh.triangles
    a, b, c = (mesh.vertices[triangles[:, i]] for i in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-18)
    # Every triangle's edges, both ends in the order of their numbers, with the corners that they are.
    number = np.arange(3 * len(triangles)).reshape(-1, 3)
    ends = np.concatenate([triangles[:, [i, (i + 1) % 3]] for i in range(3)])
    own = np.concatenate([number[:, [i, (i + 1) % 3]] for i in range(3)])
    turned = ends[:, 0] > ends[:, 1]
    ends[turned], own[turned] = ends[turned, ::-1], own[turned, ::-1]
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    ends, own = ends[order], own[order]
    same = np.flatnonzero((ends[1:] == ends[:-1]).all(axis=1))
    one, other = own[same], own[same + 1]
    smooth = np.einsum("ei,ei->e", normal[one[:, 0] // 3], normal[other[:, 0] // 3]) > np.cos(SHARP)
    one, other = one[smooth].ravel(), other[smooth].ravel()
    links = coo_matrix((np.ones(len(one)), (one, other)), shape=(number.size, number.size))
    count, component = connected_components(links, directed=False)
    source = np.zeros(count, dtype=np.int64)
    source[component] = triangles.ravel()
    return Mesh(mesh.vertices[source], component.astype(np.int64).reshape(-1, 3))
