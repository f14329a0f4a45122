"""Uniform clamped cubic B-splines at rest at both ends: basis, mesh, quadrature and the sampling of a trajectory.

The motion of every coordinate is ``q(s) = sum_i B_i(s) c_i`` over the phase ``s = t / T`` in [0, 1] on N equal
intervals, N + 3 control points. Zero velocity at both ends makes the first two control points equal, and the last two;
zero acceleration as well (eq. 19) makes it three. N + 1 or N - 1 free ones remain, so rest at the ends holds by
construction. In continuous time zero acceleration asks for nothing, for an acceleration may jump; on a mesh it costs a
ramp of one interval, and the objective converges at first order instead of second.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from liftopt.types import Array

DEGREE = 3
# Intervals of a mesh.
FEWEST, FINEST = 6, 400
# What is zero at both ends, and how many control points are equal there.
TIED = {"velocity": 2, "acceleration": 3}


@dataclass(frozen=True)
class Mesh:
    """Where the unknowns act and where the equations hold: what a transcription needs of a space of motions.

    Attributes:
        phase: (K,) phases of the knots.
        weights: (K,) quadrature weights.
        basis: value, first and second derivative by the phase at the knots, (K, n_free) each.
        control_phase: (n_free,) where each control point acts most.
        closure_knots: knots at which loop closure is collocated.
        slope: (m, n_free) map to the hull of the derivative by the phase.
    """

    phase: Array
    weights: Array
    basis: tuple[Array, Array, Array]
    control_phase: Array
    closure_knots: npt.NDArray[np.int64]
    slope: Array

    @property
    def slope_phase(self) -> Array:
        """Phases (m,) at which each row of ``slope`` acts most: midway between its two control points."""
        return np.asarray((self.control_phase[1:] + self.control_phase[:-1]) / 2)

    @staticmethod
    def at_rest() -> Mesh:
        """Return the mesh of one posture at rest: one knot, one control point, no motion."""
        one, none = np.ones((1, 1)), np.zeros((1, 1))
        return Mesh(np.zeros(1), np.ones(1), (one, none, none), np.zeros(1), np.zeros(1, np.int64), np.zeros((0, 1)))


@dataclass(frozen=True)
class RestToRestSpline:
    """The spline space on ``intervals`` (N) uniform intervals, with its free control points.

    Attributes:
        intervals: N, at least 6 so that the two resting ends do not share control points.
        rest: what is zero at both ends: ``"velocity"`` alone, or ``"acceleration"`` as well.
    """

    intervals: int
    rest: str = "velocity"

    def __post_init__(self) -> None:
        if self.intervals < FEWEST:
            raise ValueError(f"a motion from rest to rest needs at least {FEWEST} intervals, not {self.intervals}")
        if self.rest not in TIED:
            raise ValueError(f"at rest is {' or '.join(TIED)}, not {self.rest}")

    def on(self, intervals: int) -> RestToRestSpline:
        """Return the space of the same kind on another number of intervals."""
        return replace(self, intervals=intervals)

    @property
    def order(self) -> int:
        """Order in the step at which the objective converges: 2, or 1 where zero acceleration takes a ramp."""
        return 2 if self.rest == "velocity" else 1

    @property
    def n_knots(self) -> int:
        """Number of collocation knots, N + 1."""
        return self.intervals + 1

    @property
    def n_free(self) -> int:
        """Number of free control points a coordinate: N + 1, or N - 1 with zero acceleration at the ends."""
        return self.intervals + DEGREE - 2 * self._bound

    @property
    def phase(self) -> Array:
        """Phases of the knots, (N + 1,), from 0 to 1."""
        return np.linspace(0.0, 1.0, self.n_knots)

    @property
    def quadrature(self) -> Array:
        """Trapezoid weights over the phase, (N + 1,); they sum to 1."""
        weights = np.full(self.n_knots, 1.0 / self.intervals)
        weights[[0, -1]] /= 2
        return weights

    @property
    def closure_knots(self) -> npt.NDArray[np.int64]:
        """Knots at which loop closure is collocated: as many as there are free control points.

        With zero velocity at the ends these are all. Zero acceleration leaves two control points fewer, and closure at
        all knots is over-determined; without knots 1 and N - 1 it is square and well conditioned.
        """
        knots = np.arange(self.n_knots)
        return knots if self.n_free == self.n_knots else np.delete(knots, [1, self.n_knots - 2])

    @cached_property
    def greville(self) -> Array:
        """Phases (n_free,) at which each free control point acts most; the first is 0, the last 1."""
        abscissae = np.array([self._knot_vector[i + 1 : i + 1 + DEGREE].mean() for i in range(self.intervals + 3)])
        phases = abscissae[self._bound : -self._bound].copy()
        phases[0], phases[-1] = 0.0, 1.0
        return phases

    def basis(self, phase: Array, derivative: int = 0) -> Array:
        """Return the (len(phase), n_free) values of the free basis functions, or of a derivative by the phase."""
        values = _basis(self._knot_vector, DEGREE, derivative, np.asarray(phase, dtype=float)) @ self._tied
        # Exact zeros outside the support keep the sparsity of what is built on it.
        values[np.abs(values) < 1e-13 * max(1.0, float(np.abs(values).max()))] = 0.0
        return values

    @cached_property
    def slope(self) -> Array:
        """Return the (n_free - 1, n_free) map to the control points of the derivative by the phase.

        The derivative is a quadratic spline inside the hull of these, so bounding them bounds the speed at all times.
        """
        n = self.intervals + 3
        difference = np.zeros((n - 1, n))
        for i in range(n - 1):
            width = self._knot_vector[i + 4] - self._knot_vector[i + 1]
            difference[i, i : i + 2] = np.array([-1.0, 1.0]) * DEGREE / width
        return (difference @ self._tied)[self._bound : -self._bound]

    def mesh(self) -> Mesh:
        """Return the collocation mesh of this space."""
        basis = (self.basis(self.phase), self.basis(self.phase, 1), self.basis(self.phase, 2))
        return Mesh(self.phase, self.quadrature, basis, self.greville, self.closure_knots, self.slope)

    @cached_property
    def _knot_vector(self) -> Array:
        inner = np.linspace(0.0, 1.0, self.n_knots)
        return np.concatenate([np.zeros(DEGREE), inner, np.ones(DEGREE)])

    @property
    def _bound(self) -> int:
        """Control points at each end that are the same as their neighbour nearer to the middle."""
        return TIED[self.rest] - 1

    @cached_property
    def _tied(self) -> Array:
        """(N + 3, n_free): the first control points are one, and the last."""
        n, free = self.intervals + 3, self.n_free
        tied = np.zeros((n, free))
        tied[np.arange(n), np.clip(np.arange(n) - self._bound, 0, free - 1)] = 1.0
        return tied


def _basis(knots: Array, degree: int, derivative: int, phase: Array) -> Array:
    """Return the B-spline basis of a knot vector, or a derivative, at ``phase`` (n,): (n, len(knots) - degree - 1).

    The recursions of Cox and de Boor, for the value and for the derivative (de Boor, A Practical Guide to Splines,
    chapter X). SciPy's BSpline has the same, but its import takes longer than a solve.
    """
    if degree == 0:
        last = np.flatnonzero(np.diff(knots))[-1]
        inside = np.clip(np.searchsorted(knots, phase, side="right") - 1, 0, last)
        return np.asarray(inside[:, None] == np.arange(len(knots) - 1), dtype=float)
    lower = _basis(knots, degree - 1, max(0, derivative - 1), phase)
    width = knots[degree:] - knots[:-degree]
    # A basis function on an empty interval is zero, and so is what it contributes.
    inverse = np.divide(1.0, width, out=np.zeros_like(width), where=width > 0.0)
    if derivative:
        left, right = degree * inverse, -degree * inverse
    else:
        left, right = (phase[:, None] - knots[:-degree]) * inverse, (knots[degree:] - phase[:, None]) * inverse
    rising, falling = lower * left, lower * right
    return np.asarray(rising[:, :-1] + falling[:, 1:])


def interpolate_linear(values: Array, phase: Array) -> Array:
    """Return rows of ``values`` (K, m), given at K uniform phases, linear between them, at ``phase`` (n,)."""
    nodes = np.linspace(0.0, 1.0, len(values))
    return np.stack([np.interp(phase, nodes, column) for column in values.T], axis=1)
