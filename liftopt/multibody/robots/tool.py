"""A tool on a robot's flange: a uniform cylinder along z, as heavy and as long as the scenario says."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from liftopt.multibody.dh import BodyInertia, rotation_z
from liftopt.multibody.robots.sawyer_shapes import TOOL_RADIUS
from liftopt.types import Array

UNTURNED = "z"
AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def along(direction: str, turn: float = 0.0) -> Array:
    """Return T_frame_tool (4, 4) of a tool along an axis of a grasp frame, ``"z"`` or ``"-x"``: its own z axis.

    It is the least turn that brings z there, for ``"-z"`` half a turn about x, and then ``turn`` [rad] about it.
    """
    turned = np.eye(4)
    axis = np.array(AXES[direction[-1]])
    if direction == "-z":
        turned[:3, :3] = np.diag([1.0, -1.0, -1.0])
    elif direction != UNTURNED:
        turned[:3, :3] = np.round(
            pin.Quaternion.FromTwoVectors(np.array(AXES["z"]), -axis if direction[0] == "-" else axis).matrix()
        )
    return np.asarray(turned @ rotation_z(turn)) if turn else turned + 0.0


def tool_body(length: float, mass: float) -> BodyInertia:
    """Return a uniform cylinder along z from the flange, in the flange's frame; ``length`` [m], ``mass`` [kg]."""
    across = mass * (3.0 * TOOL_RADIUS**2 + length**2) / 12.0
    inertia = np.diag([across, across, mass * TOOL_RADIUS**2 / 2.0])
    return BodyInertia(float(mass), np.array([0.0, 0.0, length / 2.0]), inertia)
