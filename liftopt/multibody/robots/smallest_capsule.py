"""A capsule around points that is as small as can be."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import chain

import numpy as np

from liftopt.types import Array

# Steps toward the middle of the smallest circle: what is left is 1 / steps of its radius at most.
CIRCLE_STEPS = 60
REFINEMENTS, FIRST_STEP = 40, 0.15  # of axis and middle: looked around with steps that halve [rad, share of the radius]


@dataclass(frozen=True)
class FittedCapsule:
    """A capsule from ``start`` to ``end`` (3,), the middles of its round ends, with a radius [m]."""

    start: Array
    end: Array
    radius: float

    @property
    def volume(self) -> float:
        """[m^3]."""
        length = float(np.linalg.norm(self.end - self.start))
        return float(np.pi * self.radius**2 * (length + 4.0 / 3.0 * self.radius))

    def outside(self, points: Array) -> Array:
        """Return how far points (n, 3) are outside [m], negative within."""
        along = self.end - self.start
        share = np.clip((points - self.start) @ along / max(float(along @ along), 1e-18), 0.0, 1.0)
        gap: Array = np.linalg.norm(points - self.start - share[:, None] * along, axis=1) - self.radius
        return gap


def smallest_capsule(points: Array) -> FittedCapsule:
    """Return a small capsule that holds all ``points`` (n, 3) [m]."""
    tried = (_along(points, axis, _middle(points, axis)) for axis in (*principal_axes(points), *np.eye(3)))
    return _refined(points, min(tried, key=lambda found: found.volume))


def rough_volumes(points: Array) -> tuple[float, float]:
    """Return the volumes of a capsule and of a box around ``points`` (n, 3) [m^3].

    Both are along their principal axes; the box is along those of the frame if that one is smaller.
    """
    own = (points - points.mean(axis=0)) @ principal_axes(points).T
    low, high = own.min(axis=0), own.max(axis=0)
    own -= (low + high) / 2.0
    squares = own**2
    across = squares.sum(axis=1)[:, None] - squares  # about each axis
    most = across.max(axis=0)
    room = np.sqrt(most - across)
    length = np.maximum((own - room).max(axis=0) - (own + room).min(axis=0), 0.0)
    capsules = np.pi * most * (length + 4.0 / 3.0 * np.sqrt(most))
    return float(capsules.min()), float(min(np.prod(high - low), np.prod(np.ptp(points, axis=0))))


def principal_axes(points: Array) -> Array:
    """Return the axes (3, 3), as rows, along which points (n, 3) extend most, next and least; right-handed."""
    centred = points - points.mean(axis=0)
    axes = np.linalg.eigh(centred.T @ centred)[1].T[::-1]
    return np.asarray(axes if np.linalg.det(axes) > 0.0 else -axes)


def _along(points: Array, axis: Array, middle: Array) -> FittedCapsule:
    """Return the smallest capsule whose axis goes through ``middle`` (3,) along ``axis`` (3,)."""
    offset = points - middle
    height = offset @ axis
    across = np.linalg.norm(offset - np.outer(height, axis), axis=1)
    radius = float(across.max())
    # Each point asks the round ends to reach so far and no less.
    room = np.sqrt(np.maximum(radius**2 - across**2, 0.0))
    low, high = float((height + room).min()), float((height - room).max())
    if low > high:  # one ball holds all
        low = high = (low + high) / 2.0
        radius = float(np.linalg.norm(offset - low * axis, axis=1).max())
    return FittedCapsule(middle + low * axis, middle + high * axis, radius)


def _middle(points: Array, axis: Array) -> Array:
    """Return the middle (3,) of nearly the smallest circle around points seen along an axis (Badoiu & Clarkson 2003)."""
    flat = points - np.outer(points @ axis, axis)
    middle = (flat.min(axis=0) + flat.max(axis=0)) / 2.0
    best, least = middle, np.inf
    for step in range(1, CIRCLE_STEPS + 1):
        gaps = np.einsum("ni,ni->n", flat - middle, flat - middle)
        farthest = int(np.argmax(gaps))
        if gaps[farthest] < least:
            best, least = middle, gaps[farthest]
        middle = middle + (flat[farthest] - middle) / (step + 1.0)
    return np.asarray(best)


def _refined(points: Array, found: FittedCapsule) -> FittedCapsule:
    """Return a capsule that is no larger, with another axis and middle if they are better."""
    along = found.end - found.start
    length = float(np.linalg.norm(along))
    axis = along / length if length > 1e-9 else np.array([0.0, 0.0, 1.0])
    middle, step = (found.start + found.end) / 2.0, FIRST_STEP
    for _ in range(REFINEMENTS):
        aside = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
        aside /= np.linalg.norm(aside)
        ways = (aside, np.cross(axis, aside))
        turned = ((axis + sign * step * way, middle) for way in ways for sign in (1.0, -1.0))
        moved = ((axis, middle + sign * step * found.radius * way) for way in ways for sign in (1.0, -1.0))
        tried = [(_along(points, a / np.linalg.norm(a), m), a / np.linalg.norm(a), m) for a, m in chain(turned, moved)]
        best = min(tried, key=lambda one: one[0].volume)
        if best[0].volume < found.volume * (1.0 - 1e-6):
            found, axis, middle = best
        else:
            step /= 2.0
            if step < 1e-3:
                break
    return found
