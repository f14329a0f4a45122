"""A tool on a robot's flange: a uniform cylinder along z, as heavy and as long as the scenario says."""

from __future__ import annotations

import numpy as np

from liftopt.multibody.dh import BodyInertia
from liftopt.multibody.robots.sawyer_shapes import TOOL_RADIUS


def tool_body(length: float, mass: float) -> BodyInertia:
    """Return a uniform cylinder along z from the flange, in the flange's frame; ``length`` [m], ``mass`` [kg]."""
    across = mass * (3.0 * TOOL_RADIUS**2 + length**2) / 12.0
    inertia = np.diag([across, across, mass * TOOL_RADIUS**2 / 2.0])
    return BodyInertia(float(mass), np.array([0.0, 0.0, length / 2.0]), inertia)
