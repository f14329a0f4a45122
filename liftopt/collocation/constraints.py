"""The constraints by name: rows ``g = G C + A x``, their bounds, and what each row means.

Numbers in brackets are the paper's constraints. Some need no row: the spline satisfies them by construction (3: locked
bases, 9: rest at both ends), or they are bounds on unknowns (1: joint limits, 5: range of motion of the object,
8: poses at the ends).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from liftopt.collocation.flat_hand import flat_hand_rows
from liftopt.collocation.layout import OBJECT_SIZE, Layout
from liftopt.collocation.outputs import AgentOutputs, outputs_of
from liftopt.collocation.pose_kernels import POSE_SIZE
from liftopt.collocation.push import PUSH
from liftopt.collocation.separating_planes import SeparatingPlanes
from liftopt.collocation.soles import resting, sole_rows, weight_of
from liftopt.collocation.task import OBJECT_COORDINATES, LiftTask
from liftopt.multibody.agent import Agent, Grasp, LiftedObject
from liftopt.types import Array

Index = npt.NDArray[np.int64]
BALANCE_ROWS = ("force x", "force y", "force z", "moment x", "moment y", "moment z")


@dataclass(frozen=True)
class Block:
    """Rows of one constraint of one agent or the object.

    Attributes:
        name: ``"grasp_closure"`` (6), ``"torque"`` (2), ``"workspace"`` (4), ``"grasp_force"``, ``"grasp_moment"``,
            ``"grasp_turn"``, ``"friction"``, ``"pressure"``, ``"sole_friction"``, ``"sole_pressure"``, ``"lean"``,
            ``"compression"``, ``"balance"`` (7), ``"velocity"``, ``"clearance"``.
        who: agent, grasp or object; of clearance, the two bodies by number.
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
    """Triplets of G and A while they grow, and the blocks that are done."""

    layout: Layout
    outputs: tuple[int, ...]
    n: int = 0
    combine: list[tuple[Index, Index, Array]] = field(default_factory=list)
    linear: list[tuple[Index, Index, Array]] = field(default_factory=list)
    blocks: list[Block] = field(default_factory=list)

    @property
    def knots(self) -> Index:
        """All knots."""
        return np.arange(len(self.layout.mesh.phase))

    def outputs_at(self, part: int, knots: Index, which: Index | slice) -> Index:
        """Return the positions (knots, which) in C of some outputs of a part."""
        if isinstance(which, slice):
            which = np.arange(which.start, which.stop)
        first = len(self.layout.mesh.phase) * sum(self.outputs[:part])
        return first + self.outputs[part] * knots[:, None] + which

    def add(self, outputs: Index, factors: Array | float) -> None:
        """Add outputs (knots, m), times factors, to the next rows: m a knot."""
        rows = self.n + np.arange(outputs.size)
        self.combine.append((rows, outputs.ravel(), np.broadcast_to(factors, outputs.shape).ravel()))

    def close(self, name: str, who: str, labels: tuple[str, ...], lower: Array, upper: Array, repeats: int) -> None:
        """End a block of ``repeats`` knots whose rows have the same bounds at each."""
        first, self.n = self.n, self.n + len(labels) * repeats
        bounds = (np.tile(np.asarray(b, dtype=float), repeats) for b in (lower, upper))
        self.blocks.append(Block(name, who, slice(first, self.n), labels, *bounds))


@dataclass(frozen=True, eq=False)
class VariedRow:
    """A row of every knot whose factors differ from knot to knot; they may change between solves.

    Attributes:
        terms: (part, output) of each term.
        rows: (K,) which of g.
        factors: (terms, K).
    """

    terms: tuple[tuple[int, int], ...]
    rows: Index
    factors: Array


