"""A line between the closest points of the nearest two bodies, with their distance in words."""

from __future__ import annotations

from typing import Any

import numpy as np

from liftopt.solution.clearance import Clearance
from liftopt.types import Array
from liftopt.viz.scene_arrow import from_z
from liftopt.viz.scene_commands import Command, set_object
from liftopt.viz.scene_mesh import ball, cylinder
from liftopt.viz.scene_part import Colour

LINE: Colour = (0.42, 0.62, 0.05)
RADIUS, END = 0.004, 0.008  # of the line and of the balls at its ends [m]
SMALLEST = 1e-4  # [m]: a node of size zero cannot be inverted


def nearest_at(clearance: Clearance | None, time: Array) -> dict[str, Any] | None:
    """Return the nearest two bodies at ``time`` (K,) [s]; None where nothing is known or nothing must keep apart.

    Returns:
        ``points`` (K, 2, 3) in the world, ``distance`` (K,) [m], and ``pairs``, which two they are in words, (K,).
    """
    nearest = None if clearance is None else clearance.between_bodies
    if clearance is None or nearest is None:
        return None
    # The sample that is nearest in time: between two samples another pair may be the nearest.
    middles = (clearance.time[1:] + clearance.time[:-1]) / 2.0
    k = np.searchsorted(middles, time)
    pairs = [clearance.pairs[i].told for i in nearest.pair[k]]
    return {"points": nearest.points[k], "distance": nearest.distance[k], "pairs": pairs}


def line_commands(root: str, opacity: float) -> list[Command]:
    """Return the commands that draw a line along z at ``root``, 1 m long and to be scaled, with a ball at each end."""
    shaft, end = cylinder((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), RADIUS, edge=0.001), ball((0.0, 0.0, 0.0), (END,) * 3)
    meshes = {"shaft": shaft, "start": end, "end": end}
    return [set_object(f"{root}/{name}/mesh", mesh, LINE, opacity, on_top=True) for name, mesh in meshes.items()]


def line_values(root: str, points: Array) -> dict[str, dict[str, Array]]:
    """Return what moves by node, for a line between ``points`` (K, 2, 3)."""
    along = points[:, 1] - points[:, 0]
    length = np.maximum(np.linalg.norm(along, axis=1), SMALLEST)
    scale, up = np.ones((len(points), 3)), np.zeros((len(points), 3))
    scale[:, 2] = up[:, 2] = length
    return {
        root: {"position": points[:, 0], "quaternion": from_z(along)},
        f"{root}/shaft": {"scale": scale},
        f"{root}/end": {"position": up},
    }
