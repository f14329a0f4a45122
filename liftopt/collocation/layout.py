"""Which unknown is which: control points and grasp forces, ordered in time, and the maps to knot variables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from liftopt.collocation.spline import Mesh
from liftopt.collocation.wrench_dynamics import WRENCH_SIZE
from liftopt.multibody.agent import Grasp
from liftopt.types import Array

Index = npt.NDArray[np.int64]
OBJECT_SIZE = 6
FORCE_SIZE = 3


@dataclass(frozen=True)
class Layout:
    """Positions of the unknowns in x.

    Attributes:
        mesh: the mesh they live on.
        coordinates: number of coordinates of each agent; the object's six come after them.
        grasps: what each agent's hold transmits.
        control: (n_free, sum of coordinates + 6) positions of the control points.
        force: (K, sum of the grasps' sizes) positions of the grasp forces, each followed by its moment if it has one.
    """

    mesh: Mesh
    coordinates: tuple[int, ...]
    grasps: tuple[Grasp, ...]
    control: Index
    force: Index

    @staticmethod
    def on(mesh: Mesh, coordinates: Sequence[int], grasps: Sequence[Grasp]) -> Layout:
        """Lay the unknowns out in the order of time, so that what interacts is near."""
        n, m = sum(coordinates) + OBJECT_SIZE, sum(grasp.size for grasp in grasps)
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
        return Layout(mesh, tuple(coordinates), tuple(grasps), control, force)

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
        if part == self.n_agents:
            return slice(None)
        first = sum(grasp.size for grasp in self.grasps[:part])
        return slice(first, first + self.grasps[part].size)

    def wrenches(self, force: Array) -> Array:
        """Return force and moment (K, agents, 6) of every grasp from the columns of ``force``; no moment is zero."""
        whole = np.zeros((len(force), self.n_agents, WRENCH_SIZE))
        for i, grasp in enumerate(self.grasps):
            whole[:, i, : grasp.size] = force[:, self.force_columns(i)]
        return whole

    def kernel_forces(self, part: int) -> Index:
        """Return the columns of ``force`` in the order that a part's kernel takes them, -1 for what is always zero.

        The kernels for wrenches have room for every moment.
        """
        columns = np.arange(self.force.shape[1])
        chosen = range(self.n_agents) if part == self.n_agents else (part,)
        bare = all(self.grasps[i].is_point_contact for i in chosen)
        rooms = np.full((len(chosen), FORCE_SIZE if bare else WRENCH_SIZE), -1)
        for room, i in zip(rooms, chosen, strict=True):
            room[: self.grasps[i].size] = columns[self.force_columns(i)]
        return rooms.ravel()

    def kernel_others(self, part: int) -> Index:
        """Return the columns of ``control`` whose values a part's kernel takes after the forces: the attitude."""
        follows = part < self.n_agents and not self.grasps[part].is_point_contact
        return np.arange(self.control.shape[1])[-3:] if follows else np.zeros(0, np.int64)

    def select(self, part: int) -> sp.csc_matrix:
        """Return S (K n_y, n_x): at each knot q, q', q'', forces and others of a part, as linear maps of x."""
        room, others = self.kernel_forces(part), self.control[:, self.kernel_others(part)]
        control, force = self.control[:, self.columns(part)], self.force[:, room[room >= 0]]
        n, m = control.shape[1], len(room)
        n_y, rows, cols, values = 3 * n + m + others.shape[1], [], [], []
        for order, basis in enumerate(self.mesh.basis):
            knot, i = np.nonzero(basis)
            rows.append(n_y * knot[:, None] + order * n + np.arange(n))
            cols.append(control[i])
            values.append(np.repeat(basis[knot, i], n))
        rows.append(n_y * np.arange(len(force))[:, None] + 3 * n + np.flatnonzero(room >= 0))
        cols.append(force)
        values.append(np.ones(force.size))
        knot, i = np.nonzero(self.mesh.basis[0])
        rows.append(n_y * knot[:, None] + 3 * n + m + np.arange(others.shape[1]))
        cols.append(others[i])
        values.append(np.repeat(self.mesh.basis[0][knot, i], others.shape[1]))
        row, col = (np.concatenate([part.ravel() for part in parts]) for parts in (rows, cols))
        return sp.csc_matrix((np.concatenate(values), (row, col)), shape=(len(force) * n_y, self.n_x))

    def select_values(self, part: int) -> sp.csc_matrix:
        """Return S (K n, n_x): at each knot the n coordinates of a part, without derivatives and forces."""
        control, basis = self.control[:, self.columns(part)], self.mesh.basis[0]
        n, (knot, i) = control.shape[1], np.nonzero(basis)
        rows = n * knot[:, None] + np.arange(n)
        entries = np.repeat(basis[knot, i], n), (rows.ravel(), control[i].ravel())
        return sp.csc_matrix(entries, shape=(len(basis) * n, self.n_x))
