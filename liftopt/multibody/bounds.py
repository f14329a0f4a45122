"""The check of one number that a user gave."""

from __future__ import annotations

from math import isfinite

import numpy as np

from liftopt.errors import InputError


def checked_number(key: str, value: object, lower: float, upper: float, unit: str) -> float:
    """Return ``value`` as a float if it is a finite number in [lower, upper].

    Args:
        key: dotted name of the entry, for the error message.
        value: what the user gave.
        lower: smallest value allowed, in ``unit``.
        upper: largest value allowed, in ``unit``.
        unit: SI unit, for the error message.

    Raises:
        InputError: it is no number, not finite, or out of range.
    """
    is_number = isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)
    if is_number and isfinite(number := float(value)) and lower <= number <= upper:  # type: ignore[arg-type]
        return number
    raise InputError(key, value, f"must be a number from {lower:g} to {upper:g} {unit}")
