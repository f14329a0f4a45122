"""The part of a trial that a user wants: from and to which time or event, and which markers to leave out and when."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from liftopt.errors import InputError
from liftopt.lab.mocap.marker_map import MarkerMap
from liftopt.lab.mocap.recording import Recording
from liftopt.lab.mocap.whole_map import WholeMap

Mapping = TypeVar("Mapping", MarkerMap, WholeMap)
A_SPAN = "must be MARKER or MARKER:FROM-TO in seconds, FROM before TO"
SPAN = re.compile(r"(?P<marker>.+):(?P<start>[0-9.]+)-(?P<end>[0-9.]+)")


@dataclass(frozen=True)
class Ignored:
    """A marker that is left out.

    Attributes:
        marker: its label.
        start, end: of the time in which it is, both within it; all of the trial by default [s].
    """

    marker: str
    start: float = -np.inf
    end: float = np.inf


@dataclass(frozen=True)
class TrialPart:
    """What of a trial is used.

    Attributes:
        start, end: a time [s] or the name of an event, empty for the trial's own.
        ignored: markers.
    """

    start: str = ""
    end: str = ""
    ignored: tuple[Ignored, ...] = ()


def ignored_markers(texts: Sequence[str]) -> tuple[Ignored, ...]:
    """Return what ``MARKER`` or ``MARKER:FROM-TO`` name, in seconds.

    Raises:
        InputError: a span is none.
    """
    result = []
    for text in texts:
        match = SPAN.fullmatch(text)
        if match is None:
            result.append(Ignored(text))
            continue
        try:
            start, end = float(match["start"]), float(match["end"])
        except ValueError:
            start, end = 1.0, 0.0
        if start > end:
            raise InputError("--ignore", text, A_SPAN)
        result.append(Ignored(match["marker"], start, end))
    return tuple(result)


def chosen_part(recording: Recording, part: TrialPart) -> Recording:
    """Return the frames of a trial that are wanted, without what is to be ignored.

    Raises:
        InputError: a time is outside the trial, an event or a marker is not there, or nothing is left.
    """
    return _cut(_without(recording, part.ignored), part)


def without_ignored(mapping: Mapping, part: TrialPart) -> Mapping:
    """Return the mapping without the markers that are ignored throughout.

    Raises:
        InputError: such a marker is a landmark, which the skeleton cannot do without.
    """
    gone = {one.marker for one in part.ignored if one.start == -np.inf}
    if not gone:
        return mapping
    for label in sorted(gone):
        if name := mapping.landmark_of(label):
            raise InputError(
                "--ignore", label, f"is the landmark {name}, which is needed; ignore a span: {label}:FROM-TO"
            )
    return mapping.without(gone)


def _without(recording: Recording, ignored: tuple[Ignored, ...]) -> Recording:
    points = recording.points.copy()
    for one in ignored:
        try:
            channel = recording.index(one.marker)
        except InputError as error:
            known = one.marker.rpartition(":")[0] in recording.labels
            raise InputError("--ignore", one.marker, A_SPAN if known else error.allowed) from None
        inside = (recording.time >= one.start - 1e-9) & (recording.time <= one.end + 1e-9)
        if not inside.any():
            raise InputError("--ignore", f"{one.marker}:{one.start:g}-{one.end:g}", _extent(recording))
        points[inside, channel] = np.nan
    return replace(recording, points=points)


def _cut(recording: Recording, part: TrialPart) -> Recording:
    if not part.start and not part.end:
        return recording
    time = recording.time
    start = _when(recording, "--from", part.start) if part.start else float(time[0])
    end = _when(recording, "--to", part.end) if part.end else float(time[-1])
    if start >= end:
        raise InputError("--to", part.end or f"{end:g}", f"must be after --from, {start:g} s")
    kept = np.flatnonzero((time >= start - 1e-9) & (time <= end + 1e-9))
    if not kept.size:
        raise InputError("--from", f"{start:g}", f"leaves no frame; {_extent(recording)}")
    first, last = int(kept[0]), int(kept[-1])
    plates = []
    for plate in recording.plates:
        each = plate.rate / recording.rate
        rows = slice(round(first * each), round((last + 1) * each))
        plates.append(
            replace(
                plate,
                force=plate.force[rows],
                moment=plate.moment[rows],
                centre_of_pressure=plate.centre_of_pressure[rows],
            )
        )
    analog = recording.analog
    if analog is not None:
        each = analog.rate / recording.rate
        analog = replace(analog, values=analog.values[round(first * each) : round((last + 1) * each)])
    return replace(
        recording,
        time=time[first : last + 1],
        points=recording.points[first : last + 1],
        plates=tuple(plates),
        analog=analog,
        notes=(*recording.notes, f"cut to {time[first]:.2f} to {time[last]:.2f} s, frames {first} to {last}"),
    )


def _when(recording: Recording, key: str, text: str) -> float:
    try:
        at = float(text)
    except ValueError:
        return _event(recording, key, text)
    if not recording.time[0] - 1e-9 <= at <= recording.time[-1] + 1e-9:
        raise InputError(key, text, _extent(recording))
    return at


def _event(recording: Recording, key: str, text: str) -> float:
    found = [at for name, at in recording.events if name.lower() == text.lower()]
    if not found:  # "Foot Strike" of either side
        found = [at for name, at in recording.events if name.lower().endswith(" " + text.lower())]
    if not found:
        have = ", ".join(f"{name} at {at:.2f} s" for name, at in recording.events) or "no events"
        raise InputError(key, text, f"must be a time in seconds or an event; {recording.source} has {have}")
    if len(found) > 1:
        times = ", ".join(f"{at:.2f}" for at in found)
        raise InputError(key, text, f"is the name of {len(found)} events, at {times} s; give the time of one")
    if not recording.time[0] - 1e-9 <= found[0] <= recording.time[-1] + 1e-9:
        raise InputError(key, text, f"is at {found[0]:g} s; {_extent(recording)}")
    return found[0]


def _extent(recording: Recording) -> str:
    return f"{recording.source} goes from {recording.time[0]:g} to {recording.time[-1]:g} s"
