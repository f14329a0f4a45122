"""liftopt's own interior point: the Newton matrix of a lift is banded in time, and its kernels need no Python.

A filter line-search interior point after Waechter and Biegler (2006), written in C++ in ``liftopt/banded`` (the
algorithm, its sources and where it departs from them stand in ``interior_point.hpp`` and ``newton.hpp``): inequality
rows are condensed into the matrix of the unknowns, equality rows enter by a penalty with refinement, and a block
Cholesky factorises the result, grasp forces first (they touch one knot each), then the control points in time. That
the factorisation succeeds is the test of inertia. It has no restoration phase: from a start that is too far away it
may give up where IPOPT goes on, and says so.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from liftopt.collocation.problem import Problem
from liftopt.collocation.scatter import Pattern, hessian_pattern, jacobian_pattern
from liftopt.collocation.solvers.result import Multipliers, SolverResult
from liftopt.errors import SolverError

Array = npt.NDArray[np.float64]
# The verification recomputes the error by Pinocchio: what the solver calls converged must stay so there.
SAFETY = 0.5
# A warm start is near the solution: this barrier parameter and this share of the room to the bounds keep it there.
WARM_MU, WARM_PUSH = 1e-4, 1e-5


@dataclass(frozen=True)
class BandedOptions:
    """Options of the interior point.

    Attributes:
        tolerance: KKT error in the problem's own units at which it stops.
        max_iterations: iterations before it gives up.
        objective_scaling: factor on the objective inside the solver.
    """

    tolerance: float = 1e-6
    max_iterations: int = 300
    objective_scaling: float = 0.1


class Banded:
    """The interior point on one problem; ``solve`` may be called from many starts."""

    def __init__(self, problem: Problem, options: BandedOptions | None = None) -> None:
        """Build the solver.

        Raises:
            SolverError: the extension is not installed, or the problem does not have the form it takes.
        """
        try:
            import _liftopt_banded
        except ImportError as error:
            raise SolverError(f"the extension of the banded solver is missing ({error}): reinstall liftopt") from error
        self.problem, self.options = problem, options or BandedOptions()
        compiled = all(part.kernel.compiled for part in problem.parts)
        self._nlp = _kernel_nlp(_liftopt_banded, problem) if compiled else _callback_nlp(_liftopt_banded, problem)
        self._compiled = compiled
        self._solver = _liftopt_banded.InteriorPoint(self._nlp, elimination_order(problem))
        self.details: dict[str, Any] = {}

    @property
    def multiplications(self) -> float:
        """Multiplications of one factorisation, a measure that depends on no machine."""
        return float(self._solver.multiplications())

    def solve(
        self, x0: Array, *, deadline: float, warm: Multipliers | None = None, problem: Problem | None = None
    ) -> SolverResult:
        """Solve from ``x0``; see ``Solver.solve``."""
        problem, options = problem or self.problem, self.options
        constraints = problem.constraints
        if not constraints.same_rows(self.problem.constraints):
            raise SolverError("the problem has other constraint rows than the one this solver was built for")
        self._set_parameters(problem)
        lower, upper = problem.bounds()
        arguments: dict[str, Any] = {}
        if warm is not None:
            arguments = dict(warm=(warm.x, warm.g), mu=WARM_MU, push=WARM_PUSH)
        found = self._solver.solve(
            lower_x=lower,
            upper_x=upper,
            lower_g=constraints.lower,
            upper_g=constraints.upper,
            x0=x0,
            tolerance=SAFETY * options.tolerance,
            objective_scaling=options.objective_scaling,
            max_iterations=options.max_iterations,
            seconds=deadline - time.monotonic(),
            **arguments,
        )
        self.details = found
        return SolverResult(
            x=found["x"],
            multipliers=Multipliers(found["bound_multipliers"], found["multipliers"]),
            objective=found["objective"],
            iterations=found["iterations"],
            converged=found["status"] == "Solve_Succeeded",
            status=found["status"],
            seconds=found["seconds"],
            evaluation_seconds=found["evaluation_seconds"],
        )

    def _set_parameters(self, problem: Problem) -> None:
        if not self._compiled:
            self._nlp_parameters[:] = problem.parameters
            return
        for i, topology in enumerate(problem.team.topologies):
            kernel = np.concatenate([[problem.task.duration], topology.parameters])
            self._nlp.set_parameters(i, kernel, *problem.weights(i))


def elimination_order(problem: Problem) -> list[list[int]]:
    """Return blocks of unknowns: the grasp forces of each knot, then the control points in time."""
    layout = problem.layout
    return [row.tolist() for row in layout.force] + [row.tolist() for row in layout.control]


def _kernel_nlp(module: Any, problem: Problem) -> Any:
    parts, constraints, weights = problem.parts, problem.constraints, problem.mesh.weights
    selects = [part.select for part in parts]
    jacobian = jacobian_pattern(
        [part.kernel.jacobian.sparsity_out(0) for part in parts],
        selects, weights, constraints.combine, constraints.linear,
    )  # fmt: skip
    hessian = hessian_pattern([[part.kernel.curvature.sparsity_out(0)] for part in parts], selects, weights)
    jacobian_rows, jacobian_scatter, jacobian_offset = _by_rows(jacobian)
    hessian_rows, hessian_scatter, hessian_offset = _by_rows(hessian)
    return module.KernelNlp(
        parts=_parts(problem),
        weights=weights,
        combine=_arrays(constraints.combine),
        linear=_arrays(constraints.linear),
        jacobian=jacobian_rows,
        jacobian_scatter=jacobian_scatter,
        jacobian_offset=jacobian_offset,
        hessian=hessian_rows,
        hessian_scatter=hessian_scatter,
        hessian_offset=hessian_offset,
    )


def _parts(problem: Problem) -> list[dict[str, Any]]:
    """Return what the extension takes of each agent and of the object."""
    constraints, knots = problem.constraints, len(problem.mesh.weights)
    combine, by_output = sp.csr_matrix(constraints.combine), sp.csc_matrix(constraints.combine)
    lonely = (np.diff(combine.indptr) == 1) & (np.diff(sp.csr_matrix(constraints.linear).indptr) == 0)
    described, first = [], 0
    for part in problem.parts:
        kernel = part.kernel
        rows, factors = [], []
        for k in range(knots):
            for j in range(kernel.n_squared):
                output = first + k * kernel.n_c + j
                entries = slice(by_output.indptr[output], by_output.indptr[output + 1])
                own = lonely[by_output.indices[entries]]
                if not own.any():
                    raise SolverError("a squared output has no constraint row of its own to be condensed with")
                rows.append(by_output.indices[entries][own][0])
                factors.append(by_output.data[entries][own][0])
        first += knots * kernel.n_c
        calls = {role: _call(kernel, role) for role in ("value", "jacobian", "curvature")}
        described.append(
            calls
            | dict(
                n_y=kernel.n_y,
                n_c=kernel.n_c,
                jacobian_nonzeros=kernel.jacobian.nnz_out(0),
                curvature_nonzeros=kernel.curvature.nnz_out(0),
                select=_arrays(part.select),
                squared_rows=np.array(rows, dtype=np.int32),
                squared_factors=np.array(factors),
            )
        )
    return described


def _call(kernel: Any, role: str) -> tuple[int, int, int, int, int]:
    function = getattr(kernel, role)
    return kernel.address(role), function.sz_arg(), function.sz_res(), function.sz_iw(), function.sz_w()


def _callback_nlp(module: Any, problem: Problem) -> Any:
    """Return the problem as CasADi's virtual machine evaluates it."""
    raise SolverError("todo")


def _by_rows(pattern: Pattern) -> tuple[Any, Any, Array]:
    """Return a pattern's rows and the map to its nonzeros in the order of compressed rows."""
    numbered = pattern.shape.copy()
    numbered.data = np.arange(1.0, numbered.nnz + 1)
    rows = sp.csr_matrix(numbered)
    rows.sort_indices()
    order = rows.data.astype(np.int64) - 1
    return _arrays(rows), _arrays(sp.csr_matrix(pattern.scatter)[order]), pattern.offset[order]


def _arrays(matrix: Any) -> tuple[int, int, npt.NDArray[np.int32], npt.NDArray[np.int32], Array]:
    rows = sp.csr_matrix(matrix)
    rows.sum_duplicates()
    rows.sort_indices()
    return *rows.shape, rows.indptr.astype(np.int32), rows.indices.astype(np.int32), rows.data.astype(float)
