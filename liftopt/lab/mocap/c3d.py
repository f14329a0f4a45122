"""C3D files of any maker: markers, analog channels and force plates.

Our own reader, since libraries refuse or crash on files that are complete but for a parameter that says nothing new.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.bounded_read import read_regular
from liftopt.lab.mocap.c3d_frames import (
    LAST_COUNTED,
    FrameLayout,
    data_start,
    frame_layout,
    frame_numbers,
    stated_frames,
)
from liftopt.lab.mocap.c3d_parameters import BLOCK, C3dHeader, C3dParameters, parameter_start, read_header
from liftopt.lab.mocap.c3d_plates import force_plates
from liftopt.lab.mocap.recording import TO_Z_UP, AnalogChannels, ForcePlate, Recording, checked_recording
from liftopt.types import Array

LARGEST_FILE = 2**31  # bytes; an hour of 60 markers at 100 Hz and 16 channels at 1000 Hz is a sixth of it


def read_c3d(path: Path) -> Recording:
    """Return the markers, analog channels and force plates of a C3D file.

    A point whose residual is negative was not seen. A file that holds fewer frames than its header says is read as far
    as it goes, and that is noted; so is whatever had to be taken from elsewhere because a parameter is missing.

    Raises:
        InputError: the file cannot be read, is no C3D file or is damaged, or has no markers or frames.
    """
    source = str(path)
    content = _content(path)
    header, notes = read_header(content)
    start = _bounded(header.data_block, len(content))
    parameters = C3dParameters(content[:start], header.processor)
    if parameters.damage:
        notes.append(f"its parameters are damaged or incomplete: {parameters.damage}")
    start = data_start(source, header, parameters, content)
    available = len(content) - start
    layout, more = frame_layout(header, parameters, stated_frames(header, parameters, available, 0)[0], available)
    notes += more
    stated, first = stated_frames(header, parameters, available, layout.size)
    _check(source, stated, layout)
    unsigned = "UNSIGNED" in (text.upper() for text in parameters.texts("ANALOG", "FORMAT"))
    points, fourth, raw = frame_numbers(content, start, header, layout, stated, unsigned)
    frames = len(points)
    if not frames:
        raise InputError(source, NO_VALUE, f"is cut short: no frame is left of the {stated} of its header")
    named = header.last - header.first + 1
    if frames != stated or (named != stated and 0 < named < LAST_COUNTED - header.first):
        of_header = stated if frames != stated else named
        notes.append(f"the header says {of_header} frames, the file holds {frames}: it is cut short or mislabelled")
    rate = _rate(header, parameters, notes)
    analog, more = _analog(raw, layout, rate, parameters, unsigned)
    units = next(iter(parameters.texts("POINT", "UNITS")), "")
    screen = next(iter(parameters.texts("POINT", "Y_SCREEN")), "").replace("+", "").upper()
    plates, trouble = _plates(parameters, analog, units)
    labels = parameters.texts("POINT", "LABELS")[: layout.points]
    labels += [""] * (layout.points - len(labels))
    begin = (first - 1) / rate if rate > 0.0 else 0.0
    return checked_recording(
        Recording(
            source=source,
            rate=rate,
            time=begin + np.arange(frames) / rate if rate > 0.0 else np.zeros(frames),
            labels=tuple(labels),
            points=np.where((fourth < 0.0)[:, :, None], np.nan, points),
            units=units or None,
            up=screen if screen in TO_Z_UP else None,
            analog=analog,
            plates=plates,
            notes=tuple([*notes, *more, *trouble]),
            events=_events(parameters),
        )
    )


def _content(path: Path) -> bytes:
    source = str(path)
    try:
        content = read_regular(path, LARGEST_FILE, "expected a C3D file")
    except FileNotFoundError:
        raise InputError(source, NO_VALUE, "no such file") from None
    if not content:
        raise InputError(source, NO_VALUE, "is empty")
    if len(content) < 2 or content[1] != 0x50:  # the key of every C3D file
        raise InputError(source, NO_VALUE, "is not a C3D file (its second byte is not 0x50)")
    if len(content) < BLOCK:
        raise InputError(source, NO_VALUE, f"is cut short within its header: {len(content)} of {BLOCK} bytes")
    if parameter_start(content) + 4 > len(content):
        raise InputError(source, NO_VALUE, "is cut short: it ends before its parameters")
    return content


def _bounded(block: int, size: int) -> int:
    """Return where parameters must have ended: at the frames, if the header says where these start."""
    return BLOCK * (block - 1) if block > 2 and BLOCK * (block - 1) <= size else size


def _check(source: str, stated: int, layout: FrameLayout) -> None:
    if not layout.points:
        raise InputError(source, NO_VALUE, "holds no markers, so there is no motion to be had from it")
    if stated <= 0:
        raise InputError(source, NO_VALUE, "states no frames, neither in its header nor in POINT:FRAMES")


def _rate(header: C3dHeader, parameters: C3dParameters, notes: list[str]) -> float:
    stated = parameters.numbers("POINT", "RATE")
    rates = [float(stated[0])] if stated is not None else []
    usable = [rate for rate in (*rates, header.rate) if np.isfinite(rate) and rate > 0.0]
    if len(usable) == 2 and abs(usable[0] - usable[1]) > 1e-3 * usable[0]:
        notes.append(f"POINT:RATE is {usable[0]:g} Hz, the header says {usable[1]:g} Hz: the first is taken")
    return usable[0] if usable else header.rate


def _analog(
    raw: Array, layout: FrameLayout, rate: float, parameters: C3dParameters, unsigned: bool
) -> tuple[AnalogChannels | None, list[str]]:
    """Return the analog channels, offset and scaled as the file states it, and notes."""
    if not raw.size:
        return None, []
    count, notes = layout.channels, []
    scale, offset = parameters.numbers("ANALOG", "SCALE"), parameters.numbers("ANALOG", "OFFSET")
    if scale is None:
        return None, ["ANALOG:SCALE is missing: what its channels mean is not known, they are left aside"]
    if len(scale) < count:
        notes.append(f"ANALOG:SCALE is missing for channels {len(scale) + 1} to {count}: they are left aside")
        count = len(scale)
        raw = raw[:, :count]
    if offset is None:
        notes.append("ANALOG:OFFSET is missing: taken as 0")
    offsets = np.zeros(count)
    if offset is not None:
        offsets[: len(offset)] = offset[:count]
    if unsigned:
        offsets = np.where(offsets < 0.0, offsets + 65536.0, offsets)
    whole = parameters.numbers("ANALOG", "GEN_SCALE")
    values = (raw - offsets) * scale[:count] * (1.0 if whole is None else whole[0])
    labels = parameters.texts("ANALOG", "LABELS")
    labels = (labels + [f"channel {i + 1}" for i in range(len(labels), count)])[:count]
    units = (parameters.texts("ANALOG", "UNITS") + [""] * count)[:count]
    return AnalogChannels(layout.samples * rate, tuple(labels), tuple(units), values), notes


def _events(parameters: C3dParameters) -> tuple[tuple[str, float], ...]:
    """Return the events by time; C3D has each as minutes and seconds."""
    times, labels = parameters.numbers("EVENT", "TIMES"), parameters.texts("EVENT", "LABELS")
    if times is None:
        return ()
    pairs = np.ravel(times)[: 2 * (np.size(times) // 2)].reshape(-1, 2)
    sides = parameters.texts("EVENT", "CONTEXTS")
    sides += [""] * (len(labels) - len(sides))
    named = [
        (f"{side.strip()} {label.strip()}".strip(), float(60.0 * minutes + seconds))
        for side, label, (minutes, seconds) in zip(sides, labels, pairs, strict=False)
    ]
    return tuple(sorted(named, key=lambda one: one[1]))


def _plates(
    parameters: C3dParameters, analog: AnalogChannels | None, units: str
) -> tuple[tuple[ForcePlate, ...], list[str]]:
    if analog is None:
        return (), []
    try:
        return force_plates(parameters, analog, units), []
    except ValueError as error:
        return (), [f"force plates are stated but could not be read: {error}"]
