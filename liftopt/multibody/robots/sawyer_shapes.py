"""What Sawyer looks like: primitive shapes along the manufacturer's joint offsets, with radii drawn by proportion."""

from __future__ import annotations

import numpy as np

from liftopt.multibody.robots.sawyer_description import FLANGE_IN_LAST_LINK, HEAD_IN_FIRST_LINK, JOINTS
from liftopt.multibody.shapes import Capsule, Colour, Cylinder, Shape, box_at

RED = Colour("robot_red", (0.62, 0.09, 0.10, 1.0))
GREY = Colour("robot_grey", (0.30, 0.31, 0.33, 1.0))
BLACK = Colour("robot_black", (0.08, 0.08, 0.09, 1.0))
# Radius of each link, right_l0 to right_l5 [m].
RADII = (0.075, 0.065, 0.058, 0.055, 0.048, 0.045)
FOOT_SIZE = (0.60, 0.60, 0.04)
TOOL_RADIUS = 0.035


def link_shapes() -> list[tuple[Shape, ...]]:
    """Return the shapes of right_l0 to right_l6, each in the manufacturer's link frame."""
    shapes: list[tuple[Shape, ...]] = []
    for index, radius in enumerate(RADII):
        # Every next joint lies off along one axis and then along another: a bent tube of two capsules.
        tip = np.array(JOINTS[index + 1].xyz)
        corner = np.array([0.0, 0.0, tip[2]])
        tube = [Capsule(f"link_{index}_tube", RED, np.zeros(3), corner, radius)]
        if np.linalg.norm(tip - corner) > radius / 2.0:
            tube.append(Capsule(f"link_{index}_joint", GREY, corner, tip, radius))
        shapes.append(tuple(tube) + (_head() if index == 0 else ()))
    flange = np.array(FLANGE_IN_LAST_LINK)
    shapes.append((Cylinder("flange", BLACK, np.array([0.0, 0.0, -0.03]), flange, 0.04),))
    return shapes


def stand_shapes(base_height: float) -> tuple[Shape, ...]:
    """Return pedestal and arm base in the manufacturer's base frame, ``base_height`` [m] above the floor."""
    floor, plate = np.array([0.0, 0.0, -base_height]), np.array([0.0, 0.0, FOOT_SIZE[2]])
    top = np.array(JOINTS[0].xyz)
    return (
        box_at("pedestal_foot", GREY, floor + plate / 2.0, FOOT_SIZE),
        Cylinder("pedestal_column", GREY, floor + plate, np.zeros(3), 0.11),
        Cylinder("arm_base", BLACK, np.zeros(3), top, 0.10),
    )


def tool_shapes(length: float) -> tuple[Shape, ...]:
    """Return a gripper ``length`` [m] long, from the flange along z."""
    if length == 0.0:
        return ()
    return (Cylinder("gripper", BLACK, np.zeros(3), np.array([0.0, 0.0, length]), TOOL_RADIUS),)


def _head() -> tuple[Shape, ...]:
    neck = np.array(HEAD_IN_FIRST_LINK)
    return (
        Capsule("head_neck", GREY, neck, neck + np.array([0.0, 0.0, 0.05]), 0.04),
        box_at("head_screen", BLACK, neck + np.array([0.03, 0.0, 0.13]), (0.04, 0.25, 0.16)),
    )
