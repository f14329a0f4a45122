"""A gripper with two fingers that close on an edge, on a flange; sizes are drawn by eye.

Its frame is behind the flange, as far as Sawyer's last link has its own, turned about the tool's axis z; it opens along
y.
"""

from __future__ import annotations

from math import radians

import numpy as np

from liftopt.multibody.robots.sawyer_description import FLANGE_IN_LAST_LINK
from liftopt.viz.digits import Digit
from liftopt.viz.scene_mesh import Mesh, Ring, block, cylinder, merged, tube
from liftopt.viz.scene_part import Colour, Part

BLACK: Colour = (0.07, 0.07, 0.08)
SILVER: Colour = (0.62, 0.63, 0.65)
FLANGE = float(FLANGE_IN_LAST_LINK[2])  # before the frame [m]
PALM = 0.45  # of the way from flange to grasp point: so long is the body
BESIDE = 0.030  # of a finger's hinge from the axis [m]
BEYOND = 0.022  # that a finger reaches past the grasp point [m]
THICK, BROAD = 0.0085, 0.016  # half axes of a finger's section [m]


def gripper_digits(length: float) -> tuple[Digit, ...]:
    """Return the two fingers of a gripper that is ``length`` long from flange to grasp point [m]."""
    palm, reach = FLANGE + PALM * length, (1.0 - PALM) * length
    along, bones = np.array([0.0, 0.0, 1.0]), (0.5 * reach, 0.5 * reach + BEYOND)
    return tuple(
        Digit(
            name, np.array([0.0, side * BESIDE, palm]), along, np.array([side, 0.0, 0.0]), bones, (THICK,) * 3,
            (radians(-95.0), 0.0), (radians(14.0), radians(40.0)),
        )
        for name, side in (("finger_a", 1.0), ("finger_b", -1.0))
    )  # fmt: skip


def gripper_parts(name: str, length: float) -> list[Part]:
    """Return body and fingers of the robot of that name, each in its own frame; nothing for the bare flange."""
    if length <= 0.0:
        return []
    palm = FLANGE + PALM * length
    body = [cylinder((0.0, 0.0, 0.018), (0.0, 0.0, FLANGE + 0.08 * length), 0.038)]
    body.append(block((0.0, 0.0, 0.5 * (FLANGE + palm)), (0.055, 0.095, palm - FLANGE), edge=0.012))
    parts = [Part(f"{name}_gripper", "gripper", BLACK, merged(body))]
    for digit in gripper_digits(length):
        for j, bone in enumerate(digit.bones):
            parts.append(Part(f"{name}_{digit.name}_{j + 1}", "bone", SILVER, _finger(bone)))
    return parts


def _finger(length: float) -> Mesh:
    """Return a flat bar along x, ``BROAD`` along z, the hinge's axis."""
    rings = [Ring((x, 0.0, 0.0), BROAD, THICK, 4.0) for x in (0.0, length)]
    return tube(rings, (0.0, 0.0, 1.0), round_start=THICK, round_end=THICK)
