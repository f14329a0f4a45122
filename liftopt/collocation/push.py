"""What only pushes, and neither slides nor tips: rows that are linear in its wrench."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from liftopt.types import Array

PUSH = 2  # which component of the wrench


@dataclass(frozen=True)
class PushRows:
    """Rows ``sign * wrench[component] + share * wrench[PUSH] >= 0``.

    Attributes:
        name: of the rows, a ``Block``'s.
        labels: (m,) which way it would slide or tip.
        components, signs, shares: (m,) each.
    """

    name: str
    labels: tuple[str, ...]
    components: npt.NDArray[np.int64]
    signs: Array
    shares: Array

    def room(self, wrench: Array) -> Array:
        """Return the rows' values (K, m), negative where they do not hold.

        Args:
            wrench: (K, 6) force and moment, the force that pushes along z.
        """
        return np.asarray(self.signs * wrench[:, self.components] + self.shares * wrench[:, [PUSH]])
