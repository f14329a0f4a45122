"""All knots of a mesh evaluated by kernels that take several at once, and the fixed maps from there to the NLP."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from liftopt.collocation.codegen.simd_kernels import SimdKernel
from liftopt.collocation.objective import RANGE_ROWS
from liftopt.collocation.problem import Problem
from liftopt.collocation.scatter import hessian_pattern, jacobian_pattern
from liftopt.types import Array

Index = npt.NDArray[np.int64]
Buffers = Sequence[Any]
ALIGNMENT = 64
_KERNEL = ctypes.CFUNCTYPE(ctypes.c_int, *[ctypes.c_void_p] * 4, ctypes.c_int)


class Knots:
    """Values and derivatives at all knots, at the x and p last asked for, and their maps to the NLP."""

    def __init__(self, problem: Problem, simd: Sequence[SimdKernel]) -> None:
        parts, constraints, weights = [p.kernel for p in problem.parts], problem.constraints, problem.mesh.weights
        self.parts, self.weights, knots, lanes = parts, weights, len(weights), simd[0].lanes
        selects = [part.select for part in problem.parts]
        blocks = [part.jacobian.sparsity_out(0) for part in parts]
        triangles = [part.triangles for part in problem.parts]
        self.sizes = np.array([part.sizes for part in problem.parts])
        self.n_p = int(self.sizes.sum())

        at_y, at_c, at_slope, at_curvature = (
            _Interleaved.of(sizes, knots, lanes)
            for sizes in ([k.n_y for k in parts], [k.n_c for k in parts], [b.nnz() for b in blocks],
                          [t[0].nnz() for t in triangles])
        )  # fmt: skip
        self.y, self.c, self.slopes, self.curvatures = map(
            _aligned, (at_y.end, at_c.end, at_slope.end, at_curvature.end)
        )
        self.pull, self.given = _aligned(at_c.end), [_aligned(part.n_p * lanes) for part in parts]
        self.y_weight, self.sides, self.c_weight = np.zeros(at_y.end), np.zeros((2, at_c.end)), np.zeros(at_c.end)
        self.at_y = [at.reshape(knots, -1) for at in at_y.places]
        self.at_c = [at.reshape(knots, -1) for at in at_c.places]
        self.ranges = [
            _Ranges(at[:, : part.n_range], weights)
            for part, at in zip(problem.parts, self.at_y, strict=True)
            if part.n_range
        ]

        jacobian = jacobian_pattern(blocks, selects, weights, constraints.combine, constraints.linear)
        hessian = hessian_pattern(triangles, selects, weights)
        self.jacobian_shape, self.hessian_shape = jacobian.shape, hessian.shape
        self.select = sp.csr_matrix(_spread(at_y.places, at_y.end).T @ sp.vstack(selects))
        self.select_back = sp.csr_matrix(self.select.T)
        self.combine = sp.csr_matrix(constraints.combine @ _spread(at_c.places, at_c.end))
        self.combine_back = sp.csr_matrix(self.combine.T)
        self.rows = sp.csr_matrix(constraints.linear)
        self.jacobian_map = sp.csr_matrix(jacobian.scatter @ _spread(at_slope.places, at_slope.end))
        self.jacobian_constant = jacobian.offset
        # Columns of the Hessian's map: of each part the curvatures, the squares, the ranges and the diagonal.
        counts = np.array([[*(knots * t.nnz() for t in some), k.n_y] for some, k in zip(triangles, parts, strict=True)])
        kind = np.repeat(np.tile([0, 1, 2, 3], len(parts)), counts.ravel())
        maps = [hessian.scatter[:, kind == i] for i in (0, 1, 3, 2)]
        self.curvature_map = sp.csr_matrix(maps[0] @ _spread(at_curvature.places, at_curvature.end))
        self.square_map, self.diagonal_map, self.range_map = map(sp.csr_matrix, maps[1:])
        self.squares = [
            _Squares(part, slopes.reshape(knots, -1), c, y)
            for part, slopes, c, y in zip(parts, at_slope.places, self.at_c, self.at_y, strict=True)
            if part.n_squared
        ]
        self.x, self.p, self.has_slopes = np.full(self.rows.shape[1], np.nan), np.full(self.n_p, np.nan), False
        self.f_slope: Array | None = None
        self.value_calls, self.slope_calls, self.all_calls = self._calls(simd, blocks, triangles)

    def _calls(self, simd: Sequence[SimdKernel], blocks: Sequence[Any], triangles: Sequence[Any]) -> list[list[Any]]:
        """Return calls for values, for slopes, and for slopes and curvatures, each a kernel and its pointers."""
        lanes, value, slope, everything = simd[0].lanes, [], [], []
        y, c, pull, slopes, curvatures = (
            a.ctypes.data for a in (self.y, self.c, self.pull, self.slopes, self.curvatures)
        )
        for i, kernel in enumerate(simd):
            run_value, run_derivatives = _KERNEL(kernel.value), _KERNEL(kernel.derivatives)
            p, part = self.given[i].ctypes.data, self.parts[i]
            for _ in range(-(-len(self.weights) // lanes)):
                value.append((run_value, _pointers(y, p), _pointers(c)))
                slope.append((run_derivatives, _pointers(y, p, pull), _pointers(slopes, None)))
                everything.append((run_derivatives, _pointers(y, p, pull), _pointers(slopes, curvatures)))
                y, c, pull = y + 8 * lanes * part.n_y, c + 8 * lanes * part.n_c, pull + 8 * lanes * part.n_c
                slopes += 8 * lanes * blocks[i].nnz()
                curvatures += 8 * lanes * triangles[i][0].nnz()
        return [value, slope, everything]

    def values(self, given: Buffers, found: Buffers) -> None:
        """(x, p) -> f, g."""
        self._move(given[0], given[1])
        self._set_f(found[0])
        self._set_g(found[1])

    def gradient(self, given: Buffers, found: Buffers) -> None:
        """(x, p) -> f, gradient of f."""
        self._move(given[0], given[1])
        self._set_f(found[0])
        # CasADi asks twice at every iterate.
        if self.f_slope is None:
            self._need_slopes()
            by_y, pull = 2.0 * self.y_weight * self.y, 2.0 * self.c_weight * self.c
            for squares in self.squares:
                squares.add_gradient(pull, by_y)
            for term in self.ranges:
                term.add_gradient(self.y, by_y)
            self.f_slope = self.select_back @ by_y
        found[1][:] = self.f_slope

    def jacobian(self, given: Buffers, found: Buffers) -> None:
        """(x, p) -> g, nonzeros of its Jacobian."""
        self._move(given[0], given[1])
        self._set_g(found[0])
        self._need_slopes()
        np.add(self.jacobian_map @ self.slopes, self.jacobian_constant, out=found[1])

    def hessian(self, given: Buffers, found: Buffers) -> None:
        """(x, p, lam_f, lam_g) -> nonzeros of the upper triangle of the Lagrangian's Hessian."""
        x, p, sigma, lam = given
        self._move(x, p)
        self.pull[:] = self.combine_back @ lam + (2.0 * sigma[0]) * self.c_weight * self.c
        _run(self.all_calls)
        self._have_slopes()
        squares = [squares.values(2.0 * sigma[0] * self.c_weight) for squares in self.squares]
        found[0][:] = self.curvature_map @ self.curvatures + sigma[0] * self.diagonal
        if squares:
            found[0][:] += self.square_map @ np.concatenate(squares)
        if self.ranges:
            bent = np.concatenate([term.curvatures(self.y) for term in self.ranges])
            found[0][:] += self.range_map @ (sigma[0] * bent)

    def _set_f(self, f: Array | None) -> None:
        if f is not None:
            f[0] = (self.c_weight * self.c) @ self.c + (self.y_weight * self.y) @ self.y
            for term in self.ranges:
                f[0] += term.value(self.y)

    def _set_g(self, g: Array | None) -> None:
        if g is not None:
            np.add(self.combine @ self.c, self.rows @ self.x, out=g)

    def _move(self, x: Array, p: Array) -> None:
        """Evaluate the kernels' values at x and p unless they are there."""
        if not np.array_equal(p, self.p):
            self._set_parameters(p)
        elif np.array_equal(x, self.x):
            return
        self.x[:] = x
        self.y[:] = self.select @ x
        _run(self.value_calls)
        self.c_weight[:] = np.where(self.c > 0.0, *self.sides)
        self.has_slopes, self.f_slope = False, None

    def _need_slopes(self) -> None:
        if not self.has_slopes:
            _run(self.slope_calls)
            self._have_slopes()

    def _have_slopes(self) -> None:
        if not self.has_slopes:
            for squares in self.squares:
                squares.fill(self.slopes)
            self.has_slopes = True

    def _set_parameters(self, p: Array) -> None:
        self.p[:] = p  # CasADi writes over its own
        pieces, each = np.split(self.p, np.cumsum(self.sizes)[:-1]), self.sizes.shape[1]
        ranges = iter(self.ranges)
        for i, part in enumerate(self.parts):
            kernel, above, below, y_weight, own_range = pieces[each * i : each * (i + 1)]
            self.given[i].reshape(part.n_p, -1)[:] = kernel[:, None]
            for side, c_weight in zip(self.sides, (above, below), strict=True):
                side[self.at_c[i][:, : part.n_squared]] = self.weights[:, None] * c_weight
            self.y_weight[self.at_y[i]] = self.weights[:, None] * y_weight
            if own_range.size:
                next(ranges).set_parameters(own_range)
        self.diagonal = self.diagonal_map @ (2.0 * np.concatenate(pieces[3::each]))


