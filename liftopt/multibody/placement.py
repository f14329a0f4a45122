"""Where an agent stands on the floor, and which way it faces."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, radians

import numpy as np

from liftopt.multibody.dh import rotation_z, translation
from liftopt.types import Array


@dataclass(frozen=True)
class Placement:
    """A point on the floor and a direction.

    Attributes:
        x, y: in the world [m].
        yaw: from the world's X about Z [rad].
    """

    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0

    @classmethod
    def at(cls, x: float, y: float, yaw_deg: float) -> Placement:
        """Return the placement at a point [m] and an angle [deg]."""
        return cls(x, y, radians(yaw_deg))

    @property
    def T_world_base(self) -> Array:
        """(4, 4) placement in the world of a frame that has Z up and X ahead."""
        return translation(self.x, self.y, 0.0) @ rotation_z(self.yaw)

    @property
    def ahead(self) -> Array:
        """(3,) unit vector of the direction, world axes."""
        return np.asarray(rotation_z(self.yaw)[:3, 0], dtype=np.float64)


def facing(distance: float) -> Placement:
    """Return where somebody stands who faces a person at the origin from ``distance`` [m] ahead."""
    return Placement(distance, 0.0, pi)
