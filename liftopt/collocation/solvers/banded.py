"""liftopt's own interior point: the Newton matrix of a lift is banded in time, and its kernels need no Python.

A filter line-search interior point after Waechter and Biegler (2006), written in C++ in ``liftopt/banded`` (the
algorithm, its sources and where it departs from them stand in ``interior_point.hpp`` and ``newton.hpp``): inequality
rows are condensed into the matrix of the unknowns, equality rows enter by a penalty with refinement, and a block
Cholesky factorises the result in time, each control point after the grasp forces of the knots it acts at. That the
factorisation succeeds is the test of inertia; where it fails far from a solution, curvature is left out. It has no
restoration phase: from a start that is too far away it may give up where IPOPT goes on, and says so. Derivatives stay
at the knots (``knot_assembly.hpp``): a product with the Jacobian or the Hessian interpolates to the knots and back, and
the condensed matrix is summed in two stages.

What exists was tried on a prototype of this problem and does not serve (docs/tuning.md).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from liftopt.collocation.constraints import Constraints
from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.banded_nlp import callback_nlp, kernel_nlp, kernels_for_simd
from liftopt.collocation.solvers.deadline import Deadline
from liftopt.collocation.solvers.result import PRUNED, STOPPED, Multipliers, SolverResult
from liftopt.errors import SolverError
from liftopt.types import Array, Progress

# The verification recomputes the same error by Pinocchio, whose rounding differs: what converged must stay so there.
SAFETY = 0.9
SOLVED = "Solve_Succeeded"
# From posture pairs these take the fewest factorisations of those tried (docs/tuning.md). Finer meshes have more
# bounds, and a smaller barrier parameter is better there: it falls with the square of the intervals.
COLD = dict(mu=0.6, push=3e-2)
MU_INTERVALS = 20
# A warm start is near the solution: this barrier parameter and this share of the room to the bounds keep it there, and
# whole Newton steps to begin with find the bounds that become active.
WARM = dict(mu=1e-5, push=1e-4, predictions=2)
# From another mesh, where the active bounds differ more; much larger ones lead to other motions. On finer meshes it
# falls as that of a cold start does.
INTERPOLATED = WARM | dict(mu=1e-4)
# Iterations after which a start with an incumbent gives up: so many, or so many times what the incumbent took; more
# where that has not converged.
PRUNING_ITERATIONS, PRUNING_SHARE, LONGER = 60, 2, 100


@dataclass(frozen=True)
class BandedOptions:
    """Options of the interior point.

    Attributes:
        tolerance: KKT error in the problem's own units at which it stops.
        max_iterations: iterations before it gives up.
        objective_scaling: factor on the objective inside the solver.
        rough: share of the objective that the KKT error may reach instead, but for the violation of rows.
    """

    tolerance: float = 1e-6
    max_iterations: int = 300
    objective_scaling: float = 0.2
    rough: float = 0.0


class Banded:
    """The interior point on one problem; ``solve`` may be called from many starts."""

    def __init__(
        self, problem: Problem, options: BandedOptions | None = None, progress: Progress | None = None
    ) -> None:
        """Build the solver; ``progress`` is called when kernels must be compiled first.

        Raises:
            SolverError: the extension is not installed, or the problem does not have the form it takes.
        """
        try:
            import _liftopt_banded
        except ImportError as error:
            raise SolverError(f"the extension of the banded solver is missing ({error}): reinstall liftopt") from error
        self.problem, self.options = problem, options or BandedOptions()
        self._parameters = problem.parameters.copy()
        self._current: Problem | None = None
        intervals = len(problem.mesh.phase) - 1
        self._mu_share = (MU_INTERVALS / intervals) ** 2 if intervals else 1.0
        self._kernels = kernels_for_simd(problem, progress)
        if self._kernels:
            self._nlp = kernel_nlp(_liftopt_banded, problem, self._kernels)
        else:
            self._nlp = callback_nlp(_liftopt_banded, problem.nlp, self._parameters)
        self._solver = _liftopt_banded.InteriorPoint(self._nlp, elimination_order(problem))
        self.details: dict[str, Any] = {}

    @property
    def multiplications(self) -> float:
        """Multiplications of one factorisation, a measure that depends on no machine."""
        return float(self._solver.multiplications())

    def solve(
        self,
        x0: Array,
        *,
        deadline: Deadline,
        warm: Multipliers | None = None,
        problem: Problem | None = None,
        incumbent: SolverResult | None = None,
        most: int | None = None,
    ) -> SolverResult:
        """Solve from ``x0``; see ``Solver.solve``."""
        problem = problem or self.problem
        self._set_parameters(problem)
        most = self.options.max_iterations if most is None else min(most, self.options.max_iterations)
        more: dict[str, Any] = {"max_iterations": most}
        if incumbent is not None:
            fewer = min(most, self._most_with(incumbent))
            more = {"incumbent": incumbent.objective if incumbent.converged else np.inf, "max_iterations": fewer}
        cold = COLD | {"mu": self._mu_share * COLD["mu"]} | more
        arguments = cold
        if warm is not None:
            share = min(1.0, self._mu_share)  # with more, some went to another motion on 10 intervals
            near = INTERPOLATED | {"mu": share * INTERPOLATED["mu"]} if warm.interpolated else WARM
            arguments = near | more | {"warm": (warm.x, warm.g)}
        found = self._run(x0, problem, deadline, arguments)
        if warm is not None and found["status"] not in (SOLVED, STOPPED, PRUNED):
            # What was a neighbour in the data need not be one in its solution.
            first, found = found, self._run(x0, problem, deadline, cold)
            for count in ("iterations", "seconds", "evaluation_seconds"):
                found[count] += first[count]
        self.details = found
        return SolverResult(
            x=found["x"],
            multipliers=Multipliers(found["bound_multipliers"], found["multipliers"]),
            objective=found["objective"],
            iterations=found["iterations"],
            converged=found["status"] == SOLVED,
            status=found["status"],
            seconds=found["seconds"],
            evaluation_seconds=found["evaluation_seconds"],
        )

    def _most_with(self, incumbent: SolverResult) -> int:
        """Return how many iterations a start with an incumbent gets."""
        return max(PRUNING_ITERATIONS, PRUNING_SHARE * incumbent.iterations) if incumbent.converged else LONGER

    def _run(self, x0: Array, problem: Problem, deadline: Deadline, arguments: dict[str, Any]) -> dict[str, Any]:
        lower, upper = problem.bounds()
        constraints, options = problem.constraints, self.options
        found: dict[str, Any] = self._solver.solve(
            lower_x=lower,
            upper_x=upper,
            lower_g=constraints.lower,
            upper_g=constraints.upper,
            x0=x0,
            tolerance=SAFETY * options.tolerance,
            rough=options.rough,
            objective_scaling=options.objective_scaling,
            seconds=deadline.left,
            **arguments,
        )
        return found

    def objective(self, x: Array, problem: Problem | None = None) -> float:
        """Return the objective at ``x`` (n_x,): what a ranking of starts needs, in some ten microseconds.

        Raises:
            SolverError: ``problem`` has other constraint rows than the one this solver was built for.
        """
        return self.evaluate(x, problem)[0]

    def evaluate(self, x: Array, problem: Problem | None = None) -> tuple[float, Array]:
        """Return the objective and the constraint rows (n_g,) at ``x`` (n_x,); see ``objective``."""
        self._set_parameters(problem or self.problem)
        f, g = self._nlp.evaluate(x)
        return float(f), np.asarray(g)

    def takes(self, problem: Problem) -> bool:
        """Whether it may be solved without another solver."""
        return problem.differs_in_factors(self.problem) if self._kernels else problem.interchangeable(self.problem)

    def _takes(self, constraints: Constraints) -> bool:
        own = self.problem.constraints
        return constraints.same_but_factors(own) if self._kernels else constraints.same_rows(own)

    def _set_parameters(self, problem: Problem) -> None:
        if problem is self._current:
            return
        if not self._takes(problem.constraints):
            raise SolverError("the problem has other constraint rows than the one this solver was built for")
        self._current = problem
        if not self._kernels:
            self._parameters[:] = problem.parameters
            return
        for i, topology in enumerate(problem.topologies):
            kernel = np.concatenate([[problem.task.duration], topology.parameters])
            own = problem.weights(i)
            self._nlp.set_parameters(
                i, kernel, c_weight=own.above, y_weight=own.variable, c_weight_below=own.below, range=own.range
            )
        if problem.constraints.varied:
            self._nlp.set_factors(np.concatenate([row.factors for row in problem.constraints.varied]))


def elimination_order(problem: Problem) -> list[list[int]]:
    """Return blocks of unknowns in time: each control point after the grasp forces of the knots it acts at."""
    layout, blocks, knot = problem.layout, [], 0
    acts = np.any(np.stack(problem.mesh.basis) != 0.0, axis=0)
    for i, control in enumerate(layout.control):
        last = int(np.flatnonzero(acts[:, i]).max(initial=-1))
        blocks += [force.tolist() for force in layout.force[knot : last + 1]]
        knot = max(knot, last + 1)
        blocks.append(control.tolist())
    return blocks + [force.tolist() for force in layout.force[knot:]]