@dataclass(frozen=True)
class Constraints:
    """All rows: ``g = combine @ C + linear @ x`` with the named blocks in order.

    Attributes:
        blocks: the rows by name.
        combine, linear: their factors.
        varied: those rows of ``combine`` that have other factors at every knot.
    """

    blocks: tuple[Block, ...]
    combine: sp.csc_matrix
    linear: sp.csc_matrix
    varied: tuple[VariedRow, ...] = ()

    def same_rows(self, other: Constraints) -> bool:
        """Whether the rows are the same functions, scales included, so that only bounds and parameters may differ."""
        return self is other or (_same(self.combine, other.combine) and _same(self.linear, other.linear))

    def same_but_factors(self, other: Constraints) -> bool:
        """Whether the rows differ at most in the factors of ``varied``."""
        if not self.varied:
            return self.same_rows(other)
        structure = ([(row.terms, row.rows.tolist()) for row in constraints.varied] for constraints in (self, other))
        return next(structure) == next(structure) and (
            _same(self.fixed, other.fixed) and _same(self.linear, other.linear)
        )

    @cached_property
    def fixed(self) -> sp.csr_matrix:
        """``combine`` without the rows of ``varied``, which are empty here."""
        matrix = sp.csr_matrix(self.combine, copy=True)
        for row in self.varied:
            for r in row.rows:
                matrix.data[matrix.indptr[r] : matrix.indptr[r + 1]] = 0.0
        matrix.eliminate_zeros()
        return matrix

    @property
    def lower(self) -> Array:
        """Lower bounds (n_g,)."""
        return np.concatenate([block.lower for block in self.blocks])

    @property
    def upper(self) -> Array:
        """Upper bounds (n_g,)."""
        return np.concatenate([block.upper for block in self.blocks])


def build_constraints(
    agents: tuple[Agent, ...],
    lifted: LiftedObject,
    task: LiftTask,
    layout: Layout,
    outputs: tuple[int, ...],
    planes: SeparatingPlanes | None = None,
) -> Constraints:
    """Build the rows for agents that hold one object.

    Args:
        agents: their grasps in the order of the object's grasp frames.
        lifted: the object.
        task: limits and tolerances.
        layout: of the unknowns.
        outputs: number of kernel outputs a knot, of each agent, of the object and then of the parts of ``planes``.
        planes: what keeps bodies apart; None: nothing does.
    """
    rows = _Rows(layout, outputs)
    for i, agent in enumerate(agents):
        own = outputs_of(agent)
        for g, grasp in zip(layout.grasps_of(i), agent.grasps, strict=True):
            _closure(rows, i, own, g, grasp)
        _torque(rows, i, own, agent)
        for grasp in agent.grasps:
            _workspace(rows, i, own, agent, grasp)
        for grasp in agent.grasps:
            _grasp_force(rows, i, own, grasp, task.max_grasp_force)
            if grasp.moments:
                _moment(rows, i, own, grasp)
            _flat_hand(rows, i, own, grasp)
        _soles(rows, i, own, agent)
        _lean(rows, i, own, agent)
        _compression(rows, i, own, agent)
        _velocity(rows, i, agent.name, agent.moving_joints, agent.limits.velocity * task.duration)
    _balance(rows, len(agents), lifted, served_rows(agents, lifted, task.balance_tolerance), task.balance_tolerance)
    _velocity(rows, len(agents), lifted.name, OBJECT_COORDINATES, task.pose_velocity * task.duration)
    varied = _clearance(rows, len(agents) + 1, planes) if planes else ()
    n_c = len(layout.mesh.phase) * sum(outputs)
    return Constraints(
        tuple(rows.blocks),
        _matrix(rows.combine, (rows.n, n_c)),
        _matrix(rows.linear, (rows.n, layout.n_x)),
        varied,
    )


def _closure(rows: _Rows, i: int, own: AgentOutputs, g: int, grasp: Grasp) -> None:
    """Eq. 16: the agent's grasp point is the object's, p_world_grasp - p_world_edge = 0 [m]."""
    knots = rows.layout.mesh.closure_knots
    rows.add(rows.outputs_at(i, knots, own.position(grasp.frame)), 1.0)
    rows.add(rows.outputs_at(rows.layout.n_agents, knots, OBJECT_SIZE + 3 * g + np.arange(3)), -1.0)
    rows.close("grasp_closure", grasp.name, ("x", "y", "z"), np.zeros(3), np.zeros(3), len(knots))


def _torque(rows: _Rows, i: int, own: AgentOutputs, agent: Agent) -> None:
    """Eq. 12: torques as shares of the larger of their directional limits."""
    limits = agent.limits
    scale = np.maximum(np.abs(limits.tau_lower), np.abs(limits.tau_upper))
    rows.add(rows.outputs_at(i, rows.knots, own.tau), 1.0 / scale)
    lower, upper = limits.tau_lower / scale, limits.tau_upper / scale
    rows.close("torque", agent.name, agent.moving_joints, lower, upper, len(rows.knots))


