"""The constraints by name: rows ``g = G C + A x``, their bounds, and what each row means.

Numbers in brackets are the paper's constraints. Those of time-independent rows that the spline satisfies by
construction (3: pinned bases, 9: rest at both ends) or that are bounds on unknowns (1: joint limits, 5: range of
motion of the object, 8: poses at the ends) need no row.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from liftopt.collocation.layout import FORCE_SIZE, OBJECT_SIZE, Layout
from liftopt.collocation.task import OBJECT_COORDINATES, LiftTask
from liftopt.multibody.agent import Agent, LiftedObject

Array = npt.NDArray[np.float64]
BALANCE_ROWS = ("force x", "force y", "force z", "moment x", "moment y", "moment z")


@dataclass(frozen=True)
class Block:
    """Rows of one constraint of one agent or the object.

    Attributes:
        name: ``"closure"`` (6), ``"torque"`` (2), ``"keep_in"`` (4), ``"grasp_force"``, ``"balance"`` (7),
            ``"velocity"``.
        who: agent or object.
        rows: where in g.
        labels: meaning of the rows at one knot; they repeat knot by knot.
        lower, upper: bounds of the rows, scaled as the rows are.
    """

    name: str
    who: str
    rows: slice
    labels: tuple[str, ...]
    lower: Array
    upper: Array


@dataclass
class _Rows:
    """Triplets of G and A while they grow."""

    layout: Layout
    outputs: tuple[int, ...]
    n: int = 0
    combine: list[tuple[int, int, float]] = field(default_factory=list)
    linear: list[tuple[int, int, float]] = field(default_factory=list)
    blocks: list[Block] = field(default_factory=list)

    def output(self, part: int, knot: int, row: int) -> int:
        """Return the position of an output of a part at a knot in C."""
        knots = len(self.layout.mesh.phase)
        return knots * sum(self.outputs[:part]) + knot * self.outputs[part] + row

    def close(self, name: str, who: str, labels: tuple[str, ...], lower: Array, upper: Array, repeats: int) -> None:
        """End a block of ``repeats`` knots whose rows have the same bounds at each."""
        first, self.n = self.n, self.n + len(labels) * repeats
        bounds = (np.tile(np.asarray(b, dtype=float), repeats) for b in (lower, upper))
        self.blocks.append(Block(name, who, slice(first, self.n), labels, *bounds))


@dataclass(frozen=True)
class Constraints:
    """All rows: ``g = combine @ C + linear @ x`` with the named blocks in order."""

    blocks: tuple[Block, ...]
    combine: sp.csc_matrix
    linear: sp.csc_matrix

    def same_rows(self, other: Constraints) -> bool:
        """Whether the rows are the same functions, scales included, so that only bounds and parameters may differ."""
        pairs = ((self.combine, other.combine), (self.linear, other.linear))
        return self is other or all(a.shape == b.shape and (a != b).nnz == 0 for a, b in pairs)

    @property
    def lower(self) -> Array:
        """Lower bounds (n_g,)."""
        return np.concatenate([block.lower for block in self.blocks])

    @property
    def upper(self) -> Array:
        """Upper bounds (n_g,)."""
        return np.concatenate([block.upper for block in self.blocks])


def build_constraints(
    agents: tuple[Agent, ...], held: LiftedObject, task: LiftTask, layout: Layout, outputs: tuple[int, ...]
) -> Constraints:
    """Build the rows for agents that hold one object.

    Args:
        agents: in the order of the object's grasp frames.
        held: the object.
        task: limits and tolerances.
        layout: of the unknowns.
        outputs: number of kernel outputs a knot, of each agent and then of the object.
    """
    rows = _Rows(layout, outputs)
    for i, agent in enumerate(agents):
        _closure(rows, i, agent.name)
        _torque(rows, i, agent)
        _keep_in(rows, i, agent)
        _grasp_force(rows, i, agent.name, task.max_grasp_force)
        _velocity(rows, i, agent.name, agent.moving_joints, agent.limits.velocity * task.duration)
    _balance(rows, len(agents), held, task.balance_tolerance)
    _velocity(rows, len(agents), held.name, OBJECT_COORDINATES, task.pose_velocity * task.duration)
    n_c = len(layout.mesh.phase) * sum(outputs)
    return Constraints(
        tuple(rows.blocks),
        _matrix(rows.combine, (rows.n, n_c)),
        _matrix(rows.linear, (rows.n, layout.n_x)),
    )


def _closure(rows: _Rows, i: int, who: str) -> None:
    """Eq. 16: the agent's grasp point is the object's, p_world_grasp - p_world_edge = 0 [m]."""
    n, held = rows.layout.coordinates[i], rows.layout.n_agents
    knots = rows.layout.mesh.closure_knots
    for k, knot in enumerate(knots):
        for axis in range(3):
            row = rows.n + 3 * k + axis
            rows.combine.append((row, rows.output(i, knot, n + axis), 1.0))
            rows.combine.append((row, rows.output(held, knot, OBJECT_SIZE + 3 * i + axis), -1.0))
    rows.close("closure", who, ("x", "y", "z"), np.zeros(3), np.zeros(3), len(knots))


def _torque(rows: _Rows, i: int, agent: Agent) -> None:
    """Eq. 12: torques as shares of the larger of their directional limits."""
    n, limits = rows.layout.coordinates[i], agent.limits
    scale = np.maximum(np.abs(limits.tau_lower), np.abs(limits.tau_upper))
    knots = len(rows.layout.mesh.phase)
    for k in range(knots):
        rows.combine += [(rows.n + n * k + j, rows.output(i, k, j), 1.0 / scale[j]) for j in range(n)]
    rows.close("torque", agent.name, agent.moving_joints, limits.tau_lower / scale, limits.tau_upper / scale, knots)


def _keep_in(rows: _Rows, i: int, agent: Agent) -> None:
    """Eq. 14: the grasp point stays in its half-space [m]."""
    if agent.keep_in is None:
        return
    n, knots = rows.layout.coordinates[i], len(rows.layout.mesh.phase)
    for k in range(knots):
        for axis in np.flatnonzero(agent.keep_in.normal):
            rows.combine.append((rows.n + k, rows.output(i, k, n + int(axis)), float(agent.keep_in.normal[axis])))
    rows.close("keep_in", agent.name, ("distance",), np.array([agent.keep_in.offset]), np.array([np.inf]), knots)


def _grasp_force(rows: _Rows, i: int, who: str, cap: float) -> None:
    """The norm of the grasp force, squared, as a share of its cap squared: the squeeze is free otherwise."""
    n, knots = rows.layout.coordinates[i], len(rows.layout.mesh.phase)
    rows.combine += [(rows.n + k, rows.output(i, k, n + FORCE_SIZE), 1.0 / cap**2) for k in range(knots)]
    rows.close("grasp_force", who, ("norm",), np.array([-np.inf]), np.ones(1), knots)


def served_rows(held: LiftedObject, tolerance: float) -> list[int]:
    """Return the rows of the balance to ask for: all six with a tolerance, as in the paper, else those served."""
    return [r for r in range(OBJECT_SIZE) if tolerance > 0 or r != held.unserved_row()]


def _balance(rows: _Rows, part: int, held: LiftedObject, tolerance: float) -> None:
    """Eq. 17 [N, Nm]."""
    served = served_rows(held, tolerance)
    knots = len(rows.layout.mesh.phase)
    for k in range(knots):
        rows.combine += [(rows.n + len(served) * k + j, rows.output(part, k, r), 1.0) for j, r in enumerate(served)]
    bound = np.full(len(served), tolerance)
    rows.close("balance", held.name, tuple(BALANCE_ROWS[r] for r in served), -bound, bound, knots)


def _velocity(rows: _Rows, part: int, who: str, labels: tuple[str, ...], limit: Array) -> None:
    """Speed by the phase, at the hull of the derivative: within it the limit holds at all times."""
    slope, control = rows.layout.mesh.slope, rows.layout.control[:, rows.layout.columns(part)]
    n = control.shape[1]
    for r, i in zip(*np.nonzero(slope), strict=True):
        rows.linear += [(rows.n + n * r + j, int(control[i, j]), slope[r, i]) for j in range(n)]
    if len(slope):
        rows.close("velocity", who, labels, -limit, limit, len(slope))


def _matrix(triplets: list[tuple[int, int, float]], shape: tuple[int, int]) -> sp.csc_matrix:
    if not triplets:
        return sp.csc_matrix(shape)
    row, col, value = zip(*triplets, strict=True)
    return sp.csc_matrix((value, (row, col)), shape=shape)
