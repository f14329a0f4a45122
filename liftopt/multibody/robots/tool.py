"""A tool on a robot's flange: a uniform cylinder along z, as heavy and as long as the scenario says."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from liftopt.multibody.dh import BodyInertia, rotation_z
from liftopt.multibody.robots.sawyer_shapes import TOOL_RADIUS
from liftopt.types import Array

UNTURNED = "z"
# Nearer to the last joint than this, or less plainly along one axis, where a frame is does not say where it points [m].
SHORTEST_LEVER, PLAINLY = 0.005, 0.9
AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def likely_direction(T_last_frame: Array) -> str:
    """Return along which axis of a grasp frame a hand is likely to point: away from the joint before it.

    Args:
        T_last_frame: (4, 4) the frame in that of the last link, whose origin is on the last joint's axis.
    """
    lever = T_last_frame[:3, :3].T @ T_last_frame[:3, 3]
    number, length = int(np.abs(lever).argmax()), float(np.linalg.norm(lever))
    if length < SHORTEST_LEVER or abs(lever[number]) < PLAINLY * length:
        return UNTURNED
    return ("" if lever[number] > 0.0 else "-") + "xyz"[number]


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