@dataclass(frozen=True)
class _Interleaved:
    """Where SIMD kernels keep entries: of each part (K n,), that of entry j of knot k at ``k n + j``, and the end."""

    places: list[Index]
    end: int

    @staticmethod
    def of(sizes: Sequence[int], knots: int, lanes: int) -> _Interleaved:
        """Place ``sizes`` entries a knot, part after part, in groups of ``lanes`` knots."""
        end, places = 0, []
        for n in sizes:
            knot, entry = np.divmod(np.arange(knots * n), max(1, n))
            places.append(end + (knot // lanes * n + entry) * lanes + knot % lanes)
            end += -(-knots // lanes) * lanes * n
        return _Interleaved(places, end)


class _Squares:
    """The squared leading outputs of one part: their share of the gradient, and ``dc/dy^T diag(d) dc/dy``."""

    def __init__(self, part: Any, slopes: Index, outputs: Index, variables: Index) -> None:
        row, column = (np.asarray(i) for i in part.jacobian.sparsity_out(0).get_triplet())
        leading = row < part.n_squared
        self.at, self.row, self.column = slopes[:, leading], row[leading], column[leading]
        self.outputs, self.variables = outputs[:, : part.n_squared], variables
        self.triangle = tuple(np.asarray(i) for i in part.squares.sparsity_out(0).get_triplet())
        self.matrix = np.zeros((len(slopes), part.n_squared, part.n_y))

    def fill(self, slopes: Array) -> None:
        """Take the slopes of all outputs; what follows is about these."""
        self.matrix[:, self.row, self.column] = slopes[self.at]

    def add_gradient(self, pull: Array, by_y: Array) -> None:
        """Add ``dc/dy^T pull`` at every knot."""
        by_y[self.variables] += (pull[self.outputs][:, None, :] @ self.matrix)[:, 0, :]

    def values(self, d: Array) -> Array:
        """Return the nonzeros of the upper triangle, knot by knot."""
        weighted = self.matrix * d[self.outputs][:, :, None]
        whole = self.matrix.transpose(0, 2, 1) @ weighted
        return np.ravel(whole[:, self.triangle[0], self.triangle[1]])


class _Ranges:
    """What the ranges of one part's leading knot variables cost at all knots, by distances from neutral."""

    def __init__(self, at: Index, weights: Array) -> None:
        self.at, self.weights = at, weights[:, None]
        self.neutral = self.square = self.fourth = np.zeros(0)

    def set_parameters(self, rows: Array) -> None:
        """Take the rows of ``objective.Weights.range``."""
        self.neutral, *factors = rows.reshape(RANGE_ROWS, -1)
        self.square, self.fourth = np.stack(factors[:2]), np.stack(factors[2:])

    def _away(self, y: Array) -> tuple[Array, Array, Array]:
        away = y[self.at] - self.neutral
        square, fourth = (np.where(away > 0.0, above, below) for below, above in (self.square, self.fourth))
        return away, self.weights * square, self.weights * fourth

    def value(self, y: Array) -> float:
        """Return what they cost together."""
        away, square, fourth = self._away(y)
        return float(((square + fourth * away**2) * away**2).sum())

    def add_gradient(self, y: Array, by_y: Array) -> None:
        """Add the derivatives by the knot variables."""
        away, square, fourth = self._away(y)
        by_y[self.at] += (2.0 * square + 4.0 * fourth * away**2) * away

    def curvatures(self, y: Array) -> Array:
        """Return the second derivatives, knot by knot."""
        away, square, fourth = self._away(y)
        return np.ravel(2.0 * square + 12.0 * fourth * away**2)


def _run(calls: Sequence[Any]) -> None:
    for kernel, arguments, results in calls:
        kernel(arguments, results, None, None, 0)


def _pointers(*addresses: int | None) -> Any:
    return (ctypes.c_void_p * len(addresses))(*addresses)


def _aligned(size: int) -> Array:
    """Return zeros that begin where the kernels' vectors may."""
    room = np.zeros(size + ALIGNMENT // 8)
    first = -room.ctypes.data % ALIGNMENT // 8
    return room[first : first + size]


def _spread(places: Sequence[Index], end: int) -> sp.csr_matrix:
    """Return the matrix (n, end) that picks entries knot by knot from where SIMD kernels keep them."""
    at = np.concatenate(places)
    return sp.csr_matrix((np.ones(len(at)), at, np.arange(len(at) + 1)), shape=(len(at), end))
