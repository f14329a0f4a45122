"""A measured series of the hand's force, from a file of columns over time."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.forces.force_file import SECONDS, read_forces
from liftopt.lab.forces.sensor_table import SIGNATURE
from liftopt.lab.mocap.motion_table import read_motion_table
from liftopt.lab.mocap.recording import TO_Z_UP
from liftopt.lab.mocap.text_file import Line, read_lines
from liftopt.types import Array

COLUMNS = ("time", "fx", "fy", "fz")
UNITS: dict[str, dict[str, float]] = {"time": SECONDS} | {name: {"N": 1.0, "kN": 1000.0} for name in COLUMNS[1:]}
NAMED = re.compile(r"([a-z]+)\s*(?:[\[(](.*)[\])])?", re.IGNORECASE)
LARGEST = 3000.0  # N; nobody's hand bears more, while 9999 stands for "no value" in many files
SMALLEST = 0.5  # N, of the largest: less bears no object
LONGEST_STEP = 0.1  # s between samples, over which a hand's force changes much
MUCH_LONGER = 3.0  # times the recording: with such steps, a series in another unit of time
HOLE = 10.0  # times the usual step: samples are missing there
CHANGE = 1.0  # N by which the whole series may change and be interpolated over any time


@dataclass(frozen=True)
class HandForce:
    """Force of the hand on the object.

    Attributes:
        source: the file.
        time: (S,) on the recording's clock [s].
        force: (S, 3) in the recording's axes [N].
    """

    source: str
    time: Array
    force: Array

    def at(self, time: Array) -> tuple[Array, int]:
        """Return the force (F, 3) at ``time`` (F,) [s], zero outside the series, and how many times are outside.

        Raises:
            InputError: all times are outside, the samples are too far apart to follow a lift, or some are missing
                while the force changes.
        """
        outside = (time < self.time[0]) | (time > self.time[-1])
        spans = f"{self.time[0]:g} to {self.time[-1]:g} s, the recording from {time[0]:g} to {time[-1]:g} s"
        if outside.all():
            raise InputError(
                self.source,
                NO_VALUE,
                f"has no force at any time of the recording: it goes from {spans}; --hand-force-start sets its start",
            )
        step = float(np.median(np.diff(self.time))) if len(self.time) > 1 else 0.0
        longer = np.ptp(self.time) > MUCH_LONGER * np.ptp(time)
        if longer and step > LONGEST_STEP and np.ptp(self.force, axis=0).max() > CHANGE:
            raise InputError(
                self.source,
                f"{step:g} s",
                f"from sample to sample is too long to follow a lift (it goes from {spans}); at most "
                f"{LONGEST_STEP:g} s. If the time is in milliseconds, name the column time [ms]",
            )
        self._check_holes(step, time)
        force = np.stack([np.interp(time, self.time, column, left=0.0, right=0.0) for column in self.force.T], axis=1)
        return force, int(outside.sum())

    def check_covers(self, lifts: Sequence[tuple[float, float]]) -> None:
        """Check that the series holds one of the lifts from ... to [s] wholly, to 0.1 s, if there are any.

        Raises:
            InputError: it does not: the hand would carry nothing in the middle of a lift.
        """
        first, last = float(self.time[0]), float(self.time[-1])
        if lifts and not any(first <= a + LONGEST_STEP and last >= b - LONGEST_STEP for a, b in lifts):
            spans = ", ".join(f"{a:.2f} to {b:.2f} s" for a, b in lifts)
            raise InputError(
                self.source,
                f"{first:g} to {last:g} s",
                f"does not hold the lift, in which the object moves from {spans}; --hand-force-start sets its start",
            )

    def _check_holes(self, step: float, time: Array) -> None:
        """Refuse what would be drawn as a straight line through a hole in a series sampled closely."""
        if not 0.0 < step <= LONGEST_STEP:
            return
        change = np.abs(np.diff(self.force, axis=0)).max(axis=1)
        hole = (np.diff(self.time) > max(LONGEST_STEP, HOLE * step)) & (change > CHANGE)
        hole &= (self.time[1:] > time[0]) & (self.time[:-1] < time[-1])
        if hole.any():
            first = int(np.flatnonzero(hole)[0])
            raise InputError(
                self.source,
                NO_VALUE,
                f"has no force from {self.time[first]:g} to {self.time[first + 1]:g} s, while it changes by "
                f"{change[first]:.3g} N; cut the trial with --from and --to",
            )


def read_hand_force(path: Path, up: str) -> HandForce:
    """Return the series of a file with the columns time, fx, fy, fz; other columns are left aside.

    A unit may stand behind a column's name, ``time [ms]`` or ``fx [kN]``; without one it is s and N.

    A CSV that ``liftopt forces`` wrote is taken for what it measured, a force upwards.

    Args:
        path: of a CSV, MOT or STO file.
        up: axis of the recording that points up, a key of ``TO_Z_UP``.

    Raises:
        InputError: the file cannot be read, a column is missing, or a value is no number; the message names the line.
    """
    if path.suffix.lower() in (".mot", ".sto"):
        table = read_motion_table(path)
        force = np.stack([table.column(name) for name in COLUMNS[1:]], axis=1)
        return _checked(HandForce(str(path), table.time, force))
    lines, _ = read_lines(path, "a CSV file")
    if " ".join(lines[0].fields).startswith(SIGNATURE):
        return _of_sensors(path, up)
    at = next((i for i, line in enumerate(lines) if line.filled), None)
    if at is None:
        wanted = ", ".join(COLUMNS)
        raise InputError(str(path), NO_VALUE, f"holds nothing but separators; the columns {wanted} are needed")
    names, scales = zip(*(_named(name, lines[at]) for name in lines[at].filled), strict=True)
    missing = [name for name in COLUMNS if name not in names]
    if missing:
        wanted = f"has no column {', '.join(missing)}; {', '.join(COLUMNS)} are needed"
        raise lines[at].error(",".join(names)[:80], wanted)
    picked = [names.index(name) for name in COLUMNS]
    rows = [line for line in lines[at + 1 :] if line.filled]
    values = np.array([[row.number_at(i, names[i]) for i in picked] for row in rows], dtype=float).reshape(
        -1, len(COLUMNS)
    )
    values = values * [scales[i] for i in picked]
    return _checked(HandForce(str(path), values[:, 0], values[:, 1:]))


def _named(text: str, line: Line) -> tuple[str, float]:
    """Return the name of a column without its unit, and what the unit is in s or N."""
    match = NAMED.fullmatch(text.strip())
    if match is None or match[1].lower() not in COLUMNS or match[2] is None:
        return text.strip().lower(), 1.0
    units, unit = UNITS[match[1].lower()], match[2].strip()
    if unit not in units:
        raise line.error(text, f"the unit of {match[1]} must be {' or '.join(units)}")
    return match[1].lower(), units[unit]


def _of_sensors(path: Path, up: str) -> HandForce:
    trials = read_forces(path)
    if len(trials) != 1:
        raise InputError(str(path), f"{len(trials)} trials", "must be one; give the file of a single trial")
    known = np.isfinite(trials[0].hand_force)
    upwards = TO_Z_UP[up].T @ np.array([0.0, 0.0, 1.0])
    return _checked(HandForce(str(path), trials[0].time[known], trials[0].hand_force[known, None] * upwards))


def _checked(series: HandForce) -> HandForce:
    if not len(series.time):
        raise InputError(series.source, NO_VALUE, "holds no rows")
    if not np.isfinite(series.force).all() or not np.isfinite(series.time).all():
        row = int(np.flatnonzero(~(np.isfinite(series.force).all(axis=1) & np.isfinite(series.time)))[0])
        raise InputError(series.source, NO_VALUE, f"a value is missing in row {row + 1} of the data")
    if np.any(np.diff(series.time) <= 0.0):
        row = int(np.flatnonzero(np.diff(series.time) <= 0.0)[0]) + 2
        raise InputError(series.source, float(series.time[row - 1]), f"the time must increase; row {row} of the data")
    if (largest := float(np.abs(series.force).max())) > LARGEST:
        raise InputError(
            series.source, f"{largest:g} N", f"is no force of a hand (at most {LARGEST:g} N): are these newtons?"
        )
    if 0.0 < largest < SMALLEST:
        raise InputError(
            series.source,
            f"{largest:g} N",
            f"is the largest force, and a hand that bears an object has {SMALLEST:g} N at least; if these are "
            "kilonewtons, name the columns fx [kN]",
        )
    return series