def _workspace(rows: _Rows, i: int, own: AgentOutputs, agent: Agent, grasp: Grasp) -> None:
    """Eq. 14: the grasp point stays in its half-space [m]."""
    if agent.workspace is None:
        return
    first = own.position(grasp.frame).start
    for axis in np.flatnonzero(agent.workspace.normal):
        rows.add(rows.outputs_at(i, rows.knots, np.array([first + axis])), float(agent.workspace.normal[axis]))
    offset, above = np.array([agent.workspace.offset]), np.array([np.inf])
    rows.close("workspace", grasp.name, ("distance",), offset, above, len(rows.knots))


def _grasp_force(rows: _Rows, i: int, own: AgentOutputs, grasp: Grasp, cap: float) -> None:
    """The norm of the grasp force, squared, as a share of its cap squared: the squeeze is free otherwise."""
    rows.add(rows.outputs_at(i, rows.knots, own.force_squared(grasp.frame)), 1.0 / cap**2)
    rows.close("grasp_force", grasp.name, ("norm",), np.array([-np.inf]), np.ones(1), len(rows.knots))


def _moment(rows: _Rows, i: int, own: AgentOutputs, grasp: Grasp) -> None:
    """The norm of the moment, squared, as a share of its cap squared, and the hand's angle on the object by its cosine.

    Around a bar it is half of the cosine, less a half. The cosine's slope vanishes with the angle, so an angle of zero
    cannot be asked for.
    """
    rows.add(rows.outputs_at(i, rows.knots, own.moment_squared(grasp.frame)), 1.0 / grasp.max_moment**2)
    rows.close("grasp_moment", grasp.name, ("norm",), np.array([-np.inf]), np.ones(1), len(rows.knots))
    rows.add(rows.outputs_at(i, rows.knots, own.cosine(grasp.frame)), 1.0)
    bounds = np.array([grasp.least_cosine]), np.array([np.inf])
    rows.close("grasp_turn", grasp.name, ("cosine",), *bounds, len(rows.knots))


def _flat_hand(rows: _Rows, i: int, own: AgentOutputs, grasp: Grasp) -> None:
    """A flat hand pushes and neither slides nor tips [N, Nm]."""
    for flat in flat_hand_rows(grasp):
        first, m = own.wrench(grasp.frame).start, len(flat.labels)
        rows.add(rows.outputs_at(i, rows.knots, first + flat.components), flat.signs)
        rows.add(rows.outputs_at(i, rows.knots, np.full(m, first + PUSH)), flat.shares)
        rows.close(flat.name, grasp.name, flat.labels, np.zeros(m), np.full(m, np.inf), len(rows.knots))


def _lean(rows: _Rows, i: int, own: AgentOutputs, agent: Agent) -> None:
    """The trunk leans no farther than it may, by 1 - cos of its angle."""
    if agent.lean is not None:
        rows.add(rows.outputs_at(i, rows.knots, own.lean), 1.0)
        most = np.array([1.0 - np.cos(agent.lean.most)])
        rows.close("lean", agent.name, ("trunk",), np.array([-np.inf]), most, len(rows.knots))


def _compression(rows: _Rows, i: int, own: AgentOutputs, agent: Agent) -> None:
    """The disc is pressed with no more than it may, whichever muscles pull; its limit is a bound and no factor."""
    if agent.disc is None:
        return
    factors, m = agent.disc.factors / agent.disc.unit, len(agent.disc.muscles)
    for output, own_factors in zip(range(own.disc.start, own.disc.stop), factors.T, strict=True):
        rows.add(rows.outputs_at(i, rows.knots, np.full(m, output)), own_factors)
    most = np.full(m, agent.disc.most / agent.disc.unit)
    rows.close("compression", agent.name, agent.disc.muscles, np.full(m, -np.inf), most, len(rows.knots))


