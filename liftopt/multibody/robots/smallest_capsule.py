"""A capsule around points that is as small as can be."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftopt.multibody.trajectory import cross
from liftopt.types import Array

# Steps toward the middle of the smallest circle: what is left is 1 / steps of its radius at most.
CIRCLE_STEPS = 60
# Of axis and middle: looked around with steps that halve [rad, share of the radius].
REFINEMENTS, FIRST_STEP, FINEST = 40, 0.15, 0.004


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


def smallest_capsule(points: Array) -> FittedCapsule:
    """Return a small capsule that holds all ``points`` (n, 3) [m]."""
    axes = np.concatenate([principal_axes(points), np.eye(3)])
    tried = _Tried.along(points, axes, _middles(points, axes))
    return _refined(points, tried).capsule


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


@dataclass(frozen=True)
class _Tried:
    """The best of capsules with axes and middles that were tried."""

    axis: Array
    middle: Array
    low: float
    high: float
    radius: float
    volume: float

    @property
    def capsule(self) -> FittedCapsule:
        return FittedCapsule(self.middle + self.low * self.axis, self.middle + self.high * self.axis, self.radius)

    @staticmethod
    def along(points: Array, axes: Array, middles: Array) -> _Tried:
        """Return the smallest of the capsules whose axes go through ``middles`` (k, 3) along ``axes`` (k, 3)."""
        offset = points - middles[:, None]
        height = np.einsum("kni,ki->kn", offset, axes)
        squares = np.einsum("kni,kni->kn", offset, offset)
        across = np.maximum(squares - height**2, 0.0)
        most = across.max(axis=1)
        # Each point asks the round ends to reach so far and no less.
        room = np.sqrt(np.maximum(most[:, None] - across, 0.0))
        low, high = (height + room).min(axis=1), (height - room).max(axis=1)
        ball = low > high  # one holds all
        low = np.where(ball, (low + high) / 2.0, low)
        high = np.where(ball, low, high)
        own = squares - 2.0 * low[:, None] * height + low[:, None] ** 2
        radius = np.sqrt(np.where(ball, own.max(axis=1), most))
        volume = np.pi * radius**2 * (high - low + 4.0 / 3.0 * radius)
        k = int(np.argmin(volume))
        return _Tried(axes[k], middles[k], float(low[k]), float(high[k]), float(radius[k]), float(volume[k]))


def _middles(points: Array, axes: Array) -> Array:
    """Return for each axis (k, 3) the middle of nearly the smallest circle around points seen along it.

    It goes toward the farthest point by ever shorter steps (Badoiu & Clarkson 2003).
    """
    flat = points - np.einsum("ni,ki->kn", points, axes)[:, :, None] * axes[:, None]
    middle = (flat.min(axis=1) + flat.max(axis=1)) / 2.0
    best, least, each = middle.copy(), np.full(len(axes), np.inf), np.arange(len(axes))
    for step in range(1, CIRCLE_STEPS + 1):
        offset = flat - middle[:, None]
        gaps = np.einsum("kni,kni->kn", offset, offset)
        farthest = np.argmax(gaps, axis=1)
        better = gaps[each, farthest] < least
        best[better], least[better] = middle[better], gaps[each, farthest][better]
        middle = middle + offset[each, farthest] / (step + 1.0)
    return np.asarray(best)


def _refined(points: Array, found: _Tried) -> _Tried:
    """Return a capsule that is no larger, with another axis and middle if they are better."""
    step = FIRST_STEP
    for _ in range(REFINEMENTS):
        axis = found.axis
        aside = cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
        aside /= np.linalg.norm(aside)
        other = cross(axis, aside)
        ways = np.array([aside, other, -aside, -other])
        middle = found.middle + (found.low + found.high) / 2.0 * axis
        axes = np.concatenate([axis + step * ways, np.tile(axis, (4, 1))])
        axes /= np.linalg.norm(axes, axis=1, keepdims=True)
        middles = np.concatenate([np.tile(middle, (4, 1)), middle + step * found.radius * ways])
        best = _Tried.along(points, axes, middles)
        if best.volume < found.volume * (1.0 - 1e-4):
            found = best
        elif step < FINEST:
            break
        else:
            step /= 2.0
    return found
