"""Solids as coal's shapes, which measures how far they are apart."""

from __future__ import annotations

import coal
import numpy as np

from liftopt.multibody.solids import Solid

SLANTING = np.array([[2.0, -2.0, 1.0], [1.0, 2.0, 2.0], [-2.0, -1.0, 2.0]]) / 3.0  # a rotation without a zero


def coal_shape(solid: Solid) -> coal.ShapeBase:
    """Return coal's shape of a solid, in the solid's own frame."""
    if solid.kind == "half-space":
        return coal.Halfspace(np.array([0.0, 0.0, 1.0]), 0.0)
    if solid.kind == "capsule":
        return coal.Capsule(*solid.size)
    _settle_boxes()
    return coal.Box(*solid.size)


def _settle_boxes() -> None:
    """Let distances from boxes not depend on which pair of a process was the first.

    For a whole process coal 3.0 makes boxes larger by a share of 1e-10, or does not, as the direction has a zero or
    not in which the first corner of a box is looked for. Here that one has none.
    """
    capsule, box = coal.Capsule(0.1, 1.0), coal.Box(1.0, 1.0, 1.0)
    there, at_origin = coal.Transform3s(SLANTING, np.array([3.0, 1.0, 2.0])), coal.Transform3s.Identity()
    coal.distance(capsule, at_origin, box, there, coal.DistanceRequest(), coal.DistanceResult())
