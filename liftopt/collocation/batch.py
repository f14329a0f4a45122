"""A problem at many vectors of unknowns at once: the kernels called on plain arrays, without CasADi's containers.

For what must be cheap and needs no solver: inverse kinematics from many seeds, and the ranking of starts.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from liftopt.collocation.problem import Problem
from liftopt.collocation.scatter import Pattern, jacobian_pattern
from liftopt.types import Array

# Knots a call: enough to hide what a call costs, few enough that the last one wastes little.
CHUNK = 16


class Batch:
    """The objective of a problem, chosen rows of its constraints and their slopes, at many vectors of unknowns."""

    def __init__(self, problem: Problem, rows: npt.NDArray[np.int64] | None = None) -> None:
        """Bind a problem; ``rows`` are the rows of g wanted, None: all."""
        self.problem = problem
        wanted = slice(None) if rows is None else rows
        constraints = problem.constraints
        self._combine, self._linear = (sp.csr_matrix(m)[wanted] for m in (constraints.combine, constraints.linear))
        self._selects = [sp.csr_matrix(part.select) for part in problem.parts]
        period = [problem.task.duration]
        self._parameters = [np.concatenate([period, topology.parameters]) for topology in problem.topologies]
        self._values = [_Mapped(part.kernel.value) for part in problem.parts]
        self._slopes = [_Mapped(part.kernel.jacobian) for part in problem.parts]

    def objective(self, x: Array) -> Array:
        """Return the objective (B,) at unknowns ``x`` (B, n_x)."""
        return np.asarray(self.terms(x).sum(axis=0))

    def terms(self, x: Array) -> Array:
        """Return what each agent, and then the object, adds to the objective (parts, B) at unknowns ``x`` (B, n_x)."""
        weights, terms = self.problem.mesh.weights, []
        for i, (y, c) in enumerate(zip(self._knots(x), self._outputs(x), strict=True)):
            own = self.problem.weights(i)
            outputs = c[:, : len(own.above)]
            # Not by a library of linear algebra, which rounds as the processor has it: starts are ranked by this.
            squares = np.einsum("ij,ij->i", outputs**2, own.of_outputs(outputs))
            squares = squares + np.einsum("ij,j->i", y**2, own.variable) + np.einsum("ij->i", own.range_cost(y))
            terms.append(np.einsum("ij,j->i", squares.reshape(len(x), -1), weights))
        return np.array(terms)

    def rows(self, x: Array) -> Array:
        """Return the rows of g (B, n_rows) at unknowns ``x`` (B, n_x)."""
        outputs = np.hstack([c.reshape(len(x), -1) for c in self._outputs(x)])
        return np.asarray((self._combine @ outputs.T + self._linear @ x.T).T)

    def slopes(self, x: Array) -> Array:
        """Return the Jacobian of the rows, dense (B, n_rows, n_x), at unknowns ``x`` (B, n_x)."""
        pattern, knots = self._pattern, self._knots(x)
        found = [slope(y, p) for slope, y, p in zip(self._slopes, knots, self._parameters, strict=True)]
        nonzeros = np.hstack([values.reshape(len(x), -1) for values in found])
        columns = np.repeat(np.arange(pattern.shape.shape[1]), np.diff(pattern.shape.indptr))
        dense = np.zeros((len(x), *pattern.shape.shape))
        dense[:, pattern.shape.indices, columns] = (pattern.scatter @ nonzeros.T).T + pattern.offset
        return dense

    def _knots(self, x: Array) -> list[Array]:
        """Return the knot variables (B K, n_y) of each part."""
        knots = len(x) * len(self.problem.mesh.weights)
        return [np.ascontiguousarray((select @ x.T).T).reshape(knots, -1) for select in self._selects]

    def _outputs(self, x: Array) -> list[Array]:
        """Return the outputs (B K, n_c) of each part."""
        return [f(y, p) for f, y, p in zip(self._values, self._knots(x), self._parameters, strict=True)]

    @cached_property
    def _pattern(self) -> Pattern:
        parts = self.problem.parts
        blocks, selects = [p.kernel.jacobian.sparsity_out(0) for p in parts], [p.select for p in parts]
        combine, linear = sp.csc_matrix(self._combine), sp.csc_matrix(self._linear)
        return jacobian_pattern(blocks, selects, self.problem.mesh.weights, combine, linear)


class _Mapped:
    """A knot function (y, p) -> nonzeros, on rows of knot variables."""

    def __init__(self, function: Any) -> None:
        # CasADi reads and writes these arrays in place.
        self._y, self._p = np.zeros((CHUNK, function.size1_in(0))), np.zeros(function.size1_in(1))
        self._out = np.zeros((CHUNK, function.nnz_out(0)))
        self._buffer, self._call = function.map("mapped", "serial", CHUNK, [1], []).buffer()
        self._buffer.set_arg(0, self._y.data)
        self._buffer.set_arg(1, self._p.data)
        self._buffer.set_res(0, self._out.data)

    def __call__(self, y: Array, p: Array) -> Array:
        """Return the nonzeros (rows, nnz) at knot variables (rows, n_y)."""
        self._p[:] = p
        out = np.empty((len(y), self._out.shape[1]))
        for first in range(0, len(y), CHUNK):
            some = y[first : first + CHUNK]
            self._y[: len(some)] = some
            self._call()
            out[first : first + CHUNK] = self._out[: len(some)]
        return out
