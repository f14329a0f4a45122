"""What is known of clear postures at one end of a lift."""

from __future__ import annotations

from dataclasses import dataclass

from liftopt.search.postures import Posture
from liftopt.solution.infeasibility_report import InfeasibilityReason


@dataclass(frozen=True)
class ClearEnd:
    """Postures at one end of a lift.

    Attributes:
        postures: that hold the object with bodies apart, the cheapest first; if none does, the nearest to that.
        reasons: what is in the way of all; empty if some are clear.
    """

    postures: tuple[Posture, ...]
    reasons: tuple[InfeasibilityReason, ...] = ()
