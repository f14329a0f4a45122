"""A lift as the extension ``_liftopt_banded`` takes it: from wide kernels, or through Python without them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from liftopt.collocation.assembly import Nlp
from liftopt.collocation.dynamics import agent_functions, object_functions
from liftopt.collocation.kernels import Say
from liftopt.collocation.lanes import WideKernel, load_wide
from liftopt.collocation.problem import Problem
from liftopt.collocation.scatter import Pattern, hessian_pattern, jacobian_pattern
from liftopt.errors import SolverError

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.int64]


def wide_kernels(problem: Problem, say: Say | None = None) -> list[WideKernel] | None:
    """Return the kernels of a problem's parts for several knots at once, or None where they cannot be made."""
    team = problem.team
    builders = [agent_functions] * len(team.agents) + [object_functions]
    return load_wide(list(zip(builders, team.topologies, strict=True)), say)


def kernel_nlp(module: Any, problem: Problem, kernels: list[WideKernel]) -> Any:
    """Return the problem as the wide kernels evaluate it."""
    parts, constraints, weights = [p.kernel for p in problem.parts], problem.constraints, problem.mesh.weights
    selects, blocks = [p.select for p in problem.parts], [kernel.jacobian.sparsity_out(0) for kernel in parts]
    triangles = [kernel.curvature.sparsity_out(0) for kernel in parts]
    jacobian = jacobian_pattern(blocks, selects, weights, constraints.combine, constraints.linear)
    hessian = hessian_pattern([[triangle] for triangle in triangles], selects, weights)
    lanes, knots = kernels[0].lanes, len(weights)
    outputs, slopes, curvatures = (
        interleaved(sizes, knots, lanes)
        for sizes in ([k.n_c for k in parts], [b.nnz() for b in blocks], [t.nnz() for t in triangles])
    )
    # The pattern has each part's diagonal after its curvatures, the extension all diagonals after all curvatures.
    order, end = [], curvatures.end
    for kernel, place in zip(parts, curvatures.places, strict=True):
        order += [place, end + np.arange(kernel.n_y)]
        end += kernel.n_y
    jacobian_rows, jacobian_map = _by_rows(jacobian)
    hessian_rows, hessian_map = _by_rows(hessian)
    return module.KernelNlp(
        lanes=lanes,
        parts=[_part(problem, i, kernels[i], outputs) for i in range(len(parts))],
        weights=weights,
        combine=_arrays(_move_columns(constraints.combine, np.concatenate(outputs.places), outputs.end)),
        linear=_arrays(constraints.linear),
        jacobian=jacobian_rows,
        jacobian_scatter=_arrays(_move_columns(jacobian_map[0], np.concatenate(slopes.places), slopes.end)),
        jacobian_offset=jacobian_map[1],
        hessian=hessian_rows,
        hessian_scatter=_arrays(_move_columns(hessian_map[0], np.concatenate(order), end)),
        hessian_offset=hessian_map[1],
    )


@dataclass(frozen=True)
class Interleaved:
    """Where entries are that wide kernels hold.

    Attributes:
        places: of each part, (K n,): where entry j of knot k is, at index ``k n + j``.
        end: after the last of them.
    """

    places: list[Index]
    end: int


