"""Joint angles by the height of the wrist: how people lift, whatever the duration, against a prediction."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from liftopt.ergonomics.motion import Motion
from liftopt.errors import InputError
from liftopt.types import Array


@dataclass(frozen=True)
class HeightCurves:
    """Angles of recorded lifts by wrist height.

    Attributes:
        height: (H,) of the wrist above the floor [m], rising.
        angles: by quantity (trials, H) [deg]; NaN where a lift did not pass.
    """

    height: Array
    angles: Mapping[str, Array]

    def mean(self, quantity: str) -> Array:
        """Return the mean (H,) of a quantity over the trials that passed a height; NaN where none did."""
        values = self.angles[quantity]
        passed = np.isfinite(values)
        total, count = np.where(passed, values, 0.0).sum(axis=0), passed.sum(axis=0)
        return np.asarray(np.divide(total, count, out=np.full(len(count), np.nan), where=count > 0))


def predicted_angles(motion: Motion) -> dict[str, Array]:
    """Return the angles (K,) of a motion by the recordings' names, with their signs [deg].

    Their wrist deviation is positive to the thumb.
    """
    legs = {} if motion.knee is None else {"knee_flex": motion.knee, "trunk_incl": motion.trunk_inclination}
    return legs | {
        "elbow_flex_3d": motion.elbow,
        "shoulder_elev_3d": motion.humeral_elevation,
        "shoulder_abd": motion.abduction,
        "wrist_flex": motion.wrist_flexion,
        "wrist_dev": -motion.wrist_deviation,
        "twist": motion.twist,
    }


def read_height_curves(file: Path) -> HeightCurves:
    """Return the curves of a table with a line a trial and quantity and a column a height (``0.6m``).

    Raises:
        InputError: the file is not such a table.
    """
    try:
        with file.open(encoding="utf-8", newline="") as lines:
            (*_, quantity), *rows = [(row[:2], row[2:]) for row in csv.reader(lines)]
        height = np.array([float(name.removesuffix("m")) for name in quantity])
        named = [(name, [float(angle) for angle in angles]) for (_, name), angles in rows]
        angles = {name: np.array([own for other, own in named if other == name]) for name, _ in named}
        if not len(height) or any(values.shape[1:] != height.shape for values in angles.values()):
            raise ValueError("a row has another number of heights, or there is none")
    except (OSError, ValueError) as error:
        raise InputError(str(file), str(error), "must be a table of angles by trial, quantity and height") from None
    return HeightCurves(height, angles)


def at_heights(motion: Motion, height: Array) -> dict[str, Array]:
    """Return the angles (H,) of a motion where its wrist first passes each height [m]; NaN where it does not."""
    angles = predicted_angles(motion)
    return {name: first_passes(motion.wrist_height, values, height) for name, values in angles.items()}


def first_passes(above: Array, values: Array, height: Array) -> Array:
    """Return values (K,) where ``above`` (K,) first passes each height (H,); NaN where it does not."""
    found = np.full(len(height), np.nan)
    for i, level in enumerate(height):
        crossing = np.flatnonzero((above[:-1] - level) * (above[1:] - level) <= 0.0)
        if not len(crossing):
            continue
        k = int(crossing[0])
        share = (level - above[k]) / (above[k + 1] - above[k]) if above[k + 1] != above[k] else 0.0
        found[i] = values[k] + share * (values[k + 1] - values[k])
    return found


def rmse_by_height(motion: Motion, curves: HeightCurves) -> dict[str, float]:
    """Return the root mean square difference [deg] of recorded quantities over the heights that both pass, or NaN."""
    found = {}
    for name, values in at_heights(motion, curves.height).items():
        if name not in curves.angles:
            continue
        off = (values - curves.mean(name))[np.isfinite(values) & np.isfinite(curves.mean(name))]
        found[name] = float(np.sqrt(np.mean(off**2))) if len(off) else float("nan")
    return found
