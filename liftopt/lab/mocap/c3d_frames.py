"""Frames of a C3D file: how many there are, what stands in each, and their numbers as stored."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from liftopt.errors import InputError
from liftopt.lab.mocap.c3d_parameters import BLOCK, MIPS, C3dHeader, C3dParameters, floats, parameter_start
from liftopt.types import Array

LAST_COUNTED = 65535  # frames: where the 16 bits of the header end


@dataclass(frozen=True)
class FrameLayout:
    """What stands in a frame.

    Attributes:
        points: x, y, z and a fourth word of each.
        channels: analog, sampled ``samples`` times.
        samples: of each channel in a frame.
        scale: of integer points; negative where all numbers are floats.
    """

    points: int
    channels: int
    samples: int
    scale: float

    @property
    def numbers(self) -> int:
        """Numbers in a frame."""
        return 4 * self.points + self.channels * self.samples

    @property
    def size(self) -> int:
        """Bytes of a frame."""
        return self.numbers * (4 if self.scale < 0.0 else 2)


def frame_layout(
    header: C3dHeader, parameters: C3dParameters, frames: int, available: int
) -> tuple[FrameLayout, list[str]]:
    """Return the layout of the frames, and notes.

    Header and parameters state it twice. Where they contradict each other, the one whose frames fill the file is
    believed, else the header, which tells no more than that.

    Args:
        header: of the file.
        parameters: of the file.
        frames: as stated.
        available: bytes from the first frame to the end.
    """
    samples = header.analog_samples
    rate, analog_rate = parameters.numbers("POINT", "RATE"), parameters.numbers("ANALOG", "RATE")
    used, channels = parameters.count("POINT", "USED"), parameters.count("ANALOG", "USED")
    if rate is not None and analog_rate is not None and rate[0] > 0.0 and 0.5 <= analog_rate[0] / rate[0] < 1e5:
        samples = round(float(analog_rate[0] / rate[0]))
    samples, in_header = max(samples, 1), header.analog_samples or max(samples, 1)
    first = FrameLayout(header.points, header.analogs // in_header, in_header, header.scale)
    scale = parameters.numbers("POINT", "SCALE")
    second = FrameLayout(
        first.points if used is None else used,
        first.channels if channels is None else channels,
        samples,
        first.scale if scale is None or not np.isfinite(scale[0]) or not scale[0] else float(scale[0]),
    )
    if not np.isfinite(first.scale) or not first.scale:
        first = replace(first, scale=second.scale if second.scale else -1.0)
    if not np.isfinite(second.scale) or not second.scale:
        second = replace(second, scale=first.scale)
    notes = []
    if first.scale > 0.0 and second.scale > 0.0:
        if abs(first.scale - second.scale) > 1e-3 * second.scale:
            notes.append(f"POINT:SCALE is {second.scale:g}, the header says {first.scale:g}: the first is taken")
        first = replace(first, scale=second.scale)
    # The parameters may be right in one of these and wrong in another.
    mixed = (
        replace(first, points=second.points),
        replace(first, channels=second.channels, samples=second.samples),
        replace(first, scale=second.scale),
    )
    fits = [one for one in (first, second, *mixed) if one.size and 0 <= available - frames * one.size < BLOCK]
    usable = [one for one in (first, second, *mixed) if one.points and one.size <= available]
    chosen = (fits or usable or [first])[0]
    if used is not None and used != header.points:
        notes.append(f"POINT:USED is {used}, the header says {header.points} points: {chosen.points} are read")
    if used is None and header.points:
        notes.append("POINT:USED is missing: the number of points is that of the header")
    return chosen, notes


def stated_frames(header: C3dHeader, parameters: C3dParameters, available: int, size: int) -> tuple[int, int]:
    """Return how many frames the file states, and the first of them.

    Args:
        header: of the file.
        parameters: of the file.
        available: bytes from the first frame to the end.
        size: bytes of a frame; 0 where it is not known yet.
    """
    first = max(header.first, 1)
    # The header's 16 bits end at 65535 frames; longer trials have their ends in two words each, or floats.
    words = [parameters.numbers("TRIAL", f"ACTUAL_{end}_FIELD") for end in ("START", "END")]
    ends = [int(each[0]) % 65536 + 65536 * (int(each[1]) % 65536) if _is_pair(each) else 0 for each in words]  # type: ignore[index]
    counts = []
    if ends[1] >= ends[0] > 0:
        first = ends[0]
        counts.append(ends[1] - ends[0] + 1)
    counts += [parameters.count("POINT", "LONG_FRAMES") or 0]
    header_counts = header.last - header.first + 1 if header.last < LAST_COUNTED else 0
    counts += [header_counts, parameters.count("POINT", "FRAMES") or 0, header.last - header.first + 1]
    possible = [count for count in counts if count > 0]
    if size:
        found = available // size
        fitting = [count for count in possible if count <= found]
        filling = [count for count in fitting if available - count * size < BLOCK]
        if fitting and not filling and fitting[0] >= LAST_COUNTED - header.first:
            return max(fitting[0], found - BLOCK // size), first  # cut at 16 bits; padded by a block at most
        if fitting:
            return (filling or fitting)[0], first
    return (possible[0] if possible else 0), first


def _is_pair(words: Array | None) -> bool:
    return words is not None and len(words) == 2 and bool(np.isfinite(words).all())


def frame_numbers(
    content: bytes, start: int, header: C3dHeader, layout: FrameLayout, frames: int, unsigned: bool
) -> tuple[Array, Array, Array]:
    """Return points (F, P, 3) [in the file's unit], their fourth words (F, P) and analog numbers (S, C) as stored.

    Args:
        content: of the file.
        start: byte of the first frame.
        header: of the file.
        layout: of a frame.
        frames: to read at most.
        unsigned: integers of analog channels have no sign.
    """
    frames = min(frames, max(len(content) - start, 0) // layout.size) if layout.size else 0
    data, count = content[start : start + frames * layout.size], 4 * layout.points
    if layout.scale < 0.0:
        numbers = floats(data, header.processor).reshape(frames, layout.numbers)
        points, analogs = numbers[:, :count].reshape(frames, layout.points, 4), numbers[:, count:]
    else:
        order = ">" if header.processor == MIPS else "<"
        whole = np.frombuffer(data, f"{order}i2").reshape(frames, layout.numbers)
        points = whole[:, :count].reshape(frames, layout.points, 4).astype(float)
        points[:, :, :3] *= layout.scale
        analogs = whole[:, count:].astype(float)
        if unsigned:
            analogs = np.where(analogs < 0.0, analogs + 65536.0, analogs)
    channels = analogs.reshape(frames * layout.samples, layout.channels)
    return points[:, :, :3], points[:, :, 3], channels


def data_start(source: str, header: C3dHeader, parameters: C3dParameters, content: bytes) -> int:
    """Return the byte of the first frame: of the header, of POINT:DATA_START, or behind the parameters' blocks.

    Raises:
        InputError: none of them is within the file.
    """
    section = parameter_start(content)
    behind = section // BLOCK + 1 + content[section + 2]
    blocks = (header.data_block, parameters.count("POINT", "DATA_START") or 0, behind if content[section + 2] else 0)
    for block in blocks:
        if block > 2 and BLOCK * (block - 1) < len(content):
            return BLOCK * (block - 1)
    raise InputError(source, blocks[0], f"is the block of {BLOCK} bytes where its frames should start: not in the file")