def interleaved(sizes: Sequence[int], knots: int, lanes: int) -> Interleaved:
    """Return the places of ``sizes`` entries a knot, part after part; see ``kernel_nlp.hpp``."""
    groups, end, places = -(-knots // lanes), 0, []
    for n in sizes:
        knot, entry = np.divmod(np.arange(knots * n), max(1, n))
        places.append(end + (knot // lanes * n + entry) * lanes + knot % lanes)
        end += groups * lanes * n
    return Interleaved(places, end)


def _part(problem: Problem, part: int, wide: WideKernel, outputs: Interleaved) -> dict[str, Any]:
    """Return what the extension takes of an agent or of the object."""
    kernel, select, knots = problem.parts[part].kernel, problem.parts[part].select, len(problem.mesh.weights)
    y = interleaved([kernel.n_y], knots, wide.lanes)
    squared = interleaved([kernel.n_squared], knots, wide.lanes)
    rows, factors = np.full(squared.end, -1, dtype=np.int32), np.ones(squared.end)
    first = knots * sum(p.kernel.n_c for p in problem.parts[:part])
    for k in range(knots):
        for j in range(kernel.n_squared):
            at = squared.places[0][k * kernel.n_squared + j]
            rows[at], factors[at] = _own_row(problem, first + k * kernel.n_c + j)
    return dict(
        value=wide.value,
        derivatives=wide.derivatives,
        n_y=kernel.n_y,
        n_c=kernel.n_c,
        n_p=kernel.n_p,
        jacobian_nonzeros=kernel.jacobian.nnz_out(0),
        curvature_nonzeros=kernel.curvature.nnz_out(0),
        select=_arrays(_move_columns(select.T, y.places[0], y.end).T),
        squared_rows=rows,
        squared_factors=factors,
    )


def _own_row(problem: Problem, output: int) -> tuple[int, float]:
    """Return the row of g that is a multiple of one output, and that multiple."""
    combine, linear = problem.constraints.combine, problem.constraints.linear
    for entry in range(combine.indptr[output], combine.indptr[output + 1]):
        row = int(combine.indices[entry])
        if combine.getrow(row).nnz == 1 and linear.getrow(row).nnz == 0:
            return row, float(combine.data[entry])
    raise SolverError("a squared output has no constraint row of its own to be condensed with")


def _move_columns(matrix: Any, places: Index, size: int) -> sp.csr_matrix:
    entries = sp.coo_matrix(matrix)
    return sp.csr_matrix((entries.data, (entries.row, places[entries.col])), shape=(matrix.shape[0], size))


def callback_nlp(module: Any, nlp: Nlp, parameters: Array) -> Any:
    """Return a problem as CasADi evaluates it, called through Python, at parameters that may change in place."""
    values = ca.Function("values", [nlp.x, nlp.p], [nlp.f, nlp.g])
    jacobian, jacobian_order = _row_order(nlp.jac_g.sparsity_out(1))
    hessian, hessian_order = _row_order(nlp.hess_lag.sparsity_out(0))

    def evaluate(x: Array) -> tuple[float, Array]:
        f, g = values(x, parameters)
        return float(f), g.full().ravel()

    def differentiate(x: Array, multipliers: Array, scale: float) -> tuple[Array, Array, Array]:
        gradient = nlp.grad_f(x, parameters)[1].full().ravel()
        slopes = np.array(nlp.jac_g(x, parameters)[1].nonzeros())
        curvatures = np.array(nlp.hess_lag(x, parameters, scale, multipliers).nonzeros())
        return scale * gradient, slopes[jacobian_order], curvatures[hessian_order]

    return module.CallbackNlp(evaluate=evaluate, differentiate=differentiate, jacobian=jacobian, hessian=hessian)


def _row_order(sparsity: Any) -> tuple[Any, npt.NDArray[np.int64]]:
    """Return a CasADi pattern in compressed rows, and where each of its entries is in compressed columns."""
    start, index, count = sparsity.colind(), sparsity.row(), sparsity.nnz()
    rows = sp.csr_matrix(sp.csc_matrix((np.arange(count, dtype=float), index, start), shape=sparsity.shape))
    rows.sort_indices()
    return _arrays(rows), rows.data.astype(np.int64)


def _by_rows(pattern: Pattern) -> tuple[Any, tuple[sp.csr_matrix, Array]]:
    """Return a pattern's rows, and the map to its nonzeros and its constant part in the order of compressed rows."""
    numbered = sp.csc_matrix((np.arange(pattern.shape.nnz, dtype=float), pattern.shape.indices, pattern.shape.indptr),
                             shape=pattern.shape.shape)  # fmt: skip
    rows = sp.csr_matrix(numbered)
    rows.sort_indices()
    order = rows.data.astype(np.int64)
    return _arrays(rows), (sp.csr_matrix(pattern.scatter)[order], pattern.offset[order])


def _arrays(matrix: Any) -> tuple[int, int, npt.NDArray[np.int32], npt.NDArray[np.int32], Array]:
    rows = sp.csr_matrix(matrix)
    rows.sum_duplicates()
    rows.sort_indices()
    return *rows.shape, rows.indptr.astype(np.int32), rows.indices.astype(np.int32), rows.data.astype(float)
