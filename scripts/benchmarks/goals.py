"""The goals, and what a row of the table says of one."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Goal:
    """What is wanted: ``value`` at most ``goal`` (at least, if ``more``), and what would be better still."""

    title: str
    unit: str
    goal: float
    beyond: float | None
    more: bool = False

    def verdict(self, value: float) -> str:
        """Return ``"beyond"``, ``"reached"`` or ``"missed"``."""
        sign = -1.0 if self.more else 1.0
        if self.beyond is not None and sign * value <= sign * self.beyond:
            return "beyond"
        return "reached" if sign * value <= sign * self.goal else "missed"


GOALS = {
    "ipopt": Goal("IPOPT, one solve from a given start", "ms", 200, 140),
    "ipopt_warm": Goal("IPOPT, warm re-solve with multipliers", "ms", 50, 30),
    "banded": Goal("banded, cold from a given start", "ms", 30, 15),
    "banded_warm": Goal("banded, warm re-solve, p90 of 100 mixes", "ms", 8, 4),
    "lift": Goal("scenario in, best of 8 starts verified and out", "ms", 150, 60),
    "process": Goal("`liftopt solve` in all, a fresh process", "ms", 1500, 700),
    "first_try": Goal("varied scenarios, banded at the first try", "%", 95, 100, more=True),
    "fallback": Goal("varied scenarios, banded with its fallback", "%", 100, 100, more=True),
    "scaling": Goal("banded, N = 10 to 160: time an interval, max / min", "", 1.2, None),
    "many_starts": Goal("64 starts, best kept, 2 processes", "ms", 2000, 500),
    "memory": Goal("peak memory of a solve", "MB", 300, 150),
    "objective": Goal("varied scenarios, best of 8: J within 0.1 % of before", "%", 100, None, more=True),
}


@dataclass(frozen=True)
class Row:
    """One measured figure.

    Attributes:
        value: in the goal's unit; None where it could not be measured.
        note: what the reader should know beside it, or why it was skipped.
        counts: figures that depend on no machine.
        details: times and whatever else is kept in the file.
    """

    value: float | None
    note: str = ""
    counts: dict[str, Any] = field(default_factory=dict)
    details: dict[str, Any] = field(default_factory=dict)
