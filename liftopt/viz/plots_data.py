"""What the plots are drawn from: a solution at its knots and on a finer grid."""

from __future__ import annotations

from dataclasses import dataclass, field

from liftopt.solution.checks import FINER
from liftopt.solution.interpolation import resample
from liftopt.solution.solution import Solution
from liftopt.viz.own_meshes import Figures


@dataclass(frozen=True)
class Lift:
    """A solution and the same one between its knots.

    Attributes:
        knots: as solved.
        dense: at ``factor`` times as many intervals.
        factor: of them.
        figures: own meshes of robots, as ``figures_of`` finds them.
    """

    knots: Solution
    dense: Solution
    factor: int
    figures: Figures = field(default_factory=dict)

    @staticmethod
    def of(solution: Solution, figures: Figures | None = None) -> Lift:
        """Return the lift of ``solution``, whose robots have ``figures``."""
        return Lift(solution, resample(solution, FINER), FINER, figures or {})
