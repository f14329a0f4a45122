"""Recordings of force sensors as CSV: read into trials, voltages turned into forces, preload subtracted."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import numpy.typing as npt

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.new_file import write_new
from liftopt.lab.forces.calibration import Calibration
from liftopt.lab.forces.calibration_series import NEWTONS
from liftopt.lab.forces.force_record import (
    BEYOND,
    FLAG_NAMES,
    MISSING,
    SATURATED,
    Flags,
    ForceRecord,
    sensor_forces,
    side,
)
from liftopt.lab.forces.sensor_table import SIGNATURE, SensorTable, read_sensor_table
from liftopt.lab.forces.voltage_divider import VOLTAGE_UNITS
from liftopt.types import Array

Mark = tuple[str, int]
SECONDS = {"s": 1.0, "ms": 1e-3}
HAND = "hand"
PRELOAD, TRIAL = "preload", "trial"
LARGEST = 10_000.0  # N: what a hand and its scale can never show
LONG_GAP = 3.0  # medians of the interval: more than a sample or two is missing
KEYS = {SATURATED: "saturated", BEYOND: "beyond", MISSING: "missing"}  # as the column flags has them


def read_forces(path: Path, calibration: Calibration | None = None, unloaded: float = 0.0) -> tuple[ForceRecord, ...]:
    """Return the trials of a recording, of ``liftopt record`` or another tool's.

    The header names the columns with their units: ``time [s or ms]``, then one for each sensor, finger... or thumb...,
    as voltages [V, mV or counts] or as forces [N, kg or g]. A column ``mark`` holds "trial 1" or "preload 1", or
    nothing outside them; a trial's preload is the mean of the block marked last before it. Where no trial is marked,
    the rows without a mark behind the last preload are one.

    Args:
        path: of the file.
        calibration: for voltages.
        unloaded: seconds at the start of a trial without a marked preload, over which its preload is taken.

    Raises:
        InputError: the file is wrong, or its voltages have no calibration; the message names line or channel.
    """
    table = read_sensor_table(path, "a recording of force sensors")
    time = _time(table)
    names = tuple(name for name in table.names if name not in ("time", HAND))
    if not names:
        raise table.header.error(",".join(table.names), "has no columns of sensors, such as finger1 [V]")
    for name in names:
        try:
            side(name)
        except InputError as error:
            raise table.header.error(name, error.allowed) from None
    force, flags = _forces(table, names, calibration)
    marks, more = _marks(table)
    trials = []
    preload, taken = np.zeros(len(names)), ""
    blocks: dict[Mark, list[int]] = {}
    for row, mark in enumerate(marks):
        if mark:
            blocks.setdefault(mark, []).append(row)
    for mark, block in blocks.items():
        rows = np.array(block)
        if mark[0] == PRELOAD:
            preload, taken = _mean(table, names, force[rows], flags[rows]), f"{PRELOAD} {mark[1]}"
            continue
        own, how = preload, taken
        if not taken and unloaded > 0.0:
            lasts = time[rows[-1]] - time[rows[0]]
            if unloaded >= lasts:
                raise InputError(
                    "--unloaded", unloaded, f"must be shorter than trial {mark[1]} of {path}, which lasts {lasts:g} s"
                )
            first = rows[time[rows] <= time[rows[0]] + unloaded]
            own, how = _mean(table, names, force[first], flags[first]), f"its first {unloaded:g} s"
        notes = [*table.notes, *more, *_notes(time[rows], names, flags[rows])]
        notes += [f"preload from {how}" if how else "no preload was recorded: none subtracted"]
        trials.append(
            ForceRecord(
                str(path), mark[1], names, time[rows], force[rows] - own, flags[rows], np.array(own), tuple(notes)
            )
        )
    if not trials:
        raise InputError(str(path), NO_VALUE, "holds no trial")
    return tuple(trials)


def write_forces(trials: tuple[ForceRecord, ...], path: Path) -> None:
    """Write trials as one CSV in newtons, with the hand's force; ``read_forces`` reads it back.

    Raises:
        InputError: the file exists, or cannot be written.
    """
    channels = trials[0].channels
    lines = [f"{SIGNATURE} forces; preload is subtracted; {HAND} = fingers - thumb"]
    lines += [f"# trial {one.trial}: {note}" for one in trials for note in one.notes]
    lines += [",".join(["time [s]", "mark", *(f"{name} [N]" for name in channels), f"{HAND} [N]", "flags"])]
    for one in trials:
        for k, hand in enumerate(one.hand_force):
            forces = ["" if np.isnan(value) else f"{value:.5f}" for value in (*one.force[k], hand)]
            flags = ";".join(
                f"{name}:{key}" for i, name in enumerate(channels) for bit, key in KEYS.items() if one.flags[k, i] & bit
            )
            lines.append(",".join([f"{one.time[k]:.4f}", f"{TRIAL} {one.trial}", *forces, flags]))
    write_new("--out", path, "\n".join(lines) + "\n")


def _time(table: SensorTable) -> Array:
    time = table.scaled("time", SECONDS)
    if not len(time):
        raise InputError(table.source, NO_VALUE, "holds no rows")
    if np.isnan(time).any():
        raise table.lines[int(np.flatnonzero(np.isnan(time))[0])].error("", "the time is missing")
    back = np.flatnonzero(np.diff(time) <= 0.0)
    if len(back):
        raise table.lines[back[0] + 1].error(float(time[back[0] + 1]), f"the time must increase: {time[back[0]]:g} s")
    return time


def _forces(table: SensorTable, names: tuple[str, ...], calibration: Calibration | None) -> tuple[Array, Flags]:
    columns = [table.names.index(name) for name in names]
    units = [table.units[i] for i in columns]
    known = VOLTAGE_UNITS if units[0] in VOLTAGE_UNITS else tuple(NEWTONS)
    for name, unit in zip(names, units, strict=True):
        if unit not in known:
            raise table.header.error(
                f"{name} [{unit}]", f"the unit must be {' or '.join(VOLTAGE_UNITS)}, or {' or '.join(NEWTONS)}, for all"
            )
    values = table.values[:, columns]
    if known != VOLTAGE_UNITS:
        force = values * [NEWTONS[unit] for unit in units]
        _check_range(table, columns, np.abs(force) > LARGEST, f"must be within {LARGEST:g} N")
        flags = np.where(np.isnan(values), MISSING, 0).astype(np.uint8)
        _read_flags(table, names, flags)
        return force, flags
    if calibration is None:
        raise InputError(table.source, NO_VALUE, "holds voltages: a calibration is needed (--calibration CAL)")
    volts = np.stack([calibration.divider.volts(values[:, i], unit) for i, unit in enumerate(units)], axis=1)
    supply = calibration.divider.supply
    outside = (volts < -0.05 * supply) | (volts > 1.05 * supply)
    _check_range(table, columns, outside, f"must be from 0 to the supply voltage, {supply:g} V")
    return sensor_forces(names, volts, calibration)


def _check_range(table: SensorTable, columns: list[int], outside: npt.NDArray[np.bool_], allowed: str) -> None:
    if outside.any():
        row, i = (int(index) for index in np.argwhere(outside)[0])
        value = f"{table.names[columns[i]]} {table.values[row, columns[i]]:g} {table.units[columns[i]]}"
        raise table.lines[row].error(value, allowed)


def _read_flags(table: SensorTable, names: tuple[str, ...], flags: Flags) -> None:
    bits = {key: bit for bit, key in KEYS.items()}
    for row, text in enumerate(table.words.get("flags", ())):
        for word in filter(None, text.split(";")):
            name, _, key = word.rpartition(":")
            if name not in names or key not in bits:
                raise table.lines[row].error(word, f"must be a sensor's name and {' or '.join(bits)}")
            flags[row, names.index(name)] |= bits[key]


def _marks(table: SensorTable) -> tuple[list[Mark | None], list[str]]:
    """Return the mark of each row, None where it belongs to no block, and notes."""
    marks: list[Mark | None] = []
    seen: set[Mark] = set()
    for row, text in enumerate(table.words.get("mark", (f"{TRIAL} 1",) * len(table.lines))):
        kind, _, number = text.lower().partition(" ")
        if text and (kind not in (PRELOAD, TRIAL) or not re.fullmatch(r"[0-9]{1,9}", number)):
            raise table.lines[row].error(text, f'the mark must be "{TRIAL} 1" or "{PRELOAD} 1", or another number')
        mark = (kind, int(number)) if text else None
        if mark and mark in seen and marks[-1] != mark:
            raise table.lines[row].error(text, "this mark stood further above already; a trial is one block of rows")
        seen.update({mark} if mark else ())
        marks.append(mark)
    between = marks.count(None)
    if any(mark and mark[0] == TRIAL for mark in marks):
        return marks, [f"{between} rows without a mark, outside preload and trials, are left aside"] if between else []
    last = max((row for row, mark in enumerate(marks) if mark), default=-1)
    whole: list[Mark | None] = [*marks[: last + 1], *[(TRIAL, 1)] * (len(marks) - last - 1)]
    where = "behind the preload" if last >= 0 else "of the recording"
    return whole, [f"no trial is marked: all {len(marks) - last - 1} rows {where} are taken as one"]


def _mean(table: SensorTable, names: tuple[str, ...], force: Array, flags: Flags) -> Array:
    for i, name in enumerate(names):
        for bit, what in FLAG_NAMES.items():
            if np.all(flags[:, i] & bit):
                raise InputError(f"{table.source}, channel {name}", NO_VALUE, f"is {what} throughout the preload")
    return np.asarray(np.nanmean(force, axis=0), float)


def _notes(time: Array, names: tuple[str, ...], flags: Flags) -> list[str]:
    notes = []
    if len(time) > 1:
        steps = np.diff(time)
        median, longest = float(np.median(steps)), int(np.argmax(steps))
        notes.append(f"{len(time)} samples, {median:.3f} s apart (median; {steps.min():.3f} to {steps.max():.3f} s)")
        if steps[longest] > LONG_GAP * median:
            notes.append(f"no sample for {steps[longest]:.2f} s after {time[longest]:.2f} s")
    for bit, what in FLAG_NAMES.items():
        counts = [(name, int(np.count_nonzero(flags[:, i] & bit))) for i, name in enumerate(names)]
        listed = ", ".join(f"{name} in {count}" for name, count in counts if count)
        if listed:
            notes.append(f"{what}: {listed} of {len(time)} samples")
    return notes
