"""TRC files: marker trajectories as tab-separated text."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.mocap.recording import Recording, checked_recording
from liftopt.lab.mocap.text_file import Line, check_rising, contradictions, number_of, number_table, read_lines
from liftopt.types import Array

WHAT = "a TRC file"
OFF_GRID = 0.15  # frames; further from the frame grid than this a time stamp is wrong, for all its few digits


def read_trc(path: Path) -> Recording:
    """Return the markers of a TRC file.

    Layout: ``PathFileType 4 (X/Y/Z) name``; names and values of the header (``DataRate``, ``Units``...);
    ``Frame# Time`` and marker names, each over three columns; ``X1 Y1 Z1 X2``...; rows. Where counts and rate of the
    header contradict the rows, the rows are believed and that is noted. Frames that are missing become frames in which
    no marker was seen. Columns without a name, as EVaRT and Cortex append them for unnamed markers, are left out.

    Raises:
        InputError: the file cannot be read or is not laid out so; the message names the line.
    """
    lines, notes = read_lines(path, WHAT)
    source = str(path)
    head = next((line for line in lines if line.filled), lines[0])
    if not " ".join(head.fields).lower().startswith("pathfiletype"):
        raise head.error(" ".join(head.fields), f"{WHAT} starts with PathFileType")
    start = next((i for i, line in enumerate(lines) if _begins_with(line, "frame#")), None)
    if start is None or start + 1 >= len(lines):
        raise InputError(source, NO_VALUE, f"has no line that starts with Frame#, so it is not {WHAT}")
    header = _header(lines[:start])
    labels, picked = _labels(_without_double_tabs([lines[start]])[0])
    body = start + (2 if _names_axes(lines[start + 1]) else 1)
    rows = _without_double_tabs(lines[body:])
    names = ("Frame#", "Time", *(f"{label or 'without a name'} {axis}" for label in labels for axis in "XYZ"))
    table, used, more = number_table(rows, names, group=3)
    if not len(table):
        raise InputError(source, NO_VALUE, "holds no frames")
    counted = {"NumFrames": len(table), "NumMarkers": len(picked)}
    notes += more + contradictions({key: header.get(key.lower(), "") for key in counted}, counted)
    if len(picked) < len(labels):
        notes.append(f"{len(labels) - len(picked)} markers without a name, between others, are left out")
    time, rate = table[:, 1], _rate(header, table[:, 1], used, notes)
    points = table[:, 2:].reshape(len(table), len(labels), 3)[:, picked]
    time, points = _on_grid(time, points, rate, used, notes)
    named = tuple(labels[i] for i in picked)
    return checked_recording(
        Recording(source, rate, time, named, points, units=header.get("units") or None, notes=tuple(notes))
    )


def _begins_with(line: Line, word: str) -> bool:
    return bool(line.fields) and line.fields[0].lower().startswith(word)


def _header(lines: list[Line]) -> dict[str, str]:
    """Return what a header says, by name in small letters."""
    filled = [line for line in lines if line.filled]
    at = next((i for i, line in enumerate(filled) if _begins_with(line, "datarate")), len(filled))
    if at + 1 >= len(filled):
        return {}
    names, values = filled[at].filled, filled[at + 1].filled
    if len(names) != len(values):  # one of the lines has double tabs
        names, values = (tuple(filter(None, fields)) for fields in (names, values))
    return {name.lower(): value for name, value in zip(names, values, strict=False)}


def _labels(line: Line) -> tuple[tuple[str, ...], list[int]]:
    """Return the markers in their columns, empty where one has no name, and the indices of those that have one."""
    # Tools pad each name by two empty fields, by one, or by none.
    places = [i for i, field in enumerate(line.fields) if field and i >= 2]
    if not places:
        raise line.error(" ".join(line.filled), "must name markers after Frame# and Time")
    padded = len(places) > 1 and all(place % 3 == 2 for place in places)
    if not padded:
        return tuple(line.fields[i] for i in places), list(range(len(places)))
    return tuple(line.fields[i] for i in range(2, places[-1] + 1, 3)), [place // 3 for place in places]


def _names_axes(line: Line) -> bool:
    filled = [field for field in line.fields if field]
    return not filled or filled[0][:1].upper() == "X"


def _without_double_tabs(lines: list[Line]) -> list[Line]:
    """Return the lines without every second field, if that is empty throughout: two tabs stand between fields."""
    filled = [line for line in lines if line.filled]
    if not filled or any(any(line.filled[1::2]) for line in filled):
        return lines  # the time, for one, stands in every line
    return [replace(line, fields=line.fields[::2]) for line in filled]


def _rate(header: dict[str, str], time: Array, lines: list[Line], notes: list[str]) -> float:
    """Return the rate on whose grid the time stamps lie: the stated one if it fits, else that of the stamps."""
    check_rising(time, lines)
    try:
        stated = number_of(header.get("datarate", "nan"))
    except ValueError:
        stated = np.nan
    if len(time) < 2:
        return stated
    steps = np.sort(np.diff(time))
    typical, mean = 1.0 / steps[(len(steps) - 1) // 2], (len(time) - 1) / (time[-1] - time[0])
    if abs(typical - stated / 1000.0) < 0.01 * typical:
        raise lines[0].error(float(time[0]), f"the column Time must hold seconds; at {stated:g} Hz these are ms")
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
