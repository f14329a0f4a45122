"""What the plots are drawn from: a solution at its knots and on a finer grid."""

from __future__ import annotations

from dataclasses import dataclass

from liftopt.solution.checks import FINER
from liftopt.solution.interpolation import resample
from liftopt.solution.solution import Solution


@dataclass(frozen=True)
class Lift:
    """A solution and the same one between its knots.

    Attributes:
        knots: as solved.
        dense: at ``factor`` times as many intervals.
        factor: of them.
    """

    knots: Solution
    dense: Solution
    factor: int

    @staticmethod
    def of(solution: Solution, factor: int = FINER) -> Lift:
        """Return the lift of ``solution``."""
        return Lift(solution, resample(solution, factor), factor)
