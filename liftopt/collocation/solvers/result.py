"""What every solver adapter takes beside the problem, and what it gives back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.deadline import Deadline
from liftopt.types import Array

# Every solver's word for having reached its deadline.
STOPPED = "User_Requested_Stop"
# Of a solver that was given an incumbent: no failure, but not worth going on.
PRUNED = "Worse_Than_Incumbent"


@dataclass(frozen=True)
class Multipliers:
    """Lagrange multipliers, CasADi's sign: the Lagrangian is ``f + lam_g . g + lam_x . x``.

    Attributes:
        x: (n_x,) of the bounds.
        g: (n_g,) of the constraints.
        interpolated: whether they are from another mesh, and tell less surely which bounds are active.
    """

    x: Array
    g: Array
    interpolated: bool = False


@dataclass(frozen=True)
class SolverResult:
    """Where a solver stopped.

    Attributes:
        x: unknowns.
        multipliers: at x.
        objective: value of the objective.
        iterations: number of iterations.
        converged: whether the solver says so; it is not taken at its word.
        status: its own word for how it ended.
        seconds: wall time in the solver, evaluation included [s].
        evaluation_seconds: of which in the problem's functions [s].
    """

    x: Array
    multipliers: Multipliers
    objective: float
    iterations: int
    converged: bool
    status: str
    seconds: float
    evaluation_seconds: float


class Solver(Protocol):
    """A solver bound to one problem."""

    def takes(self, problem: Problem) -> bool:
        """Whether a problem may be solved in the place of the bound one, without another solver."""
        ...

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
        """Solve from ``x0``.

        Args:
            x0: (n_x,) start.
            deadline: past which the solver stops.
            warm: multipliers of a neighbouring solution to start from.
            problem: another problem of the same structure, for its bounds and parameters; None: the bound one.
            incumbent: where another start led. Where nothing lower is in sight the solver may give up (``PRUNED``), or
                where it takes much longer.
            most: iterations after which it gives up; None: as many as its options say.

        Raises:
            SolverError: the solver itself cannot run.
        """
        ...
