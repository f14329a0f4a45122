"""What a robot's base is bolted to: a pedestal on the floor, or a plate on a wall or a ceiling."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from liftopt.multibody.shapes import Box, Colour, Cylinder, Shape, box_at
from liftopt.types import Array

STAND = "stand_"  # begins the names of these shapes
GREY = Colour("robot_stand", (0.36, 0.37, 0.39, 1.0))
ON_FLOOR = 0.03  # [m]: whatever is no higher stands on the floor
SOLE = 0.06  # [m] above its lowest point: what of the base rests on the stand
BELOW = 0.2  # [m] from the middle: so far is below it
STEEP = np.cos(np.radians(45.0))  # of a base that leans farther than that, the stand is a plate behind it
BROAD = 0.45  # [m]: what is broader stands on a platform, not on a column
THIN, THICK = 0.06, 0.14  # radius of a column [m]
FOOT, PLATE = 0.025, 0.03  # how thick they are [m]
BEYOND = 0.05  # that a platform or a plate reaches beyond what it carries [m]
LEAST = 0.15  # edge of a plate, and radius of a foot [m]


def robot_stand(T_world_base: Array, base: Array) -> tuple[Shape, ...]:
    """Return the stand in the base's frame; nothing of a robot that stands on the floor.

    Args:
        T_world_base: (4, 4) placement of the base link.
        base: (n, 3) points of all that does not move, in its frame; at least one [m].
    """
    if T_world_base[2, 2] < STEEP:
        return tuple(_plate(base))
    points = base @ T_world_base[:3, :3].T + T_world_base[:3, 3]
    if points[:, 2].min() <= ON_FLOOR:
        return ()
    # What is lowest may hang beside it, as an arm does: it stands on what is below its middle.
    below = points[np.linalg.norm(points[:, :2] - T_world_base[:2, 3], axis=1) < BELOW]
    if len(below) and below[:, 2].min() > points[:, 2].min() + SOLE:
        points = below
    low, high, lowest = _sole(points)
    T_base_world = np.asarray(np.linalg.inv(T_world_base))
    return tuple(shape.seen_from(T_base_world) for shape in _pedestal((low + high) / 2.0, high - low, lowest))


def _sole(points: Array) -> tuple[Array, Array, float]:
    """Return the corners (2,) around the lowest of points (n, 3), seen from above, and the height of the lowest one."""
    lowest = float(points[:, 2].min())
    sole = points[points[:, 2] < lowest + SOLE, :2]
    return sole.min(axis=0), sole.max(axis=0), lowest


def _pedestal(middle: Array, extent: Array, height: float) -> Iterator[Shape]:
    """Give the shapes of a pedestal up to ``height`` [m], in the world, for what rests on it with an extent (2,)."""
    broadest = float(extent.max())
    if broadest > BROAD or height < 4.0 * FOOT:
        size = (*(extent + 2.0 * BEYOND).tolist(), height)
        yield box_at(f"{STAND}platform", GREY, np.array([*middle, height / 2.0]), size)
        return
    radius = float(np.clip(broadest / 2.0, THIN, THICK))
    edge = 2.0 * max(2.0 * radius, LEAST)
    yield box_at(f"{STAND}foot", GREY, np.array([*middle, FOOT / 2.0]), (edge, edge, FOOT))
    yield Cylinder(f"{STAND}column", GREY, np.array([*middle, FOOT]), np.array([*middle, height]), radius)


def _plate(base: Array) -> Iterator[Shape]:
    """Give a plate behind the base, in its frame."""
    low, high, lowest = _sole(base)
    size = np.maximum(high - low + 2.0 * BEYOND, LEAST)
    placement = np.eye(4)
    placement[:3, 3] = [*((low + high) / 2.0), lowest - PLATE / 2.0]
    yield Box(f"{STAND}plate", GREY, placement, (float(size[0]), float(size[1]), PLATE))
