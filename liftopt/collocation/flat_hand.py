"""A flat hand under an edge: it pushes along the object's z axis and neither slides nor tips.

The conditions are linear in the wrench along the object's axes: the force lies in the pyramid that is inscribed in the
friction cone about z. Where the hand transmits moments too, the centre of pressure stays within half its breadth, and
the moment about z within what friction holds of a pressure that is even over a disc of that breadth, two thirds of
``friction * force * radius``; that limit stands apart from the pyramid's.
"""

from __future__ import annotations

import numpy as np

from liftopt.collocation.push import PushRows
from liftopt.multibody.agent import Grasp
from liftopt.types import Array


def flat_hand_rows(grasp: Grasp) -> tuple[PushRows, ...]:
    """Return the rows of a grasp; none if it grips."""
    if grasp.friction is None:
        return ()
    ways: tuple[str, ...] = ("ahead", "back", "left", "right")
    pyramid = grasp.friction / np.sqrt(2.0)
    rows = [PushRows("friction", ways, np.array([0, 0, 1, 1]), _pairs(2), np.full(4, pyramid))]
    if grasp.moments:
        ways = ("to the left", "to the right", "to the back", "to the front", "turn left", "turn right")
        half = grasp.breadth / 2.0
        shares = half * np.array([1.0, 1.0, 1.0, 1.0, *[2.0 / 3.0 * grasp.friction] * 2])
        rows.append(PushRows("pressure", ways, np.array([3, 3, 4, 4, 5, 5]), _pairs(3), shares))
    return tuple(rows)


def _pairs(count: int) -> Array:
    return np.tile([-1.0, 1.0], count)
