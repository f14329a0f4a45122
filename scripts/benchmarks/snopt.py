"""The same nonlinear programme through SNOPT, the solver of the paper, in Drake's wheel.

SNOPT gets what IPOPT gets: our objective, constraints, gradient and Jacobian with its pattern, the linear rows as
linear ones, the bounds as bounds. It has no use for second derivatives. Drake takes derivatives as AutoDiffXd, dense
in the variables of a constraint, so each knot's rows are a constraint of their own; our functions are still called
once a point. Their time, and that of handing values and derivatives over in Python, are kept apart.
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
from liftopt.types import Array

Index = npt.NDArray[np.int64]
# Room for a superbasic variable of every degree of freedom; the limits on iterations are out of the way. On the lift at
# the paper's size 50 updates of the Hessian took two thirds of the time that SNOPT's 10 took, 200 or a full Hessian
# more; scaling the nonlinear rows as well (scale option 2), or a smaller objective, took half as long again.
OPTIONS = {
    "Hessian updates": 50,
    "Major optimality tolerance": 1e-6,
    "Major feasibility tolerance": 1e-6,
    "Superbasics limit": 1000,
    "Major iterations limit": 50000,
    "Iterations limit": 5000000,
    "Verify level": -1,
}
OBJECTIVE_SCALING = 0.1  # as for banded


@dataclass(frozen=True)
class SnoptRun:
    """How SNOPT fared.

    Attributes:
        converged: by its own word.
        status: SNOPT's exit code and Drake's word for it.
        objective: at the last point it asked for.
        seconds: wall time [s].
        evaluation: of which in our functions [s].
        handing_over: of which in Python around them [s].
        cpu: time of this process [s].
        points: at which our functions were evaluated.
    """

    converged: bool
    status: str
    objective: float
    seconds: float
    evaluation: float
    handing_over: float
    cpu: float
    points: int


def solve(problem: Problem, x0: Array, seconds: float, print_file: str = "") -> SnoptRun:
    """Solve from ``x0`` within ``seconds`` of processor time; raises ImportError without pydrake."""
    from pydrake.solvers import CommonSolverOption, MathematicalProgram, SnoptSolver, SolverOptions

    constraints = problem.constraints
    is_linear = np.diff(constraints.combine.tocsr().indptr) == 0
    straight = np.flatnonzero(is_linear)
    functions = _Functions(problem, time.process_time() + seconds)
    program = MathematicalProgram()
    x = program.NewContinuousVariables(problem.layout.n_x, "x")
    lower, upper = problem.bounds()
    program.AddBoundingBoxConstraint(lower, upper, x)
    program.AddLinearConstraint(
        constraints.linear.tocsr()[straight], constraints.lower[straight], constraints.upper[straight], x
    )
    program.AddCost(functions.objective, x)
    for group in _knots(problem, np.flatnonzero(~is_linear)):
        rows = group.rows
        bound = program.AddConstraint(
            functions.of(group), constraints.lower[rows], constraints.upper[rows], x[group.columns]
        )
        bound.evaluator().SetGradientSparsityPattern(list(zip(*(at.tolist() for at in group.places), strict=True)))
    options = SolverOptions()
    for name, value in OPTIONS.items():
        options.SetOption(SnoptSolver.id(), name, value)
    if print_file:
        options.SetOption(CommonSolverOption.kPrintFileName, print_file)
    began, cpu = time.perf_counter(), time.process_time()
    try:
        result = SnoptSolver().Solve(program, x0, options)
    except Exception as error:
        if not functions.late:
            raise
        converged, status = False, f"stopped after {seconds:g} s ({type(error).__name__})"
    else:
        converged = result.is_success()
        status = f"{result.get_solver_details().info} ({result.get_solution_result().name})"
    return SnoptRun(
        converged=converged,
        status=status,
        objective=functions.latest,
        seconds=time.perf_counter() - began,
        evaluation=functions.evaluation,
        handing_over=functions.inside - functions.evaluation,
        cpu=time.process_time() - cpu,
        points=functions.points,
    )


@dataclass(frozen=True)
class _Group:
    """Rows of g, the unknowns that they depend on, and their part of the Jacobian.

    Attributes:
        rows, columns: of the Jacobian.
        places: row and column within the group of every entry.
        entries: which entries of the Jacobian these are.
    """

    rows: Index
    columns: Index
    places: tuple[Index, Index]
    entries: Index


class _Functions:
    """Our functions as Drake calls them: the objective first, with all of x, then the rows of each knot."""

    def __init__(self, problem: Problem, until: float) -> None:
        self.problem, self.until, self.late, self.latest = problem, until, False, float("nan")
        self.evaluation, self.inside, self.points = 0.0, 0.0, 0
        self._at: Array = np.array([])
        self._values = ca.Function("values", [problem.nlp.x, problem.nlp.p], [problem.nlp.f, problem.nlp.g])

    def objective(self, x: Any) -> Any:
        """Return f, with its gradient where Drake asks for derivatives."""
        began = time.perf_counter()
        self.late = time.process_time() > self.until
        if self.late:
            raise TimeoutError("SNOPT's time is over")
        self._evaluate(_plain(x))
        self.latest = self._f
        f = OBJECTIVE_SCALING * self._f
        answer = f if x.dtype == float else _autodiff(np.array([f]), OBJECTIVE_SCALING * self._gradient)[0]
        self.inside += time.perf_counter() - began
        return answer

    def of(self, group: _Group) -> Any:
        """Return the function of some rows of g, which depend on some of the unknowns alone."""
        slopes = np.zeros((len(group.rows), len(group.columns)))

        def function(x: Any) -> Any:
            began = time.perf_counter()
            values = _plain(x)
            if not np.array_equal(values, self._at[group.columns]):
                raise RuntimeError("Drake asked for constraints at a point where it had not asked for the objective")
            answer = self._g[group.rows]
            if x.dtype != float:
                slopes[group.places] = self._jacobian[group.entries]
                answer = _autodiff(answer, slopes)
            self.inside += time.perf_counter() - began
            return answer

        return function

    def _evaluate(self, x: Array) -> None:
        if np.array_equal(x, self._at):
            return
        began = time.perf_counter()
        f, gradient = self.problem.nlp.grad_f(x, self.problem.parameters)
        g, jacobian = self.problem.nlp.jac_g(x, self.problem.parameters)
        self.evaluation += time.perf_counter() - began
        self.points += 1
        self._at, self._f, self._g, self._gradient = x, float(f), g.full().ravel(), gradient.full().T
        self._jacobian = np.array(jacobian.nonzeros())


def _plain(x: Any) -> Array:
    from pydrake.autodiffutils import ExtractValue

    values: Array = x.copy() if x.dtype == float else ExtractValue(x).ravel()
    return values


def _autodiff(values: Array, slopes: Array) -> Any:
    from pydrake.autodiffutils import InitializeAutoDiff

    return InitializeAutoDiff(values[:, None], slopes).ravel()


def _knots(problem: Problem, rows: Index) -> list[_Group]:
    """Return the rows of each knot."""
    kinds = problem.nlp.jac_g.sparsity_out(1)
    number = np.arange(1, kinds.nnz() + 1)  # a stored 0 would be dropped
    entries = sp.csc_matrix((number, kinds.row(), kinds.colind()), shape=kinds.shape).tocsr()
    # The first and the last control point that a row depends on tell its knot, up to those at the ends.
    block = np.full(problem.layout.n_x, -1)
    for i, control in enumerate(problem.layout.control):
        block[control] = i
    groups: dict[tuple[int, int], list[int]] = {}
    for row in rows.tolist():
        touched = block[entries[row].indices]
        touched = touched[touched >= 0]
        # Grasp force rows depend on no control point.
        key = (int(touched.min()), int(touched.max())) if len(touched) else (-1, int(entries[row].indices[0]))
        groups.setdefault(key, []).append(row)
    found = []
    for group in groups.values():
        part = entries[group]
        columns = np.unique(part.indices)
        local = part[:, columns].tocoo()
        found.append(_Group(np.array(group), columns, (local.row, local.col), local.data - 1))
    return found
