"""What a verification says: requirements, worst values, limits, and whether they pass."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

AT_KNOTS = 1e-6  # closure [m], balance [N, Nm], limits [their unit]
TOUCH = 1e-3  # [m]: as much nearer than asked bodies may come between the knots
FINER = 10  # intervals of the grid between knots, for each of the mesh
COMPRESSION = "compression of the spine"  # name of a check
BETWEEN_KNOTS = " between knots"  # ends the name of a check on that grid


@dataclass(frozen=True)
class Check:
    """One requirement: the worst value found, its limit (infinite where it is only reported), and where.

    Attributes:
        name: of the constraint.
        value: worst value; violations are positive, 0 where there is room.
        limit: largest value that passes.
        unit: of both; ``"SI"`` where rotations and translations stand together.
        where: joint, agent or coordinate, and time.
    """

    name: str
    value: float
    limit: float
    unit: str
    where: str

    @property
    def passed(self) -> bool:
        """Whether the value is a number within the limit."""
        return bool(self.value <= self.limit)


@dataclass(frozen=True)
class Verification:
    """All checks of one point.

    Attributes:
        checks: the requirements, worst value each.
        kkt_error: error of the first-order conditions.
        kkt_tolerance: largest that passes.
    """

    checks: tuple[Check, ...]
    kkt_error: float
    kkt_tolerance: float

    @property
    def passed(self) -> bool:
        """Whether every check and the KKT error pass."""
        return bool(self.kkt_error <= self.kkt_tolerance) and all(check.passed for check in self.checks)

    @property
    def worst(self) -> Check:
        """The check with the largest share of its limit."""
        return max(self.checks, key=lambda check: np.nan_to_num(check.value / check.limit, nan=np.inf))

    @property
    def max_violation(self) -> float:
        """The largest value among the checks that hold at the knots to 1e-6; NaN if one of them is."""
        return float(np.max([check.value for check in self.checks if check.limit == AT_KNOTS]))

    def describe_failure(self) -> str:
        """Return what fails, by name, amount and place, in one line."""
        if all(check.passed for check in self.checks):
            return f"KKT error {self.kkt_error:.3g}, allowed {self.kkt_tolerance:.3g}"
        worst = self.worst
        unit = "" if worst.unit == "SI" else f" {worst.unit}"
        return f"{worst.name} {worst.value:.3g}{unit}, allowed {worst.limit:.3g} ({worst.where})"

    def check(self, name: str) -> Check:
        """Return the check of that name; raises KeyError if there is none."""
        for check in self.checks:
            if check.name == name:
                return check
        raise KeyError(name)
