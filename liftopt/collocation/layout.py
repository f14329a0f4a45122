"""Which unknown is which: control points and grasp forces, ordered in time, and the maps to knot variables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from liftopt.collocation.spline import Mesh
from liftopt.collocation.wrench_dynamics import WRENCH_SIZE
from liftopt.multibody.agent import Agent, Grasp
from liftopt.types import Array

Index = npt.NDArray[np.int64]
OBJECT_SIZE = 6
FORCE_SIZE = 3


@dataclass(frozen=True, eq=False)
class Layout:
    """Positions of the unknowns in x.

    Attributes:
        mesh: the mesh they live on.
        agents: who moves; the object's six coordinates come after theirs.
        control: (n_free, sum of coordinates + 6) positions of the control points.
        force: (K, sum of the grasps' sizes) positions of the grasp forces, each followed by its moment if it has one.
    """

    mesh: Mesh
    agents: tuple[Agent, ...]
    control: Index
    force: Index

    @staticmethod
    def on(mesh: Mesh, agents: Sequence[Agent]) -> Layout:
        """Lay the unknowns out in the order of time, so that what interacts is near."""
        n = sum(len(agent.posture) for agent in agents) + OBJECT_SIZE
        m = sum(grasp.size for agent in agents for grasp in agent.grasps)
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
        return Layout(mesh, tuple(agents), control, force)

    @cached_property
    def coordinates(self) -> tuple[int, ...]:
        """Number of coordinates of each agent."""
        return tuple(len(agent.posture) for agent in self.agents)

    @cached_property
    def grasps(self) -> tuple[Grasp, ...]:
        """All grasps, in the order of the agents and of each agent's own."""
        return tuple(grasp for agent in self.agents for grasp in agent.grasps)

    @cached_property
    def holders(self) -> tuple[int, ...]:
        """Which agent holds with each of ``grasps``."""
        return tuple(i for i, agent in enumerate(self.agents) for _ in agent.grasps)

    @property
    def n_x(self) -> int:
        """Number of unknowns."""
        return self.control.size + self.force.size

    @property
    def n_agents(self) -> int:
        """Number of agents."""
        return len(self.agents)

    def columns(self, part: int) -> slice:
        """Return the columns of ``control`` that belong to an agent, or to the object for ``part == n_agents``."""
        sizes = (*self.coordinates, OBJECT_SIZE)
        first = sum(sizes[:part])
        return slice(first, first + sizes[part])

    def grasps_of(self, part: int) -> range:
        """Return which of ``grasps`` are an agent's, or all of them for the object."""
        if part == self.n_agents:
            return range(len(self.grasps))
        first = sum(len(agent.grasps) for agent in self.agents[:part])
        return range(first, first + len(self.agents[part].grasps))

    def force_columns(self, grasp: int) -> slice:
        """Return the columns of ``force`` of one of ``grasps``."""
        first = sum(each.size for each in self.grasps[:grasp])
        return slice(first, first + self.grasps[grasp].size)

    def wrenches(self, force: Array) -> Array:
        """Return force and moment (K, grasps, 6) of every grasp from the columns of ``force``; no moment is zero."""
        whole = np.zeros((len(force), len(self.grasps), WRENCH_SIZE))
        for g, grasp in enumerate(self.grasps):
            whole[:, g, : grasp.size] = force[:, self.force_columns(g)]
        return whole

    def kernel_forces(self, part: int) -> Index:
        """Return the columns of ``force`` in the order that a part's kernel takes them, -1 for what is always zero.

        The kernels for wrenches have room for every moment, those of an agent for every hand, used or not.
        """
        columns, chosen = np.arange(self.force.shape[1]), self.grasps_of(part)
        if part == self.n_agents:
            bare, hands = all(grasp.is_point_contact for grasp in self.grasps), list(chosen)
        else:
            agent = self.agents[part]
            bare, hands = agent.pushes_at_a_point, [agent.hands.index(grasp.frame) for grasp in agent.grasps]
        rooms = np.full((self._hands(part), FORCE_SIZE if bare else WRENCH_SIZE), -1)
        for g, hand in zip(chosen, hands, strict=True):
            rooms[hand, : self.grasps[g].size] = columns[self.force_columns(g)]
        return rooms.ravel()

    def _hands(self, part: int) -> int:
        return len(self.grasps) if part == self.n_agents else len(self.agents[part].hands)

    def kernel_others(self, part: int) -> Index:
        """Return the columns of ``control`` whose values a part's kernel takes after the forces: the attitude."""
        follows = part < self.n_agents and not self.agents[part].pushes_at_a_point
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
