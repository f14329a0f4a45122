"""How a hand lies on what it holds, by where it holds it: which way its fingers and its palm look.

Axes of the holder: X ahead, Y left, Z up. A hand's grasp frame has x against the fingers and y to the thumb; z is out
of the palm of a right hand, and out of the back of a left one, whose frame is the right one's mirror image.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from liftopt.multibody.edges import Hold
from liftopt.types import Array

Direction = tuple[float, float, float]
HALF = float(np.sqrt(0.5))
# Where the fingers of a right hand point, and where its palm looks. Under an edge or the bottom the palm is up and the
# fingers ahead; at a corner they point in towards the middle as well. On the sides both palms look at each other, the
# fingers ahead and down. In a handle, a bar along X, the fist hangs: palm inwards, thumb ahead; around one that is
# higher than the elbow it comes from below, thumb behind. About the bar it turns as it likes (``Grasp.bar``). All are
# choices of this model, as a person who stands before a box would hold it; a grasp may turn from there
# (``Grasp.max_turn``).
RIGHT_HAND: dict[Hold, tuple[Direction, Direction]] = {
    "edge": ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    "bottom": ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    "corner": ((HALF, HALF, 0.0), (0.0, 0.0, 1.0)),
    "side": ((HALF, 0.0, -HALF), (0.0, 1.0, 0.0)),
    "handle": ((0.0, 0.0, -1.0), (0.0, 1.0, 0.0)),
}
FROM_BELOW: tuple[Direction, Direction] = ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0))


def hand_on(hold: Hold, hand: Literal["right", "left"], from_below: bool = False) -> Array:
    """Return R_holder_hand (3, 3): the grasp frame of a hand on a level object, in the axes of who holds it.

    Args:
        hold: how it holds.
        hand: which.
        from_below: whether the fist around a handle comes from below.
    """
    fingers, palm = (np.array(direction) for direction in (FROM_BELOW if from_below else RIGHT_HAND[hold]))
    frame = np.column_stack([-fingers, np.cross(fingers, palm), palm]) + 0.0  # no negative zeros
    if hand == "right":
        return frame
    return np.asarray(np.diag([1.0, -1.0, 1.0]) @ frame @ np.diag([1.0, 1.0, -1.0])) + 0.0


def along_bar(hand: Array) -> Array:
    """Return the direction (3,) of the bar that a hand with axes (3, 3) is closed around: to the thumb."""
    return np.asarray(hand[:, 1])