def _soles(rows: _Rows, i: int, own: AgentOutputs, agent: Agent) -> None:
    """Both feet stay on the floor: rows by the body's weight, a share of it [1] and the centre of pressure then [m]."""
    if agent.stance is None:
        return
    first, weight, feet = own.ground.start, weight_of(agent), resting(agent.stance)
    for sole in sole_rows(agent.stance):
        m = len(sole.labels)
        rows.add(rows.outputs_at(i, rows.knots, first + sole.components), sole.signs / weight)
        rows.add(rows.outputs_at(i, rows.knots, np.full(m, first + PUSH)), sole.shares / weight)
        # The kernel has what moves; the feet add to it what never changes.
        lower = -sole.room(feet)[0] / weight
        rows.close(sole.name, agent.name, sole.labels, lower, np.full(m, np.inf), len(rows.knots))


def served_rows(agents: tuple[Agent, ...], lifted: LiftedObject, tolerance: float) -> list[int]:
    """Return the rows of the balance to ask for: all six with a tolerance, as in the paper, else those served."""
    moments = any(grasp.moments for agent in agents for grasp in agent.grasps)
    unserved = None if moments else lifted.unserved_row()
    return [r for r in range(OBJECT_SIZE) if tolerance > 0 or r != unserved]


def _balance(rows: _Rows, part: int, lifted: LiftedObject, served: list[int], tolerance: float) -> None:
    """Eq. 17 [N, Nm]."""
    rows.add(rows.outputs_at(part, rows.knots, np.array(served)), 1.0)
    bound = np.full(len(served), tolerance)
    rows.close("balance", lifted.name, tuple(BALANCE_ROWS[r] for r in served), -bound, bound, len(rows.knots))


def _velocity(rows: _Rows, part: int, who: str, labels: tuple[str, ...], limit: Array) -> None:
    """Speed by the phase, at the hull of the derivative: within it the limit holds at all times."""
    slope, control = rows.layout.mesh.slope, rows.layout.control[:, rows.layout.columns(part)]
    n, (r, i) = control.shape[1], np.nonzero(slope)
    row = rows.n + n * r[:, None] + np.arange(n)
    rows.linear.append((row.ravel(), control[i].ravel(), np.repeat(slope[r, i], n)))
    if len(slope):
        rows.close("velocity", who, labels, -limit, limit, len(slope))


def _clearance(rows: _Rows, first_part: int, planes: SeparatingPlanes) -> tuple[VariedRow, ...]:
    """Points of two bodies stay on both sides of a plane, each row at every knot [m]."""
    knots, found, axes = rows.knots, [], np.arange(POSE_SIZE)
    for separation in planes.separations:
        m, terms = separation.rows, []
        at = rows.n + m * knots[:, None] + np.arange(m)
        for body, factors in separation.factors:
            part, first = planes.output(body)
            part += first_part
            outputs = rows.outputs_at(part, knots, first + axes)[:, None].repeat(m, axis=1)
            rows.combine.append((at.repeat(POSE_SIZE), outputs.ravel(), factors.ravel()))
            terms.append(([(part, first + axis) for axis in range(POSE_SIZE)], factors))
        places = tuple(place for own, _ in terms for place in own)
        both = np.concatenate([factors for _, factors in terms], axis=2)
        found += [VariedRow(places, at[:, j], both[:, j].T) for j in range(m)]
        labels = tuple(f"row {j + 1}" for j in range(m))
        who = f"{separation.one} and {separation.other}"
        first_row, rows.n = rows.n, rows.n + at.size
        lower = separation.lower.ravel()
        rows.blocks.append(Block("clearance", who, slice(first_row, rows.n), labels, lower, np.full(at.size, np.inf)))
    return tuple(found)


def _matrix(triplets: list[tuple[Index, Index, Array]], shape: tuple[int, int]) -> sp.csc_matrix:
    row, col, value = (np.concatenate(part) for part in zip(*triplets, strict=True))
    return sp.csc_matrix((value, (row, col)), shape=shape)


def _same(one: sp.csc_matrix, other: sp.csc_matrix) -> bool:
    """Whether two matrices that were built alike are equal, entry by entry as they are stored."""
    parts = ((one.indptr, other.indptr), (one.indices, other.indices), (one.data, other.data))
    return one.shape == other.shape and all(np.array_equal(a, b) for a, b in parts)
