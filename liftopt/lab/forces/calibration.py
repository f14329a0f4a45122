"""From the voltage of a force sensor to its force: monotone splines through calibration series, kept as TOML."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import tomli_w
from pydantic import BeforeValidator, Field, model_validator

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.entries import entry
from liftopt.files.new_file import write_new
from liftopt.files.section import Section
from liftopt.lab.forces.calibration_series import ANY, DECIMALS, Series, mean_series, read_series
from liftopt.lab.forces.voltage_divider import Divider
from liftopt.lab.mocap.text_file import read_text
from liftopt.types import Array

SCATTER = 0.05  # of a curve's range: the repeatability that data sheets of such sensors promise
SMALLEST_STEP = 0.5 * 10.0**-DECIMALS  # V or N, between points of a curve


def _rising(value: object) -> tuple[float, ...]:
    """Return a list of finite numbers from 0 on, each larger than the one before; raises ValueError for others."""
    if not isinstance(value, (list, tuple)) or len(value) < 2:
        raise ValueError("too short")
    if not all(isinstance(x, (int, float)) and not isinstance(x, bool) and np.isfinite(x) for x in value):
        raise ValueError("no numbers")
    if value[0] < 0.0 or any(b - a < SMALLEST_STEP for a, b in pairwise(value)):
        raise ValueError("not rising")
    return tuple(map(float, value))


RISING = "a list of two or more numbers, 0 or more, each larger than the one before"
Rising = Annotated[tuple[float, ...], BeforeValidator(_rising)]


class Curve(Section):
    """Force over voltage of one sensor.

    Raises:
        InputError: the lists are not of one length.
    """

    voltage: Annotated[Rising, entry("output of the divider in V", RISING)]
    force: Annotated[Rising, entry("force on the sensor in N", RISING)]

    @model_validator(mode="after")
    def _of_one_length(self) -> Curve:
        if len(self.voltage) != len(self.force):
            raise InputError("force", f"{len(self.force)} numbers", f"there are {len(self.voltage)} voltages")
        return self

    def of(self, voltage: Array) -> Array:
        """Return the force [N] at voltages [V]; beyond the ends of the curve, that at its end.

        An unloaded sensor conducts next to nothing, so a curve that starts under load is led on to 0 N at 0 V.
        """
        return np.asarray(self._spline(np.clip(voltage, self._knots[0], self.voltage[-1])), float)

    @cached_property
    def _knots(self) -> tuple[float, ...]:
        return (0.0, *self.voltage) if self.force[0] > 0.0 and self.voltage[0] > 0.0 else self.voltage

    @cached_property
    def _spline(self) -> Any:
        from scipy.interpolate import PchipInterpolator

        lead = (0.0,) * (len(self._knots) - len(self.force))
        return PchipInterpolator(self._knots, (*lead, *self.force))


def _by_sensor(value: object) -> dict[str, Any]:
    """Return curves by sensor, whose case does not count; raises ValueError where that leaves one of two, or none."""
    curves = {str(name).lower(): curve for name, curve in value.items()} if isinstance(value, Mapping) else {}
    if not isinstance(value, Mapping) or not value or len(curves) < len(value):
        raise ValueError("no curves")
    return curves


class Calibration(Section):
    """What is known of the sensors and their wiring."""

    version: Annotated[Literal[1], Field(alias="schema", description="version of the calibration format")] = 1
    divider: Divider = Divider()
    curves: Annotated[
        dict[str, Curve],
        BeforeValidator(_by_sensor),
        entry("force over voltage by sensor", f"a section with a curve for each sensor, or one named {ANY}"),
    ]

    def curve(self, channel: str) -> Curve:
        """Return the curve of a channel.

        Raises:
            InputError: it has none, and there is none for all.
        """
        found = self.curves.get(channel.lower(), self.curves.get(ANY))
        if found is None:
            raise InputError(f"channel {channel}", NO_VALUE, f"the calibration knows only {', '.join(self.curves)}")
        return found

    def wired(self, divider: Divider) -> Calibration:
        """Return the calibration for the same sensors in another divider: each keeps its conductance at each force."""
        if divider == self.divider:
            return self
        curves = {
            name: Curve.model_construct(
                voltage=tuple(divider.voltage(self.divider.conductance(np.array(curve.voltage))).tolist()),
                force=curve.force,
            )
            for name, curve in self.curves.items()
        }
        return Calibration(divider=divider, curves=curves)


@dataclass(frozen=True)
class Fit:
    """A calibration and how well it fits the series it was made from.

    Attributes:
        calibration: the result.
        residual_rms, residual_max: by curve, of every single reading [N], within the curve's range of loads.
        series: by curve, how many.
        notes: what was left out or smoothed.
    """

    calibration: Calibration
    residual_rms: dict[str, float]
    residual_max: dict[str, float]
    series: dict[str, int]
    notes: tuple[str, ...]


def calibrate(paths: Sequence[Path], divider: Divider) -> Fit:
    """Return the calibration through repeated series: the monotone cubic (PCHIP) through their mean, by sensor.

    Raises:
        InputError: a file is wrong; the message names it and its line.
    """
    by_channel: dict[str, list[Series]] = {}
    for path in paths:
        for one in read_series(path, divider):
            by_channel.setdefault(one.channel, []).append(one)
    curves, rms, largest, notes = {}, {}, {}, []
    for channel, group in by_channel.items():
        mean = mean_series(group, divider)
        curve = Curve(voltage=tuple(mean.voltage.tolist()), force=tuple(mean.force.tolist()))
        voltage, force = np.concatenate([one.single for one in group]).T
        within = (force >= curve.force[0]) & (force <= curve.force[-1])
        error = (curve.of(voltage) - force)[within]
        curves[channel] = curve
        rms[channel], largest[channel] = float(np.sqrt(np.mean(error**2))), float(np.abs(error).max())
        notes += [f"{channel}: {note}" for note in mean.notes]
        if largest[channel] > SCATTER * curve.force[-1]:
            worst = int(np.argmax(np.where(within, np.abs(curve.of(voltage) - force), 0.0)))
            notes.append(
                f"{channel}: single readings scatter: {voltage[worst]:.4g} V at {force[worst]:.3g} N would be read as "
                f"{float(curve.of(voltage[worst])):.3g} N ({largest[channel] / curve.force[-1]:.0%} of the range off); "
                "hysteresis, creep or a load that did not sit on the sensor"
            )
    return Fit(
        Calibration(divider=divider, curves=curves),
        rms,
        largest,
        {channel: len(group) for channel, group in by_channel.items()},
        tuple(notes),
    )


def save_calibration(calibration: Calibration, path: Path) -> None:
    """Write a calibration as TOML.

    Raises:
        InputError: the file exists, or cannot be written.
    """
    write_new("--out", path, tomli_w.dumps(calibration.plain()))


def load_calibration(path: Path) -> Calibration:
    """Return the calibration of a TOML file.

    Raises:
        InputError: the file cannot be read, is not TOML, or is no calibration; the message names file and key.
    """
    try:
        data = tomllib.loads(read_text(path, "a calibration in TOML").decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        raise InputError(str(path), NO_VALUE, f"is not valid TOML: {error}") from None
    try:
        return Calibration.checked(data)
    except InputError as error:
        raise InputError(f"{path}: {error.key}", error.value, error.allowed) from None
