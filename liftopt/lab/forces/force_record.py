"""The hand's force from sensors under the fingers and the thumb, in newtons, with what is doubtful in it (Fig. 15)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.forces.calibration import Calibration
from liftopt.types import Array

Flags = npt.NDArray[np.uint8]

FINGERS = ("finger", "index", "middle", "ring", "little")  # below the object: they lift it
THUMB = "thumb"  # above it: it presses down
SATURATED, BEYOND, MISSING = 1, 2, 4
FLAG_NAMES = {SATURATED: "saturated", BEYOND: "beyond the calibration", MISSING: "missing"}


@dataclass(frozen=True)
class ForceRecord:
    """Forces of one trial.

    Attributes:
        source: the file.
        trial: its number in the file, the first is 1.
        channels: (C,) names of the sensors; those of the thumb start with "thumb", the others are fingers'.
        time: (S,) on the recorder's clock [s], sampled as the device pleased.
        force: (S, C) of the hand on each sensor, preload subtracted [N]; NaN where a value is missing. At a flag other
            than MISSING the true force is at least this.
        flags: (S, C) sums of SATURATED (the converter's end), BEYOND (the calibration's end) and MISSING.
        preload: (C,) that was subtracted [N].
        notes: what a reader of the curve must know, one sentence each.
    """

    source: str
    trial: int
    channels: tuple[str, ...]
    time: Array
    force: Array
    flags: Flags
    preload: Array
    notes: tuple[str, ...]

    @property
    def hand_force(self) -> Array:
        """Force of the hand on the object (S,) [N]: that of the fingers, up, minus that of the thumb, down."""
        return hand_force(self.channels, self.force)

    @property
    def doubtful(self) -> npt.NDArray[np.bool_]:
        """Where (S,) a channel is flagged, and the hand's force with it."""
        return np.asarray(self.flags.any(axis=1), bool)

    def over_share(self, share: Array, start: float | None = None, end: float | None = None) -> Array:
        """Return the hand's force [N] at shares (K,) of the duration, 0 at ``start`` and 1 at ``end``.

        Samples are joined by straight lines, over missing ones too.

        Args:
            share: of the time from ``start`` to ``end``.
            start: of the lift on the recorder's clock [s]; the first sample if not given.
            end: of the lift [s]; the last sample if not given.

        Raises:
            InputError: the record does not hold that span.
        """
        known = np.isfinite(self.hand_force)
        if known.sum() < 2:
            raise InputError(f"{self.source}, trial {self.trial}", NO_VALUE, "has fewer than two complete samples")
        first, last = float(self.time[known][0]), float(self.time[known][-1])
        start, end = first if start is None else start, last if end is None else end
        if not first <= start < end <= last:
            raise InputError(
                f"{self.source}, trial {self.trial}", f"{start:g} to {end:g} s", f"holds {first:g} to {last:g} s"
            )
        wanted = start + np.asarray(share, float) * (end - start)
        return np.asarray(np.interp(wanted, self.time[known], self.hand_force[known]), float)


def side(channel: str) -> int:
    """Return 1 for a sensor of the fingers and -1 for one of the thumb, by its name.

    Raises:
        InputError: the name tells neither.
    """
    name = channel.lower()
    if name.startswith(THUMB):
        return -1
    if name.startswith(FINGERS):
        return 1
    raise InputError("channel", channel, f"must start with {', '.join(FINGERS)} or {THUMB}")


def hand_force(channels: Sequence[str], force: Array) -> Array:
    """Return the sum over the fingers minus that over the thumb (...,) [N] of forces (..., C) [N]."""
    return np.asarray(np.asarray(force) @ np.array([float(side(name)) for name in channels]), float)


def sensor_forces(channels: Sequence[str], voltage: Array, calibration: Calibration) -> tuple[Array, Flags]:
    """Return the forces [N] and flags of voltages (S, C) [V], before any preload is subtracted.

    Raises:
        InputError: the calibration does not know a channel.
    """
    voltage = np.asarray(voltage, float)
    force, flags = np.empty_like(voltage), np.zeros(voltage.shape, np.uint8)
    for i, name in enumerate(channels):
        curve = calibration.curve(name)
        force[:, i] = curve.of(voltage[:, i])
        # The curve's last voltage is still within it, however it was rounded on its way through the device.
        flags[voltage[:, i] > curve.voltage[-1] + calibration.divider.supply * 1e-6, i] |= BEYOND
    flags[calibration.divider.saturated(voltage)] |= SATURATED
    flags[np.isnan(voltage)] = MISSING
    return force, flags
