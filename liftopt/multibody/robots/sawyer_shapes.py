"""Sawyer's shapes, drawn and collided with: primitives along the manufacturer's joint offsets.

Radii and extents are those of the manufacturer's own meshes to some millimetres: sawyer_robot, commit d1ef3d0,
sawyer_description/meshes/sawyer_pv (Apache-2.0).
"""

from __future__ import annotations

import numpy as np

from liftopt.multibody.robots.sawyer_description import FLANGE_IN_LAST_LINK, HEAD_IN_FIRST_LINK, JOINTS
from liftopt.multibody.shapes import Capsule, Colour, Cylinder, Shape, box_at

RED = Colour("robot_red", (0.62, 0.09, 0.10, 1.0))
GREY = Colour("robot_grey", (0.30, 0.31, 0.33, 1.0))
BLACK = Colour("robot_black", (0.08, 0.08, 0.09, 1.0))
# Radius of each link, right_l0 to right_l5 [m].
RADII = (0.082, 0.065, 0.058, 0.055, 0.048, 0.045)
FOOT_SIZE, FOOT_BEHIND = (0.78, 0.69, 0.24), 0.125  # of the box around the pedestal's legs, and its middle [m]
CONTROLLER_SIZE, CONTROLLER_BEHIND = (0.21, 0.35), 0.325  # of the box behind the pedestal [m]
CONTROLLER_BELOW, LEAST_CONTROLLER = 0.10, 0.3  # its top below the arm, and its least height [m]
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
            # The shoulder's hub reaches to both sides of the first link.
            end = np.array([tip[0], 0.0, tip[2]]) if index == 0 else tip
            tube.append(Capsule(f"link_{index}_joint", GREY, corner, end, radius))
        shapes.append(tuple(tube) + (_head() if index == 0 else ()))
    flange, aside = np.array(FLANGE_IN_LAST_LINK), np.array([0.0, 0.012, 0.0])  # the wrist is not round
    shapes.append((Cylinder("flange", BLACK, aside + np.array([0.0, 0.0, -0.03]), aside + flange, 0.052),))
    return shapes


def stand_shapes(base_height: float) -> tuple[Shape, ...]:
    """Return pedestal and arm base in the manufacturer's base frame, ``base_height`` [m] above the floor."""
    foot = min(FOOT_SIZE[2], base_height / 2.0)
    floor, on_foot, top = (np.array([0.0, 0.0, z]) for z in (-base_height, foot - base_height, JOINTS[0].xyz[2]))
    shapes: list[Shape] = [
        box_at(
            "pedestal_foot", GREY, (floor + on_foot) / 2.0 - np.array([FOOT_BEHIND, 0.0, 0.0]), (*FOOT_SIZE[:2], foot)
        ),
        Cylinder("pedestal_column", GREY, on_foot, np.zeros(3), 0.11),
        Cylinder("arm_base", BLACK, np.zeros(3), top, 0.10),
    ]
    height = base_height - foot - CONTROLLER_BELOW
    if height > LEAST_CONTROLLER:
        middle = np.array([-CONTROLLER_BEHIND, 0.0, -CONTROLLER_BELOW - height / 2.0])
        shapes.append(box_at("controller", BLACK, middle, (*CONTROLLER_SIZE, height)))
    return tuple(shapes)


def tool_shapes(length: float) -> tuple[Shape, ...]:
    """Return a gripper ``length`` [m] long, from the flange along z."""
    if length == 0.0:
        return ()
    return (Cylinder("gripper", BLACK, np.zeros(3), np.array([0.0, 0.0, length]), TOOL_RADIUS),)


def _head() -> tuple[Shape, ...]:
    neck = np.array(HEAD_IN_FIRST_LINK)
    return (
        Capsule("head_neck", GREY, neck, neck + np.array([0.0, 0.0, 0.05]), 0.04),
        box_at("head", BLACK, neck + np.array([-0.005, 0.0, 0.115]), (0.075, 0.256, 0.235)),
    )
