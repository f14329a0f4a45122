"""The centre of pressure under a person's feet: a small disc on the floor that moves over the lift."""

from __future__ import annotations

import numpy as np

from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.types import Array
from liftopt.viz.scene_mesh import cylinder
from liftopt.viz.scene_part import Colour, Part

RADIUS, LOW, HIGH = 0.022, 0.004, 0.010  # of the disc, and between which heights it lies [m]


def pressure_body(person: str) -> str:
    """Return the name of the body that the disc is."""
    return f"{person}_pressure"


def pressure_part(person: str, colour: Colour) -> Part:
    """Return the disc at the origin of the person's feet."""
    return Part(pressure_body(person), "disc", colour, cylinder((0.0, 0.0, LOW), (0.0, 0.0, HIGH), RADIUS, edge=0.002))


def pressure_placements(person: AgentTrajectory, T_world_base: Array, knots: Array, time: Array) -> Array | None:
    """Return T_world_disc (K, 4, 4); None of one who does not stand on soles, or whom the floor never bears.

    Args:
        person: whose feet they are.
        T_world_base: (4, 4) of the feet.
        knots: times of the motion [s].
        time: (K,) [s].
    """
    pressure = person.centre_of_pressure
    if pressure is None:
        return None
    borne = np.isfinite(pressure).all(axis=1)
    if not borne.any():
        return None
    placed = np.tile(T_world_base, (len(time), 1, 1))
    for axis in range(2):
        placed[:, axis, 3] = np.interp(time, knots[borne], pressure[borne, axis])
    return placed
