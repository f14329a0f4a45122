"""Where a box is held: places by name, and the two of the default."""

from __future__ import annotations

from typing import Literal, get_args

# The bottom edge that faces its holder; underneath, in from that edge; a bottom corner of that edge; the middle of the
# holder's right or left side; a handle there, near the top.
Hold = Literal["edge", "bottom", "corner", "side", "handle"]
HOLDS: tuple[Hold, ...] = get_args(Hold)
Point = tuple[float, float, float]


def edge_grasps(depth: float, height: float, near: str = "human", far: str = "robot") -> dict[str, Point]:
    """Return the middles of the two bottom edges across X by who holds them: at -depth/2 and at +depth/2.

    Args:
        depth: of the box along X [m].
        height: along Z [m].
        near: who holds it at -depth/2.
        far: who holds it at +depth/2.
    """
    return {near: (-depth / 2.0, 0.0, -height / 2.0), far: (depth / 2.0, 0.0, -height / 2.0)}
