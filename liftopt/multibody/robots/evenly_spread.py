"""Points that fill a cube evenly, the same ones every time."""

from __future__ import annotations

import numpy as np

from liftopt.types import Array


def evenly_spread(count: int, n: int) -> Array:
    """Return points (count, n) that fill the unit cube evenly.

    An additive recurrence, whose step is made of the powers of the generalised golden ratio (Roberts, 2018, "The
    unreasonable effectiveness of quasirandom sequences").
    """
    ratio = 2.0
    for _ in range(60):
        ratio = (1.0 + ratio) ** (1.0 / (n + 1))
    step = ratio ** -np.arange(1.0, n + 1)
    return np.asarray((0.5 + np.arange(1, count + 1)[:, None] * step) % 1.0)
