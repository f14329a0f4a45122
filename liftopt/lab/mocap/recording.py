"""What a motion-capture system recorded: markers, analog channels, force plates, in SI units and with Z up."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field, replace

import numpy as np

from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.mocap.length_units import METRES, metres_of
from liftopt.types import Array

LARGEST_ROOM = 1000.0  # m
SENTINEL = 1e15  # beyond any place in any unit: NDI systems write -3.697314e28 for a marker that was not seen
# From the middle of all markers to one of them, in the median: 0.3 to 0.6 m on a person. Ten times as much or a tenth
# is another unit.
SMALLEST_CLOUD, LARGEST_CLOUD = 0.1, 1.5  # m
# R_world_file for each axis of the file that may point up: a right-handed turn that brings it to Z. The rest of the
# heading is found from the pelvis.
TO_Z_UP: dict[str, Array] = {
    "Z": np.eye(3),
    "Y": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]),
    "X": np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]),
    "-Z": np.diag([1.0, -1.0, -1.0]),
    "-Y": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]),
    "-X": np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]),
}


@dataclass(frozen=True)
class AnalogChannels:
    """Analog channels as recorded; nothing is converted.

    Attributes:
        rate: samples a second [Hz].
        labels: (C,) names.
        units: (C,) as the file states them (``"V"``), empty where it does not.
        values: (S, C).
    """

    rate: float
    labels: tuple[str, ...]
    units: tuple[str, ...]
    values: Array


@dataclass(frozen=True)
class ForcePlate:
    """One force plate, in the axes of the recording.

    Attributes:
        rate: samples a second [Hz].
        force: (S, 3) on the plate, as its channels say [N].
        moment: (S, 3) about its origin [Nm].
        centre_of_pressure: (S, 3) [m].
        corners: (4, 3) [m].
    """

    rate: float
    force: Array
    moment: Array
    centre_of_pressure: Array
    corners: Array


@dataclass(frozen=True)
class Recording:
    """Marker trajectories of one trial.

    Attributes:
        source: the file, for messages.
        rate: frames a second [Hz].
        time: (F,) as the file counts it [s].
        labels: (M,) marker names as in the file.
        points: (F, M, 3) [in ``units``], NaN where a marker was not seen.
        units: unit of length of the file, None if it states none.
        up: axis that points up according to the file, None if it states none.
        analog: analog channels, or None.
        plates: force plates.
        notes: what was repaired or left out, one sentence each.
        events: name (with its side in front, if it has one) and time [s] of what was marked in the trial.
    """

    source: str
    rate: float
    time: Array
    labels: tuple[str, ...]
    points: Array
    units: str | None = None
    up: str | None = None
    analog: AnalogChannels | None = None
    plates: tuple[ForcePlate, ...] = ()
    notes: tuple[str, ...] = field(default=())
    events: tuple[tuple[str, float], ...] = ()

    def index(self, label: str) -> int:
        """Return the channel of a marker by its label, or by what follows the last colon (``"Anna:STER"``).

        Raises:
            InputError: no channel has that label, or several have.
        """
        exact = [i for i, name in enumerate(self.labels) if name == label]
        found = exact or [i for i, name in enumerate(self.labels) if name.rpartition(":")[2] == label]
        if len(found) == 1:
            return found[0]
        if found:
            channels = ", ".join(f"{i + 1} ({self.labels[i]})" for i in found)
            raise InputError(
                self.source, label, f"the marker is on the channels {channels}; give its full, unique label"
            )
        raise InputError(self.source, label, f"no such marker; the file has {', '.join(self.labels) or 'none'}")

    def select(self, labels: tuple[str, ...]) -> Recording:
        """Return the recording with these markers only, named as asked for."""
        channels = [self.index(label) for label in labels]
        return replace(self, labels=labels, points=self.points[:, channels])


def checked_recording(recording: Recording) -> Recording:
    """Return a recording fresh from a file with what exporters write for "not seen" turned into NaN, and noted.

    Points at exactly (0, 0, 0), points with one coordinate missing and points further away than anything is count as
    not seen; of channels with the same label and the same data one is kept.

    Raises:
        InputError: no frames, no markers, no usable frame rate, or no marker was ever seen.
    """
    source = recording.source
    frames, markers = recording.points.shape[:2]
    if not markers:
        raise InputError(source, NO_VALUE, "holds no markers, so there is no motion to be had from it")
    if not frames:
        raise InputError(source, NO_VALUE, "holds no frames")
    if not np.isfinite(recording.rate) or not 1.0 <= recording.rate <= 10_000.0:
        raise InputError(source, recording.rate, "is no usable frame rate; it must be from 1 to 10000 Hz")
    points, notes = recording.points.copy(), list(recording.notes)
    blank = [i for i, label in enumerate(recording.labels) if not label]
    if blank:
        which = ", ".join(f"*{i + 1}" for i in blank[:3]) + (", ..." if len(blank) > 3 else "")
        notes.append(f"{len(blank)} markers have no label: {which} by their channel")
        labels = tuple(label or f"*{i + 1}" for i, label in enumerate(recording.labels))
        recording = replace(recording, labels=labels)
    zeros = np.all(points == 0.0, axis=2)
    points[zeros] = np.nan
    for channel in np.flatnonzero(zeros.any(axis=0)):
        notes.append(f"{recording.labels[channel]}: {zeros[:, channel].sum()} points at the origin taken as not seen")
    beyond = np.any(np.abs(points) > SENTINEL, axis=2)  # infinite ones too
    for channel in np.flatnonzero(beyond.any(axis=0)):
        rows = points[:, channel]
        value = rows[np.abs(rows) > SENTINEL][0]
        notes.append(f"{recording.labels[channel]}: {beyond[:, channel].sum()} points at {value:.7g} taken as not seen")
    points[beyond | ~np.isfinite(points).all(axis=2)] = np.nan
    if np.isnan(points).all():
        raise InputError(source, NO_VALUE, "no marker was seen in any frame")
    recording = replace(recording, points=points, notes=tuple(notes))
    return _without_twins(recording)


def _without_twins(recording: Recording) -> Recording:
    keep, notes = list(range(len(recording.labels))), list(recording.notes)
    for label, count in Counter(recording.labels).items():
        if count == 1:
            continue
        first, *others = [i for i, name in enumerate(recording.labels) if name == label]
        for other in others:
            same = np.array_equal(recording.points[:, first], recording.points[:, other], equal_nan=True)
            what = "with the same data: dropped" if same else "with other data: the label cannot be mapped"
            notes.append(f"{label}: channel {other + 1} has the label of channel {first + 1}, {what}")
            if same:
                keep.remove(other)
    labels = tuple(recording.labels[i] for i in keep)
    return replace(recording, labels=labels, points=recording.points[:, keep], notes=tuple(notes))


def in_metres(recording: Recording, units: str | None, up: str) -> Recording:
    """Return the recording in metres and with Z up.

    The mapping's unit wins over that of the file, which may be misspelt or wrong; that is noted.

    Args:
        recording: as read.
        units: of the file according to the mapping, None to take what the file states.
        up: axis of the file that points up according to the mapping, a key of ``TO_Z_UP``.

    Raises:
        InputError: the unit is not known or cannot be right: the markers would lie too close together, or too far
            apart, to be on a person.
    """
    notes = list(recording.notes)
    scale = _scale(recording, units, notes)
    if recording.up and recording.up != up:
        # Exporters fill it in carelessly; whether the person stands is checked later.
        notes.append(f"the file's vertical screen axis is {recording.up}, the mapping says that {up} points up")
    turn = TO_Z_UP[up]
    _check_size(recording, scale, units)
    plates = tuple(
        replace(
            plate,
            force=plate.force @ turn.T,
            moment=plate.moment @ turn.T,
            centre_of_pressure=plate.centre_of_pressure @ turn.T,
            corners=plate.corners @ turn.T,
        )
        for plate in recording.plates
    )
    return replace(
        recording, points=scale * recording.points @ turn.T, units="m", up="Z", plates=plates, notes=tuple(notes)
    )


def _scale(recording: Recording, units: str | None, notes: list[str]) -> float:
    """Return the length of the unit [m]; note where mapping and file differ."""
    stated = recording.units
    of_file = metres_of(stated) if stated else None
    if units:
        scale = METRES[units]
        if stated and of_file != scale:
            notes.append(f"the file states {stated!r} as its unit of length; {units} is taken, as the mapping says")
        return scale
    if not stated:
        allowed = '"m", "cm" or "mm"'
        raise InputError("units", NO_VALUE, f"{recording.source} states no unit of length; the mapping must: {allowed}")
    if of_file is None:
        allowed = f'{", ".join(METRES)} are; the mapping may state the right one (units = "mm") and wins'
        raise InputError(recording.source, stated, f"is a unit of length that is not known; {allowed}")
    return of_file


def _check_size(recording: Recording, scale: float, units: str | None) -> None:
    seen = recording.points[~np.isnan(recording.points).all(axis=(1, 2))]
    if not len(seen):
        return  # whatever needs a marker names it
    seen = seen[:: max(len(seen) // 200, 1)]
    typical = float(np.nanmedian(np.linalg.norm(seen - np.nanmedian(seen, axis=1, keepdims=True), axis=2)))
    key, value = ("units", units) if units else (recording.source, recording.units)
    if not SMALLEST_CLOUD <= typical * scale <= LARGEST_CLOUD:
        fitting = [name for name in ("m", "cm", "mm") if SMALLEST_CLOUD <= typical * METRES[name] <= LARGEST_CLOUD]
        change = ""
        if fitting:
            change = f'; the mapping\'s units = "{fitting[0]}" would make it {typical * METRES[fitting[0]]:.2f} m'
        raise InputError(
            key,
            value,
            f"cannot be the unit of length: half of the markers would lie within {_length(typical * scale)} of their "
            f"middle{change}",
        )
    extent = float(np.nanmax(np.abs(recording.points))) * scale
    if extent > LARGEST_ROOM:
        frame, marker, _ = np.unravel_index(int(np.nanargmax(np.abs(recording.points))), recording.points.shape)
        raise InputError(
            recording.source,
            NO_VALUE,
            f"places {recording.labels[int(marker)]} {extent:.3g} m from its origin in frame {frame}; is that a place?",
        )


def _length(metres: float) -> str:
    return f"{1000.0 * metres:.3g} mm" if metres < 1.0 else f"{metres:.3g} m"
