"""Fingers that close on a box until they touch it: those of a hand and those of a gripper."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftopt.types import Array

# Angles that are tried between open and closed, and again in the step in which it touches.
COARSE, FINE = 16, 7
SLACK = 2e-4  # a bone that is no deeper is outside: one that touches stays free to move on [m]
ALONG = np.linspace(0.0, 1.0, 8)[1:]  # where a bone is looked at, as shares of its length


@dataclass(frozen=True)
class Digit:
    """Bones in a row that bend about parallel hinges, in the frame of what carries them (its palm).

    Attributes:
        name: unique on its palm.
        root: (3,) of the first hinge [m].
        heading: (3,) unit vector along all bones while every angle is zero.
        hinge: (3,) unit vector across it; positive angles close.
        bones: n lengths from the root on [m].
        radii: n + 1 of the flesh, at the root and at the end of each bone [m].
        opened, closed: n angles between which each hinge moves [rad].
    """

    name: str
    root: Array
    heading: Array
    hinge: Array
    bones: tuple[float, ...]
    radii: tuple[float, ...]
    opened: tuple[float, ...]
    closed: tuple[float, ...]

    def points(self, angles: Array) -> Array:
        """Return root and ends of the bones (..., n + 1, 3) at ``angles`` (..., n), in the palm's frame."""
        turned = np.cumsum(angles, axis=-1)[..., None]
        along = np.cos(turned) * self.heading + np.sin(turned) * np.cross(self.hinge, self.heading)
        steps = np.cumsum(along * np.array(self.bones)[:, None], axis=-2)
        return np.concatenate([np.broadcast_to(self.root, (*steps.shape[:-2], 1, 3)), self.root + steps], axis=-2)

    def frames(self, angles: Array) -> Array:
        """Return T_palm_bone (K, n, 4, 4) at ``angles`` (K, n): x along the bone from its hinge, z along the hinge."""
        points, turned = self.points(angles), np.cumsum(angles, axis=-1)[..., None]
        aside = np.cross(self.hinge, self.heading)
        placements = np.tile(np.eye(4), (*angles.shape, 1, 1))
        placements[..., :3, 0] = np.cos(turned) * self.heading + np.sin(turned) * aside
        placements[..., :3, 1] = np.cos(turned) * aside - np.sin(turned) * self.heading
        placements[..., :3, 2] = self.hinge
        placements[..., :3, 3] = points[..., :-1, :]
        return placements


def closed_on(digit: Digit, T_box_palm: Array, half: Array) -> Array:
    """Return the angles (K, n) at which a digit that closes touches a box: hinge after hinge, from the palm outwards.

    A hinge that meets nothing closes to its end; one that is never out of the box stays where it is in it the least.

    Args:
        digit: what closes.
        T_box_palm: (K, 4, 4) the palm's frame in the box's, at its centre.
        half: (3,) half sizes of the box [m].
    """
    angles = np.zeros((len(T_box_palm), len(digit.bones)))
    for j, (opened, closed) in enumerate(zip(digit.opened, digit.closed, strict=True)):
        tried = np.tile(np.linspace(opened, closed, COARSE), (len(angles), 1))
        apart = _clearance(digit, angles, tried, j, T_box_palm, half)
        before = _last_before_touch(apart)
        steps = np.linspace(0.0, 1.0, FINE)
        low, high = (
            np.take_along_axis(tried, k[:, None], axis=1) for k in (before, np.minimum(before + 1, COARSE - 1))
        )
        tried = low + steps * (high - low)
        apart = _clearance(digit, angles, tried, j, T_box_palm, half)
        angles[:, j] = [float(_touch(*rows)) for rows in zip(tried, apart, strict=True)]
    return angles


def distance_to_box(points: Array, half: Array) -> Array:
    """Return the distance of ``points`` (..., 3) from a box about the origin, negative inside [m]."""
    return _distance([np.abs(points[..., i]) - half[i] for i in range(3)])


def _distance(beyond: list[Array]) -> Array:
    """Return the distance from a box (...), given how far along each of its axes a point is beyond its faces."""
    x, y, z = (np.maximum(one, 0.0) for one in beyond)
    inside = np.minimum(np.maximum(np.maximum(beyond[0], beyond[1]), beyond[2]), 0.0)
    return np.asarray(np.sqrt(x * x + y * y + z * z) + inside)


def _clearance(digit: Digit, angles: Array, tried: Array, j: int, T_box_palm: Array, half: Array) -> Array:
    """Return how far bone ``j`` and those beyond it are outside the box (K, C) at angles ``tried`` (K, C) of hinge j.

    Args:
        digit: what closes.
        angles: (K, n); those from ``j`` on count as zero.
        tried: (K, C) [rad].
        j: the hinge.
        T_box_palm: (K, 4, 4) the palm's frame in the box's.
        half: (3,) half sizes of the box [m].
    """
    rotation = T_box_palm[:, :3, :3]
    root = np.einsum("kij,kj->ki", rotation, digit.points(angles)[:, j]) + T_box_palm[:, :3, 3]
    along, aside = rotation @ digit.heading, rotation @ np.cross(digit.hinge, digit.heading)
    turned = tried + angles[:, :j].sum(axis=1, keepdims=True)
    cosine, sine = np.cos(turned)[..., None], np.sin(turned)[..., None]
    bones, radii = np.array(digit.bones[j:]), np.array(digit.radii[j:])
    starts = np.cumsum(bones) - bones
    away = (starts[:, None] + bones[:, None] * ALONG).ravel()  # bones beyond are straight
    flesh = (radii[:-1, None] + (radii[1:] - radii[:-1])[:, None] * ALONG).ravel()
    beyond = [
        np.abs(root[:, i, None, None] + away * (cosine * along[:, i, None, None] + sine * aside[:, i, None, None]))
        - half[i]
        for i in range(3)
    ]
    return np.asarray((_distance(beyond) - flesh).min(axis=-1))


def _last_before_touch(apart: Array) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    """Return which candidate (K,) comes before the first touch after it was free; of never free the least deep one."""
    free = apart > -SLACK
    first = np.argmax(free, axis=1)
    touching = ~free & (np.arange(apart.shape[1]) > first[:, None])
    before = np.where(touching.any(axis=1), np.argmax(touching, axis=1) - 1, apart.shape[1] - 1)
    return np.asarray(np.where(free.any(axis=1), before, np.argmax(apart, axis=1)), dtype=np.int64)


def _touch(tried: Array, apart: Array) -> float:
    """Return where in a step the clearance falls to zero; its start where it does not, or where it never was free."""
    touching = np.flatnonzero(apart <= 0.0)
    if not len(touching) or touching[0] == 0:
        return float(tried[0])
    k = int(touching[0])
    return float(tried[k - 1] + apart[k - 1] / (apart[k - 1] - apart[k]) * (tried[k] - tried[k - 1]))
