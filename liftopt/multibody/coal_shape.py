"""Solids as coal's shapes, which measures how far they are apart."""

from __future__ import annotations

import coal
import numpy as np

from liftopt.multibody.solids import Solid


def coal_shape(solid: Solid) -> coal.ShapeBase:
    """Return coal's shape of a solid, in the solid's own frame."""
    if solid.kind == "half-space":
        return coal.Halfspace(np.array([0.0, 0.0, 1.0]), 0.0)
    return coal.Box(*solid.size) if solid.kind == "box" else coal.Capsule(*solid.size)
