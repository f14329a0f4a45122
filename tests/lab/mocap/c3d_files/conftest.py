"""C3D files of any maker, byte by byte after the C3D User Guide (Motion Lab Systems 2008)."""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

PROCESSORS = {"Intel": 84, "DEC": 85, "MIPS": 86}
LABELS = ("A", "B", "C")
FRAMES, SAMPLES, CHANNELS = 30, 4, 6


class C3dFile:
    """A file as its maker meant it, to be changed before it is written.

    Attributes:
        points: (F, M, 3) [mm], not seen where ``unseen`` (F, M).
        analog: (F * SAMPLES, C) as it is to be read, that is, with the offset subtracted and scaled.
        parameters: by group and name; numbers that are whole are 16-bit integers, others floats.
        header: words by index that stand there instead of the right ones.
        processor: Intel, DEC or MIPS.
        floats: points and analog numbers are floats.
    """

    def __init__(self) -> None:
        rng = np.random.default_rng(4)
        self.points = np.round(rng.uniform(-900.0, 900.0, (FRAMES, len(LABELS), 3)), 1)
        self.unseen = np.zeros((FRAMES, len(LABELS)), dtype=bool)
        self.unseen[5, 1] = True
        self.analog = 0.5 * rng.integers(-2000, 2000, (FRAMES * SAMPLES, CHANNELS))
        self.processor, self.floats = "Intel", True
        self.header: dict[int, int] = {}
        self.parameters: dict[str, dict[str, Any]] = {
            "POINT": {
                "USED": len(LABELS), "FRAMES": FRAMES, "SCALE": -0.1, "RATE": 100.0, "DATA_START": 0,
                "LABELS": list(LABELS), "UNITS": ["mm"],
            },
            "ANALOG": {
                "USED": CHANNELS, "RATE": 100.0 * SAMPLES, "GEN_SCALE": 1.0, "OFFSET": [0] * CHANNELS,
                "SCALE": [0.5] * CHANNELS, "LABELS": [f"F{k}" for k in range(CHANNELS)], "UNITS": ["N"] * CHANNELS,
            },
        }  # fmt: skip

    def write(self, path: Path) -> Path:
        """Write the file; return its path."""
        path.write_bytes(self.content())
        return path

    def content(self) -> bytes:
        """Return the file's bytes."""
        point = self.parameters.get("POINT", {})
        if "SCALE" in point:
            point["SCALE"] = self._scale
        section = self._section()
        blocks = -(-len(section) // 512)
        if "DATA_START" in point:
            point["DATA_START"] = 2 + blocks
            section = self._section()
        start = bytes([1, 0x50, blocks, PROCESSORS[self.processor]])
        return self._header(2 + blocks) + start + section[4:].ljust(512 * blocks - 4, b"\0") + self._data()

    @property
    def _scale(self) -> float:
        return -0.1 if self.floats else 0.1

    def _header(self, data_block: int) -> bytes:
        per_frame = self.analog.shape[1] * SAMPLES
        words = [0x5002, self.points.shape[1], per_frame, 1, len(self.points), 0, 0, 0, data_block, SAMPLES]
        for index, word in self.header.items():
            words[index] = word
        raw = bytearray(b"".join(self._int(word) for word in words))
        raw[:2] = b"\x02\x50"
        raw[12:16] = self._float(self._scale)
        return bytes(raw + self._float(100.0)).ljust(512, b"\0")

    def _section(self) -> bytes:
        records = []
        for number, (group, parameters) in enumerate(self.parameters.items(), start=1):
            records.append((group, -number, b"\0"))
            records += [(name, number, self._values(value) + b"\0") for name, value in parameters.items()]
        result = b"\0" * 4
        for k, (name, number, body) in enumerate(records):
            step = 0 if k == len(records) - 1 else 2 + len(body)
            result += struct.pack("bb", len(name), number) + name.encode("latin-1") + self._int(step) + body
        return result

    def _values(self, value: Any) -> bytes:
        values = np.asarray(value)
        if values.dtype.kind == "U":
            width = max(len(text) for text in value)
            texts = b"".join(text.encode("latin-1").ljust(width) for text in value)
            return struct.pack("bBBB", -1, 2, width, len(value)) + texts
        kind, form = (4, self._float) if values.dtype.kind == "f" else (2, self._int)
        # As stored: the first index runs fastest.
        body = b"".join(form(one) for one in values.ravel(order="F").tolist())
        return struct.pack("bB", kind, values.ndim) + bytes(values.shape) + body

    def _data(self) -> bytes:
        scale = self.parameters.get("ANALOG", {}).get("SCALE", [0.5] * CHANNELS)[: self.analog.shape[1]]
        offset = self.parameters.get("ANALOG", {}).get("OFFSET", [0] * CHANNELS)[: self.analog.shape[1]]
        fourth = np.where(self.unseen, -1.0, 0.0)[:, :, None]
        places = self.points if self.floats else np.round(self.points / 0.1)
        points = np.concatenate([places, fourth], axis=2).reshape(len(self.points), -1)
        stored = self.analog / np.array(scale) + np.array(offset)
        numbers = np.concatenate([points, stored.reshape(len(points), -1)], axis=1).ravel()
        form = self._float if self.floats else self._int
        data = b"".join(form(one) for one in numbers.tolist())
        return data.ljust(-(-len(data) // 512) * 512, b"\0")

    def _int(self, value: float) -> bytes:
        return struct.pack(">H" if self.processor == "MIPS" else "<H", round(value) % 65536)

    def _float(self, value: float) -> bytes:
        if self.processor == "DEC":  # four times as much, words exchanged
            raw = struct.pack("<f", 4.0 * value)
            return raw[2:] + raw[:2]
        return struct.pack(">f" if self.processor == "MIPS" else "<f", value)


@pytest.fixture
def c3d_file() -> C3dFile:
    """Return a complete file of 30 frames with three markers and six analog channels, not written yet."""
    return C3dFile()


@pytest.fixture
def plain_points(c3d_file: C3dFile) -> Callable[[], Any]:
    """Return what its points are as read: NaN where a marker was not seen."""
    return lambda: np.where(c3d_file.unseen[:, :, None], np.nan, c3d_file.points)
