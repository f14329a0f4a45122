"""The shapes of a model in outline, as they are seen from one side: what plots and drawings are filled with."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from scipy.spatial import ConvexHull

from liftopt.types import Array

CIRCLE = 24  # points of a drawn circle
# World axes that point to the right, up and away from the reader, by where the reader stands.
VIEWS: dict[str, Array] = {
    "right": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]),  # of the person: X to the right
    "front": np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]]),  # of the person: Y to the right
    "behind": np.array([[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]),  # the person: Y to the left
    "above": np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]),
}


@dataclass(frozen=True)
class Outline:
    """One convex part as seen from one side.

    Attributes:
        polygon: (n, 2) to the right and up [m].
        depth: of its middle, larger is farther away [m].
        color: red, green, blue.
        link: index of the joint that carries it; 0 stands still.
    """

    polygon: Array
    depth: float
    color: tuple[float, float, float]
    link: int


def outlines(model: pin.Model, visual: pin.GeometryModel, q: Array, view: str = "right") -> Iterator[Outline]:
    """Yield the outline of every shape of a model at q (nq,), as seen from one of ``VIEWS``."""
    data, placements, axes = model.createData(), visual.createData(), VIEWS[view]
    pin.updateGeometryPlacements(model, data, visual, placements, q)
    for shape, placement in zip(visual.geometryObjects, placements.oMg, strict=True):
        seen = (_surface(shape.geometry) @ placement.rotation.T + placement.translation) @ axes.T
        side = seen[:, :2]
        red, green, blue, _ = shape.meshColor
        polygon = side[ConvexHull(side).vertices]
        yield Outline(polygon, float(seen[:, 2].mean()), (red, green, blue), int(shape.parentJoint))


def _surface(geometry: object) -> Array:
    """Return points (n, 3) whose convex hull is the shape, in its own frame."""
    half = getattr(geometry, "halfSide", None)
    if half is not None:
        corners = np.stack(np.meshgrid(*[(-1.0, 1.0)] * 3), axis=-1).reshape(-1, 3)
        return np.asarray(corners * half)
    radius = float(getattr(geometry, "radius"))  # noqa: B009  the base class has none
    length = getattr(geometry, "halfLength", None)
    angle = np.linspace(0.0, 2 * np.pi, CIRCLE, endpoint=False)
    ring = np.stack([np.cos(angle), np.sin(angle), np.zeros(CIRCLE)], axis=1) * radius
    if length is not None:
        end = np.array([0.0, 0.0, length])
        return np.concatenate([ring - end, ring + end])
    latitudes = np.linspace(-np.pi / 2, np.pi / 2, 2 * (CIRCLE // 4) + 1)
    pole = np.array([0.0, 0.0, radius])
    return np.concatenate([ring * np.cos(t) + pole * np.sin(t) for t in latitudes])
