"""Which unknown is which: control points and grasp forces, ordered in time, and the maps to knot variables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from liftopt.collocation.spline import Mesh

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.int64]
OBJECT_SIZE = 6
FORCE_SIZE = 3


@dataclass(frozen=True)
class Layout:
    """Positions of the unknowns in x.

    Attributes:
        mesh: the mesh they live on.
        coordinates: number of coordinates of each agent; the object's six come after them.
        control: (n_free, sum of coordinates + 6) positions of the control points.
        force: (K, 3 agents) positions of the grasp forces.
    """

    mesh: Mesh
    coordinates: tuple[int, ...]
    control: Index
    force: Index

    @staticmethod
    def on(mesh: Mesh, coordinates: Sequence[int]) -> Layout:
        """Lay the unknowns out in the order of time, so that what interacts is near."""
        n, m = sum(coordinates) + OBJECT_SIZE, FORCE_SIZE * len(coordinates)
        order = sorted(
            [(phase, 0, i) for i, phase in enumerate(mesh.control_phase)]
            + [(phase, 1, k) for k, phase in enumerate(mesh.phase)]
        )
        control, force = np.zeros((len(mesh.control_phase), n), np.int64), np.zeros((len(mesh.phase), m), np.int64)
        at = 0
        for _, is_force, i in order:
            target = force if is_force else control
            target[i] = at + np.arange(target.shape[1])
            at += target.shape[1]
        return Layout(mesh, tuple(coordinates), control, force)

    @property
    def n_x(self) -> int:
        """Number of unknowns."""
        return self.control.size + self.force.size

    @property
    def n_agents(self) -> int:
        """Number of agents."""
        return len(self.coordinates)

    def columns(self, part: int) -> slice:
        """Return the columns of ``control`` that belong to an agent, or to the object for ``part == n_agents``."""
        sizes = (*self.coordinates, OBJECT_SIZE)
        first = sum(sizes[:part])
        return slice(first, first + sizes[part])

    def force_columns(self, part: int) -> slice:
        """Return the columns of ``force`` that act on an agent, or all of them for the object."""
        return slice(None) if part == self.n_agents else slice(FORCE_SIZE * part, FORCE_SIZE * (part + 1))

    def select(self, part: int) -> sp.csc_matrix:
        """Return S (K n_y, n_x): at each knot q, q', q'' and the forces of a part, as linear maps of x."""
        control, force = self.control[:, self.columns(part)], self.force[:, self.force_columns(part)]
        n, m = control.shape[1], force.shape[1]
        n_y, rows, cols, values = 3 * n + m, [], [], []
        for order, basis in enumerate(self.mesh.basis):
            knot, i = np.nonzero(basis)
            rows.append(n_y * knot[:, None] + order * n + np.arange(n))
            cols.append(control[i])
            values.append(np.repeat(basis[knot, i], n))
        rows.append(n_y * np.arange(len(force))[:, None] + 3 * n + np.arange(m))
        cols.append(force)
        values.append(np.ones(force.size))
        row, col = (np.concatenate([part.ravel() for part in parts]) for parts in (rows, cols))
        return sp.csc_matrix((np.concatenate(values), (row, col)), shape=(len(force) * n_y, self.n_x))
