"""TRC files: marker trajectories as tab-separated text."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.recording import Array, Recording, checked_recording
from liftopt.lab.text_file import Line, check_rising, contradictions, number_table, read_lines

WHAT = "a TRC file"
OFF_GRID = 0.15  # frames; further from the frame grid than this a time stamp is wrong, for all its few digits


def read_trc(path: Path) -> Recording:
    """Return the markers of a TRC file.

    Layout: ``PathFileType 4 (X/Y/Z) name``; names and values of the header (``DataRate``, ``Units``...);
    ``Frame# Time`` and marker names, each over three columns; ``X1 Y1 Z1 X2``...; rows. Where counts and rate of the
    header contradict the rows, the rows are believed and that is noted. Frames that are missing become frames in which
    no marker was seen.

    Raises:
        InputError: the file cannot be read or is not laid out so; the message names the line.
    """
    lines = read_lines(path, WHAT)
    source = str(path)
    if lines[0].fields[:1] != ("PathFileType",):
        raise lines[0].error(" ".join(lines[0].fields), f"{WHAT} starts with PathFileType")
    start = next((i for i, line in enumerate(lines) if line.fields[:1] and line.fields[0].startswith("Frame#")), None)
    if start is None or start < 3 or start + 1 >= len(lines):
        raise InputError(source, NO_VALUE, f"has no line that starts with Frame#, so it is not {WHAT}")
    header = dict(zip(lines[start - 2].filled, lines[start - 1].filled, strict=False))
    labels = _labels(lines[start])
    names = ("Frame#", "Time", *(f"{label} {axis}" for label in labels for axis in "XYZ"))
    body = start + (2 if _names_axes(lines[start + 1]) else 1)
    table, used, notes = number_table(lines[body:], names)
    if not len(table):
        raise InputError(source, NO_VALUE, "holds no frames")
    notes += contradictions(header, {"NumFrames": len(table), "NumMarkers": len(labels)})
    time, rate = table[:, 1], _rate(header, table[:, 1], used, notes)
    points = table[:, 2:].reshape(len(table), len(labels), 3)
    time, points = _on_grid(time, points, rate, used, notes)
    return checked_recording(
        Recording(source, rate, time, labels, points, units=header.get("Units") or None, notes=tuple(notes))
    )


def _labels(line: Line) -> tuple[str, ...]:
    if len(line.fields) < 3:
        raise line.error(" ".join(line.fields), "must name markers after Frame# and Time")
    # Tools pad each name by two empty fields, or do not; an empty name among others is none.
    labels = tuple(field for field in line.fields[2:] if field)
    if not labels:
        raise line.error(" ".join(line.filled), "must name markers after Frame# and Time")
    return labels


def _names_axes(line: Line) -> bool:
    filled = [field for field in line.fields if field]
    return not filled or filled[0][:1].upper() == "X"


def _rate(header: dict[str, str], time: Array, lines: list[Line], notes: list[str]) -> float:
    """Return the rate on whose grid the time stamps lie: the stated one if it fits, else that of the stamps."""
    check_rising(time, lines)
    try:
        stated = float(header.get("DataRate", "nan"))
    except ValueError:
        stated = np.nan
    if len(time) < 2:
        return stated
    steps = np.sort(np.diff(time))
    typical, mean = 1.0 / steps[(len(steps) - 1) // 2], (len(time) - 1) / (time[-1] - time[0])
    # Stamps have few digits: a whole number of frames a second is tried before what they say to the last one.
    for rate in (stated, round(mean), mean, round(typical)):
        if np.isfinite(rate) and rate > 0.0 and _fits(time, rate):
            if np.isfinite(stated) and rate != stated:
                notes.append(f"the header says {stated:g} Hz, the time stamps {rate:g} Hz")
            return float(rate)
    return float(typical)


def _fits(time: Array, rate: float) -> bool:
    frame = (time - time[0]) * rate
    place = np.round(frame)
    return bool(np.abs(frame - place).max() <= OFF_GRID and np.sort(np.diff(place))[(len(place) - 2) // 2] == 1.0)


def _on_grid(time: Array, points: Array, rate: float, lines: list[Line], notes: list[str]) -> tuple[Array, Array]:
    if not np.isfinite(rate) or rate <= 0.0:
        return time, points  # refused by checked_recording, which names the rate
    frame = (time - time[0]) * rate
    place = np.round(frame)
    for i, line in enumerate(lines):
        if abs(frame[i] - place[i]) > OFF_GRID or (i and place[i] == place[i - 1]):
            raise line.error(float(time[i]), f"the time is not on the grid of {rate:g} Hz that starts at {time[0]:g} s")
    count = int(place[-1]) + 1
    if count > 10 * len(time) + 1000:
        raise lines[-1].error(float(time[-1]), f"the time leaps by {count - len(time)} frames at {rate:g} Hz")
    if missing := count - len(time):
        notes.append(f"{missing} frames are missing between the rows; no marker was seen in them")
    whole = np.full((count, *points.shape[1:]), np.nan)
    whole[place.astype(int)] = points
    return time[0] + np.arange(count) / rate, whole
