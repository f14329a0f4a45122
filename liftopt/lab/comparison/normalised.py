"""A predicted curve in normalised time, beside recorded ones."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from liftopt.lab.comparison.comparison import SHARE, Comparison
from liftopt.solution.solution import Solution
from liftopt.types import Array


def compared(
    group: str, name: str, label: str, unit: str, dense: Solution, predicted: Array, trials: Sequence[Array] | Array
) -> Comparison:
    """Return the comparison of values (T,) at a solution's times with trials, each (S,) over its own lift."""
    return Comparison(group, name, label, unit, over_lift(dense, predicted), np.stack(list(trials)))


def over_lift(dense: Solution, values: Array) -> Array:
    """Return values (T,) at a solution's times over the shares of the lift (S,)."""
    return np.asarray(np.interp(SHARE * dense.time[-1], dense.time, values), float)
