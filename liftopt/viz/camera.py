"""From where a picture is taken: what of the world is where on it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from liftopt.types import Array

OPENING = 28.0  # of the lens, top to bottom [deg]: narrow, so that near things are not drawn out of proportion
FAR, HALVINGS = 100.0, 40


@dataclass(frozen=True)
class Camera:
    """A camera that looks at the world, straight or in perspective.

    Attributes:
        eye: (3,) where it stands [m]; without perspective anywhere before what it sees.
        axes: (3, 3) rows: to the right, down, and ahead, world axes.
        scale: pixels a metre: at any distance without perspective, at 1 m with it.
        middle: (2,) the pixel that it looks at, x to the right and y down.
        perspective: whether what is far is small.
    """

    eye: Array
    axes: Array
    scale: float
    middle: tuple[float, float]
    perspective: bool

    def project(self, points: Array) -> Array:
        """Return ``points`` (..., 3) on the picture: x, y [pixels] and a depth that is linear on it and grows ahead."""
        seen = (points - self.eye) @ self.axes.T
        ahead = np.maximum(seen[..., 2:], 1e-6)
        if self.perspective:
            return np.concatenate([self.middle + self.scale * seen[..., :2] / ahead, -1.0 / ahead], axis=-1)
        return np.concatenate([self.middle + self.scale * seen[..., :2], seen[..., 2:]], axis=-1)

    def rays(self, size: tuple[int, int]) -> tuple[Array, Array]:
        """Return for every pixel of a picture of that width and height a point (H, W, 3) and where it looks (H, W, 3).

        The looks are as long as one unit of depth ahead, which is a metre.
        """
        width, height = size
        across, down = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
        offset = np.stack([across - self.middle[0], down - self.middle[1]], axis=-1) / self.scale
        aside = offset @ self.axes[:2]
        if self.perspective:
            return np.broadcast_to(self.eye, aside.shape), aside + self.axes[2]
        return self.eye + aside, np.broadcast_to(self.axes[2], aside.shape)

    def larger(self, factor: int) -> Camera:
        """Return the camera of a picture with ``factor`` times as many pixels each way."""
        x, y = self.middle
        return Camera(self.eye, self.axes, self.scale * factor, (factor * x, factor * y), self.perspective)


def straight(side: npt.ArrayLike, low: Array, high: Array, size: tuple[int, int]) -> Camera:
    """Return a camera without perspective that looks from ``side`` (3,) and fits a box of the world into a picture.

    Args:
        side: from where, as seen from the box.
        low: (3,) corner of the box [m].
        high: (3,) the other corner.
        size: width and height of the picture [pixels].
    """
    axes = _axes(np.asarray(side, float))
    seen = _corners(low, high) @ axes.T
    least, most = seen.min(axis=0), seen.max(axis=0)
    scale = float(np.min(np.array(size) / (most - least)[:2]))
    middle = (least + most) / 2.0
    eye = axes.T @ np.array([middle[0], middle[1], least[2] - 1.0])
    return Camera(eye, axes, scale, (size[0] / 2.0, size[1] / 2.0), False)


def in_perspective(side: npt.ArrayLike, low: Array, high: Array, size: tuple[int, int]) -> Camera:
    """Return a camera with perspective; arguments as ``straight``."""
    axes = _axes(np.asarray(side, float))
    scale = size[1] / (2.0 * np.tan(np.radians(OPENING) / 2.0))
    tangents = np.array(size) / (2.0 * scale)
    seen = (_corners(low, high) - (np.asarray(low) + high) / 2.0) @ axes.T
    near, far = float(-seen[:, 2].min()) + 1e-3, FAR
    for _ in range(HALVINGS):
        distance = (near + far) / 2.0
        room = (distance + seen[:, 2:]) * tangents
        # The camera may move aside and up: all corners must fit in between.
        fits = np.all((seen[:, :2] - room).max(axis=0) <= (seen[:, :2] + room).min(axis=0))
        near, far = (near, distance) if fits else (distance, far)
    room = (far + seen[:, 2:]) * tangents
    aside = ((seen[:, :2] - room).max(axis=0) + (seen[:, :2] + room).min(axis=0)) / 2.0
    eye = (np.asarray(low) + high) / 2.0 + axes.T @ np.array([aside[0], aside[1], -far])
    return Camera(eye, axes, scale, (size[0] / 2.0, size[1] / 2.0), True)


def _axes(side: Array) -> Array:
    """Return to the right, down and ahead (3, 3) of one who looks from ``side`` (3,); straight down, x is up."""
    ahead = -side / np.linalg.norm(side)
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    if np.linalg.norm(right) < 1e-9:
        right = np.array([0.0, -1.0, 0.0])
    right = right / np.linalg.norm(right)
    return np.stack([right, np.cross(ahead, right), ahead])


def _corners(low: Array, high: Array) -> Array:
    box = np.stack([low, high])
    return np.array([[box[i, 0], box[j, 1], box[k, 2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
