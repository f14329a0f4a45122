"""Repeated voltage-weight series of a sensor, and the mean curve through them (Fig. 7b)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.forces.sensor_table import read_sensor_table
from liftopt.lab.forces.voltage_divider import VOLTAGE_UNITS, Divider
from liftopt.types import Array

GRAVITY = 9.81  # m/s^2, as in the models: what a scale shows in grams, as a force
NEWTONS = {"N": 1.0, "kg": GRAVITY, "g": 1e-3 * GRAVITY}
HEAVIEST = 10_000.0  # N: beyond any sensor for fingers
DECIMALS = 9  # of a voltage [V]: what differs by less is the same, or a spline through it has no finite slope
ANY = "all"  # stands for every sensor that has no series of its own


@dataclass(frozen=True)
class Series:
    """A sensor loaded step by step, once.

    Attributes:
        source: the file, and the series in it if it holds several.
        channel: of the sensor, ``all`` where none is named.
        voltage: (K,) output of the divider [V], each load once.
        force: (K,) loads [N], rising.
        readings: (R, 2) every single voltage [V] and load [N], in the order they were taken; several may be of one
            load, loaded up and unloaded again. None where there are no others.
    """

    source: str
    channel: str
    voltage: Array
    force: Array
    readings: Array | None = None

    @property
    def single(self) -> Array:
        """(R, 2) single readings: voltage [V] and load [N]."""
        return np.stack([self.voltage, self.force], axis=1) if self.readings is None else self.readings


@dataclass(frozen=True)
class MeanSeries:
    """The mean of repeated series, with no step back.

    Attributes:
        voltage: (K,) [V], rising.
        force: (K,) [N], rising.
        notes: what was left out or smoothed, one sentence each.
    """

    voltage: Array
    force: Array
    notes: tuple[str, ...]


def read_series(path: Path, divider: Divider) -> list[Series]:
    """Return the series of a CSV file with the columns ``voltage [V, mV or counts]`` and ``weight [g, kg or N]``.

    A column ``series`` tells several in one file apart, a column ``channel`` says which sensor was loaded.

    Raises:
        InputError: the file cannot be read, a column or a value is missing, or a series has fewer than three loads.
    """
    table = read_sensor_table(path, "a voltage-weight series")
    unit = table.units[table.names.index("voltage")] if "voltage" in table.names else "V"
    scales = {name: float(divider.volts(np.array(1.0), name)) for name in VOLTAGE_UNITS}
    voltage, force = table.scaled("voltage", scales), table.scaled("weight", NEWTONS)
    wrong = ~((voltage >= 0.0) & (voltage <= divider.supply) & (force >= 0.0) & (force <= HEAVIEST))  # NaN too
    if wrong.any():
        row = int(np.flatnonzero(wrong)[0])
        raise table.lines[row].error(
            ",".join(table.lines[row].fields),
            f"needs a voltage from 0 to {divider.supply / scales[unit]:g} {unit} and a weight from 0 to {HEAVIEST:g} N",
        )
    blank = ("",) * len(voltage)
    keys = list(zip(table.words.get("channel", blank), table.words.get("series", blank), strict=True))
    result = []
    for channel, name in dict.fromkeys(keys):
        rows = [key == (channel, name) for key in keys]
        source = f"{path}, series {name}" if name else str(path)
        result.append(_series(source, channel.lower() or ANY, voltage[rows], force[rows]))
    if not result:
        raise InputError(str(path), NO_VALUE, "holds no rows")
    return result


def mean_series(series: Sequence[Series], divider: Divider) -> MeanSeries:
    """Return the mean voltage at each load over the series of one sensor, made to rise with the load.

    The loads are those of the series that has most, as far as every series goes; another series is interpolated there.
    Where the mean does not rise from one load to the next, neighbours are pooled (isotonic regression). Loads that
    saturate the converter say nothing and are left out.

    Raises:
        InputError: fewer than three different voltages are left.
    """
    from scipy.interpolate import PchipInterpolator
    from scipy.optimize import isotonic_regression

    loads = max(series, key=lambda one: len(one.force)).force
    low, high = max(one.force[0] for one in series), min(one.force[-1] for one in series)
    slack = 1e-9 + 1e-6 * abs(high)
    kept = loads[(loads >= low - slack) & (loads <= high + slack)]
    notes = []
    if len(kept) < len(loads):
        notes.append(f"not every series goes below {low:.3g} N or beyond {high:.3g} N: the curve ends there")
    if not len(kept):
        raise InputError(series[0].source, NO_VALUE, "shares no range of loads with the other series of its sensor")
    mean = np.mean([PchipInterpolator(one.force, one.voltage)(np.clip(kept, low, high)) for one in series], axis=0)
    full = divider.saturated(mean)
    if full.any():
        notes.append(f"the converter is at its end from {kept[full][0]:.3g} N on: left out")
        mean, kept = mean[~full], kept[~full]
    if len(mean):
        # Means of pooled neighbours are rounded too: two that differ by less are one point of the curve.
        rising = np.round(isotonic_regression(np.round(mean, DECIMALS)).x, DECIMALS)
        starts = np.flatnonzero(np.diff(rising, prepend=-np.inf))
        blocks = [slice(start, end) for start, end in pairwise([*starts, len(rising)])]
        pooled = len(mean) - len(blocks)
        if pooled:
            notes.append(
                f"the mean voltage did not rise at {pooled} of {len(mean)} loads: pooled with their neighbours"
            )
        mean = rising[starts]
        first, kept = kept[0], np.array([kept[block].mean() for block in blocks])
        if first == 0.0 or mean[0] == 0.0:
            kept[0] = 0.0  # what an unloaded sensor shows means no force, though small loads may show the same
    if len(mean) < 3:
        raise InputError(
            series[0].source,
            NO_VALUE,
            "the voltage must rise with the weight over three loads or more; is the sensor between supply and output?",
        )
    return MeanSeries(mean, kept, tuple(notes))


def _series(source: str, channel: str, voltage: Array, force: Array) -> Series:
    loads, where = np.unique(force, return_inverse=True)
    if len(loads) < 3:
        raise InputError(source, f"{len(loads)} different weights", "a series needs three or more")
    mean = np.bincount(where.ravel(), weights=voltage) / np.bincount(where.ravel())
    return Series(source, channel, mean, loads, np.stack([voltage, force], axis=1))
