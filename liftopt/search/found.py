"""What a stage of the search hands on to the next."""

from __future__ import annotations

from dataclasses import dataclass

from liftopt.collocation.spline import RestToRestSpline
from liftopt.search.candidate import Candidate
from liftopt.solution.accuracy import Accuracy
from liftopt.solution.infeasibility_report import InfeasibilityReason
from liftopt.types import Array


@dataclass(frozen=True, eq=False)
class Found:
    """The best candidate on a mesh, and what is known beside it.

    Attributes:
        best: verified, or where there is none, what comes nearest.
        others: all candidates on the same mesh, the best first.
        accuracy: how far the best one is from the lift in continuous time; None where that is not known.
        reasons: why there is no solution, the worst first.
        near: unknowns (n_x,) of motions that come near a lift, on the same mesh.
    """

    best: Candidate
    others: tuple[Candidate, ...] = ()
    accuracy: Accuracy | None = None
    reasons: tuple[InfeasibilityReason, ...] = ()
    near: tuple[Array, ...] = ()

    @property
    def spline(self) -> RestToRestSpline:
        """The mesh."""
        return self.best.spline
