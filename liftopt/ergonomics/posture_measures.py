"""What RULA and REBA say of a lift in words."""

from __future__ import annotations

from liftopt.ergonomics.measure import Measure
from liftopt.ergonomics.reba import Reba, reba_action
from liftopt.ergonomics.reba_tables import SOURCE as REBA_SOURCE
from liftopt.ergonomics.rula import ACTION, Rula
from liftopt.ergonomics.rula_tables import SOURCE as RULA_SOURCE
from liftopt.ergonomics.scores import PostureScores
from liftopt.types import Array


def rula_measure(scores: Rula, time: Array, arms: int) -> Measure:
    """Return what RULA says.

    Args:
        scores: of the worse side.
        time: (K,) [s].
        arms: how many were scored.
    """
    worst, at = int(scores.grand.max()), float(time[scores.worst])
    side = "" if arms == 1 else f" Of both sides the {scores.side} one is told."
    return Measure(
        "posture",
        "RULA",
        "applies",
        f"grand score {_span(scores)} of 7",
        f"At its worst ({at:.2f} s, {_part(scores):.0f} % of the lift): {ACTION[worst]}. Made for seated and standing "
        "work of the arms; a lower bound here, for what the model lacks (the neck, a raised shoulder) is scored at its "
        f"best.{side}",
        RULA_SOURCE,
        value=float(worst),
        unit="of 7",
        time=at,
    )


def reba_measure(scores: Reba, time: Array) -> Measure:
    """Return what REBA says; arguments as ``rula_measure``."""
    worst, at = int(scores.grand.max()), float(time[scores.worst])
    return Measure(
        "whole_posture",
        "REBA",
        "applies",
        f"grand score {_span(scores)} of 15",
        f"At its worst ({at:.2f} s, {_part(scores):.0f} % of the lift): {reba_action(worst)}. A lower bound, for the "
        f"neck is scored at its best. Of both sides the {scores.side} one is told.",
        REBA_SOURCE,
        value=float(worst),
        unit="of 15",
        time=at,
    )


def _span(scores: PostureScores) -> str:
    best, worst = int(scores.grand.min()), int(scores.grand.max())
    return f"{worst}" if best == worst else f"{best} to {worst}"


def _part(scores: PostureScores) -> float:
    """Return for how much of the lift the score is at its worst [%]."""
    return 100.0 * float((scores.grand == scores.grand.max()).mean())
