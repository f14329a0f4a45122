"""Header and parameters of a C3D file, of any maker and processor (C3D User Guide, Motion Lab Systems 2008)."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import Any

import numpy as np

from liftopt.types import Array

BLOCK = 512  # bytes
INTEL, DEC, MIPS = 84, 85, 86  # what the fourth byte of the parameter section says of the processor
NAMES = {INTEL: "Intel", DEC: "DEC", MIPS: "MIPS"}
CONTINUED = ("", *map(str, range(2, 10)))  # beyond 255 channels C3D goes on in LABELS2, SCALE2...


@dataclass(frozen=True)
class Parameter:
    """Values of one parameter.

    Attributes:
        values: (K,) numbers as stored in column order, or texts without the blanks around them.
        dimensions: as the file states them; of texts without the first one, their length.
    """

    values: tuple[Any, ...]
    dimensions: tuple[int, ...]


@dataclass(frozen=True)
class C3dHeader:
    """The first 512 bytes.

    Attributes:
        processor: INTEL, DEC or MIPS, whose numbers the whole file holds.
        points: in a frame.
        analogs: numbers of all analog channels in a frame.
        first, last: frames, the first is 1.
        scale: of integer points; negative where points and analogs are floats.
        data_block: where frames start, the first block is 1.
        analog_samples: of each channel in a frame.
        rate: frames a second [Hz].
    """

    processor: int
    points: int
    analogs: int
    first: int
    last: int
    scale: float
    data_block: int
    analog_samples: int
    rate: float


class C3dParameters:
    """Parameters by group and name.

    Args:
        content: of the whole file.
        processor: whose numbers it holds.

    Attributes:
        end: byte behind the last one that was understood.
        damage: why reading ended before the section did; empty if it did not.
    """

    def __init__(self, content: bytes, processor: int) -> None:
        self._processor, self.damage = processor, ""
        self._groups: dict[int, str] = {}
        self._found: dict[tuple[int, str], Parameter] = {}
        self.end = parameter_start(content) + 4
        while not self.damage and self._take(content):
            pass

    def get(self, group: str, name: str) -> Parameter | None:
        """Return a parameter, None if the file has none of that name."""
        found = (self._found.get((number, name)) for number, text in self._groups.items() if text == group)
        return next((one for one in found if one is not None), None)

    def numbers(self, group: str, name: str) -> Array | None:
        """Return the numbers (K,) of a parameter and of its continuations, None where it holds none."""
        parts = [self.get(group, name + suffix) for suffix in CONTINUED]
        values = [value for part in parts if part for value in part.values if not isinstance(value, str)]
        return np.array(values, float) if values else None

    def count(self, group: str, name: str) -> int | None:
        """Return a whole number that may be stored as a float or as 16 bits without sign, None where there is none."""
        values = self.numbers(group, name)
        if values is None or not np.isfinite(values[0]) or abs(values[0]) > 2**31:
            return None
        value = round(float(values[0]))
        return value + 65536 if -32768 <= value < 0 else value

    def texts(self, group: str, name: str) -> list[str]:
        """Return the texts of a parameter and of its continuations."""
        parts = [self.get(group, name + suffix) for suffix in CONTINUED]
        return [value for part in parts if part for value in part.values if isinstance(value, str)]

    def _take(self, content: bytes) -> bool:
        """Take in one record; return whether another follows."""
        at = self.end
        if at + 4 > len(content):  # they may end with the last block, without a zero behind them
            self.damage = "their end is missing" if at > len(content) or any(content[at:]) else ""
            return False
        length, number = struct.unpack_from("bb", content, at)
        length = abs(length)  # negative: locked
        if not length or not number:
            return False
        name = text_of(content[at + 2 : at + 2 + length]).upper()
        at += 2 + length
        if at + 2 > len(content):
            self.damage = f"{name} ends beyond the file"
            return False
        step = int.from_bytes(content[at : at + 2], "big" if self._processor == MIPS else "little")
        body = content[at + 2 : at + step if step else len(content)]
        if number < 0:
            self._groups.setdefault(-number, name)
        else:
            parameter = self._parameter(body)
            if parameter is not None:
                self._found.setdefault((number, name), parameter)
        self.end = at + max(step, 2)
        return step > 2

    def _parameter(self, body: bytes) -> Parameter | None:
        if len(body) < 2:
            return None
        kind, rank = struct.unpack_from("bB", body)
        dimensions = tuple(body[2 : 2 + rank])
        data = body[2 + rank :]
        count = int(np.prod(dimensions, dtype=float)) if dimensions else 1
        if len(dimensions) < rank or kind not in (-1, 1, 2, 4) or count * abs(kind) > len(data):
            return None
        data = data[: count * abs(kind)]
        if kind == -1:
            width = dimensions[0] if dimensions else 1
            texts = tuple(text_of(data[i : i + width]) for i in range(0, len(data), width)) if width else ()
            return Parameter(texts, dimensions[1:])
        if kind == 4:
            return Parameter(tuple(floats(data, self._processor).tolist()), dimensions)
        order = ">" if self._processor == MIPS else "<"
        values = np.frombuffer(data, np.int8 if kind == 1 else f"{order}i2")
        return Parameter(tuple(values.tolist()), dimensions)


def parameter_start(content: bytes) -> int:
    """Return the byte at which the parameter section starts; the second block where the file names none."""
    return BLOCK * (content[0] - 1) if content[0] > 1 else BLOCK


def read_header(content: bytes) -> tuple[C3dHeader, list[str]]:
    """Return the header of a C3D file of at least a block, and notes."""
    start = parameter_start(content)
    stated = content[start + 3] if len(content) > start + 3 else 0
    if stated in NAMES:
        return _header(content, stated), []
    # Some makers leave the byte out: the numbers themselves tell.
    guesses = [_header(content, processor) for processor in NAMES]
    found = next((one for one in guesses if 1.0 <= one.rate <= 10_000.0 and one.first <= one.last), guesses[0])
    return found, [f"its processor type {stated} is not known: read as that of {NAMES[found.processor]}"]


def _header(content: bytes, processor: int) -> C3dHeader:
    words = np.frombuffer(content[:BLOCK], ">u2" if processor == MIPS else "<u2")
    return C3dHeader(
        processor=processor,
        points=int(words[1]),
        analogs=int(words[2]),
        first=int(words[3]),
        last=int(words[4]),
        scale=float(floats(content[12:16], processor)[0]),
        data_block=int(words[8]),
        analog_samples=int(words[9]),
        rate=float(floats(content[20:24], processor)[0]),
    )


def floats(data: bytes, processor: int) -> Array:
    """Return the numbers (K,) of 4 bytes each: IEEE 754, or the F floating point of DEC.

    That one has its two words exchanged, an exponent that is larger by 2 and no infinities.
    """
    if processor == DEC:
        words = np.frombuffer(data, "<u2").reshape(-1, 2).astype(np.uint32)
        bits = words[:, 0] << 16 | words[:, 1]
        exponent = (bits >> 23 & 0xFF).astype(int)
        size = np.ldexp(1.0 + (bits & 0x7FFFFF) / 2.0**23, exponent - 129)
        return np.where(exponent == 0, 0.0, np.where(bits >> 31, -size, size))
    with np.errstate(invalid="ignore"):  # signalling NaNs, which damage makes
        return np.frombuffer(data, ">f4" if processor == MIPS else "<f4").astype(float)


def text_of(data: bytes) -> str:
    """Return a text without the blanks and NULs around it; what is no UTF-8 is in an 8-bit code."""
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    return text.strip("\0 \t\r\n")
