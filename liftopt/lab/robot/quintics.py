"""Curves of fifth degree between points, as controllers of joints follow them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftopt.types import Array


@dataclass(frozen=True)
class Quintics:
    """One polynomial an interval.

    Attributes:
        time: (K,) of the points [s].
        coefficients: (K - 1, 6, n) of each interval, by power of the time since its start.
    """

    time: Array
    coefficients: Array

    @classmethod
    def meeting(cls, time: Array, value: Array, slope: Array, bend: Array) -> Quintics:
        """Return the curve that has ``value``, ``slope`` and second derivative ``bend`` (K, n) at ``time`` (K,)."""
        span = np.diff(time)[:, None]
        before, after = slope[:-1], slope[1:]
        # What is left of value, slope and bend at each interval's end after its start's parabola.
        miss = (np.diff(value, axis=0) - span * (before + span * bend[:-1] / 2)) / span**3
        turn = (after - before - span * bend[:-1]) / span**2
        gain = np.diff(bend, axis=0) / span
        rows = [
            value[:-1], before, bend[:-1] / 2,
            10 * miss - 4 * turn + gain / 2,
            (-15 * miss + 7 * turn - gain) / span,
            (6 * miss - 3 * turn + gain / 2) / span**2,
        ]  # fmt: skip
        return cls(time, np.stack(rows, axis=1))

    def at(self, time: float) -> Array:
        """Return the curve (n,) at ``time``; before the start and after the end it stands still."""
        time = float(np.clip(time, self.time[0], self.time[-1]))
        interval = min(int(np.searchsorted(self.time, time, side="right")) - 1, len(self.coefficients) - 1)
        value: Array = (time - self.time[interval]) ** np.arange(6) @ self.coefficients[interval]
        return value

    def sampled(self, steps: int) -> tuple[Array, Array, Array]:
        """Return times (M,), the curve and its slope (M, n) there: ``steps`` + 1 times in each interval, ends twice."""
        since = np.diff(self.time)[:, None] * np.linspace(0.0, 1.0, steps + 1)
        value = (since[..., None] ** np.arange(6)) @ self.coefficients
        slope = (np.arange(1, 6) * since[..., None] ** np.arange(5)) @ self.coefficients[:, 1:]
        n = value.shape[-1]
        return (self.time[:-1, None] + since).ravel(), value.reshape(-1, n), slope.reshape(-1, n)
