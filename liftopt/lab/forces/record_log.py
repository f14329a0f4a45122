"""The file of a recording in progress: whole lines, on the disk one by one, behind what is there already."""

from __future__ import annotations

import os
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path

from liftopt.errors import InputError
from liftopt.files.new_file import open_new, unwritable
from liftopt.lab.forces.sensor_table import SIGNATURE

TICK = 1e-4  # s, of the time column


class RecordLog:
    """A CSV that holds every line it was given, whenever the process or the machine ends.

    A line that cannot be written (the disk is full) is kept and tried again with the next one.

    Args:
        path: of the file, which must not exist.
        channels: names of the sensors.
        unit: of their values.
        device: what is recorded, for the file's head.
        start: what the clock showed at time 0.

    Attributes:
        problem: why lines are waiting to be written; empty if none are.
        rows: readings given so far.

    Raises:
        InputError: the file exists, or cannot be written.
    """

    def __init__(self, path: Path, channels: Sequence[str], unit: str, device: str, start: datetime) -> None:
        self.path, self.problem, self.rows = path, "", 0
        self._waiting, self._last = b"", -1.0
        self._file = open_new("--out", path)
        head = ["time [s]", "mark", *(f"{name} [{unit}]" for name in channels)]
        self._write(f"{SIGNATURE} record\n# time 0 is {start.isoformat(timespec='milliseconds')}\n# {_line(device)}\n")
        self._write(",".join(head) + "\n")
        if self.problem:
            os.close(self._file)
            path.unlink()  # it holds nothing, and would be in the way of the next attempt
            raise InputError("--out", str(path), f"cannot be written: {self.problem}")

    def row(self, time: float, mark: str, values: Sequence[float]) -> None:
        """Write a reading at a time [s]; the times of lines that arrived together are set one tick apart."""
        self._last = max(time, self._last + TICK)
        self.rows += 1
        self._write(",".join([f"{self._last:.4f}", mark, *(f"{value:.10g}" for value in values)]) + "\n")

    def remark(self, time: float, text: str) -> None:
        """Write what happened at a time [s]; readers of the table pass over it."""
        self._write(f"# {time:.3f} s: {_line(text)}\n")

    def close(self) -> None:
        """Write what waits, and close the file.

        Raises:
            InputError: lines could not be written.
        """
        self._write("")
        os.close(self._file)
        if self._waiting:
            count = self._waiting.count(b"\n")
            raise unwritable("--out", self.path, OSError(0, f"{self.problem}; the last {count} lines are lost"))

    def _write(self, text: str) -> None:
        self._waiting += text.encode("utf-8")
        try:
            while self._waiting:
                self._waiting = self._waiting[os.write(self._file, self._waiting) :]
            os.fsync(self._file)
        except OSError as error:
            self.problem = error.strerror or str(error)
        else:
            self.problem = ""


def _line(text: str) -> str:
    return " ".join(text.split())
