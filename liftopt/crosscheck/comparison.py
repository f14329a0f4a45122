"""One line of the cross-check: how far two ways to one quantity are apart, at worst."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftopt.types import Array

TOLERANCE = 1e-9


@dataclass(frozen=True)
class Comparison:
    """Worst disagreement over all samples and components.

    Attributes:
        model: name of the chain.
        quantity: what was compared.
        oracle: what it was compared with.
        unit: of the absolute error.
        absolute: worst absolute error.
        relative: worst error over max(1, |oracle's value|).
        tolerance: largest absolute error allowed; where each entry has a bound of its own, the bound of the entry
            that comes nearest to it, and ``absolute`` is that entry's error.
        samples: number of random states.
        passed: no entry exceeds its tolerance.
    """

    model: str
    quantity: str
    oracle: str
    unit: str
    absolute: float
    relative: float
    tolerance: float
    samples: int
    passed: bool


def compare(
    model: str, quantity: str, oracle: str, unit: str, ours: Array, theirs: Array, bound: Array | float = TOLERANCE
) -> Comparison:
    """Compare two arrays of one shape (S, ...); ``bound`` is one tolerance or one for each entry."""
    error = np.abs(ours - theirs)
    bounds = np.broadcast_to(bound, error.shape)
    worst = np.unravel_index(np.argmax(error / np.maximum(bounds, np.finfo(np.float64).tiny)), error.shape)
    relative = np.max(error / np.maximum(1.0, np.abs(theirs)))
    return Comparison(
        model,
        quantity,
        oracle,
        unit,
        float(error[worst]),
        float(relative),
        float(bounds[worst]),
        len(error),
        bool(np.all(error <= bounds)),
    )
