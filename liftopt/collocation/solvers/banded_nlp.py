"""A lift as the extension ``_liftopt_banded`` takes it: from SIMD kernels, or through Python without them."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from liftopt.collocation.assembly import Nlp
from liftopt.collocation.codegen.simd_kernels import SimdKernel, load_simd_kernels
from liftopt.collocation.problem import Problem
from liftopt.errors import SolverError
from liftopt.types import Array, Progress


def kernels_for_simd(problem: Problem, progress: Progress | None = None) -> list[SimdKernel] | None:
    """Return the kernels of a problem's parts for several knots at once, or None where they cannot be made."""
    return load_simd_kernels(problem.requests, progress)


def kernel_nlp(module: Any, problem: Problem, kernels: list[SimdKernel]) -> Any:
    """Return the problem as the SIMD kernels evaluate it."""
    layout, mesh, varied = problem.layout, problem.mesh, problem.constraints.varied
    # Only what needs it asks for it, so that extensions of other versions do for all else.
    more = {"varied": [(list(row.terms), row.rows.astype(np.int32)) for row in varied]} if varied else {}
    return module.KernelNlp(
        lanes=kernels[0].lanes,
        weights=mesh.weights,
        basis=np.stack(mesh.basis, axis=1),
        control=layout.control.ravel().astype(np.int32),
        force=layout.force.ravel().astype(np.int32),
        parts=[_part(problem, i, simd) for i, simd in enumerate(kernels)],
        rows=knot_rows(problem),
        linear=_arrays(problem.constraints.linear),
        **more,
    )


def _part(problem: Problem, part: int, simd: SimdKernel) -> dict[str, Any]:
    """Return what the extension takes of an agent, of the object or of poses, which take values alone."""
    kernel, layout, own = problem.parts[part].kernel, problem.layout, len(problem.team.kernels)
    forces: npt.NDArray[np.int64]
    if part < own:
        coordinates, forces, others = layout.columns(part), layout.kernel_forces(part), layout.kernel_others(part)
    else:
        values = layout.columns(problem.poses[part - own].part)
        coordinates, forces, others = slice(0, 0), np.zeros(0, np.int64), np.arange(values.start, values.stop)
    return dict(
        value=simd.value,
        derivatives=simd.derivatives,
        first=coordinates.start,
        coordinates=coordinates.stop - coordinates.start,
        forces=forces.astype(np.int32),
        others=others.astype(np.int32),
        n_c=kernel.n_c,
        n_p=kernel.n_p,
        n_squared=kernel.n_squared,
        jacobian=_triplet(kernel.jacobian.sparsity_out(0)),
        curvature=_triplet(kernel.curvature.sparsity_out(0)),
    )


def _triplet(sparsity: Any) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.int32]]:
    row, column = (np.asarray(indices, dtype=np.int32) for indices in sparsity.get_triplet())
    return row, column


Term = tuple[int, int, float]


def knot_rows(problem: Problem) -> list[tuple[list[Term], npt.NDArray[np.int32]]]:
    """Return the rows of g that are sums of outputs with the same factors, once for all knots that have them.

    Each is a list of (part, output, factor), and which row it is at every knot, (K,), -1 where there is none.

    Raises:
        SolverError: a row takes outputs of several knots, or of a knot and unknowns.
    """
    knots, parts, constraints = len(problem.mesh.weights), problem.parts, problem.constraints
    combine = sp.csr_matrix(constraints.fixed if constraints.varied else constraints.combine)
    linear = sp.csr_matrix(constraints.linear)
    combine.sort_indices()
    where = [(p, k, j) for p, part in enumerate(parts) for k in range(knots) for j in range(part.kernel.n_c)]
    found: dict[tuple[Term, ...], npt.NDArray[np.int32]] = {}
    for row in range(combine.shape[0]):
        entries = slice(combine.indptr[row], combine.indptr[row + 1])
        places = [where[column] for column in combine.indices[entries]]
        if not places:
            continue
        if len({knot for _, knot, _ in places}) > 1 or linear.indptr[row] != linear.indptr[row + 1]:
            raise SolverError(f"row {row} of the constraints is not one of a single knot")
        terms = tuple((p, j, float(v)) for (p, _, j), v in zip(places, combine.data[entries], strict=True))
        found.setdefault(terms, np.full(knots, -1, dtype=np.int32))[places[0][1]] = row
    return [(list(terms), rows) for terms, rows in found.items()]


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


def _arrays(matrix: Any) -> tuple[int, int, npt.NDArray[np.int32], npt.NDArray[np.int32], Array]:
    rows = sp.csr_matrix(matrix)
    rows.sum_duplicates()
    rows.sort_indices()
    return *rows.shape, rows.indptr.astype(np.int32), rows.indices.astype(np.int32), rows.data.astype(float)
