"""Text files of other tools as fields with their line numbers: tabs, commas or blanks, as each file has them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.recording import Array
from liftopt.regular_file import read_regular

LARGEST_FILE = 500_000_000  # bytes; an hour of 60 markers at 100 Hz in a TRC file


@dataclass(frozen=True)
class Line:
    """One line of a text file.

    Attributes:
        source: the file.
        number: of the line, the first is 1.
        fields: its fields, stripped; empty ones are kept where a delimiter shows them.
    """

    source: str
    number: int
    fields: tuple[str, ...]

    def error(self, value: object, allowed: str) -> InputError:
        """Return the error that names this line."""
        return InputError(f"{self.source}, line {self.number}", value, allowed)

    @property
    def filled(self) -> tuple[str, ...]:
        """The fields without the empty ones at the end."""
        count = len(self.fields)
        while count and not self.fields[count - 1]:
            count -= 1
        return self.fields[:count]

    def number_at(self, column: int, name: str) -> float:
        """Return one field as a number; NaN where it is empty.

        Raises:
            InputError: it is something else than a number.
        """
        text = self.fields[column] if column < len(self.fields) else ""
        if not text:
            return np.nan
        try:
            return float(text)
        except ValueError:
            raise self.error(text, f"the column {name} must hold numbers") from None


def read_lines(path: Path, what: str) -> list[Line]:
    """Return the lines of a text file, empty ones included.

    A line is split at its tabs; without a tab at its commas; without either at blanks.

    Args:
        path: of the file.
        what: the kind of file expected (``"a TRC file"``), for messages.

    Raises:
        InputError: the file cannot be read, is empty, too large, or not text.
    """
    # Names of markers and paths in headers may be in an 8-bit code; numbers never are.
    text, source = read_text(path, what).decode("utf-8-sig", errors="replace"), str(path)
    return [Line(source, i, _fields(line)) for i, line in enumerate(re.split(r"\r\n|\n|\r", text), start=1)]


def read_text(path: Path, what: str) -> bytes:
    """Return the bytes of a file that is not empty and holds text.

    Args:
        path: of the file.
        what: the kind of file expected (``"a TRC file"``), for messages.

    Raises:
        InputError: the file cannot be read, is empty, too large, or not text.
    """
    try:
        raw = read_regular(path, LARGEST_FILE, f"expected {what}")
    except FileNotFoundError:
        raise InputError(str(path), NO_VALUE, "no such file") from None
    if not raw.strip():
        raise InputError(str(path), NO_VALUE, f"is empty; expected {what}")
    if b"\0" in raw:
        raise InputError(str(path), NO_VALUE, f"is a binary file; expected {what}")
    return raw


def _fields(line: str) -> tuple[str, ...]:
    for delimiter in ("\t", ","):
        if delimiter in line:
            return tuple(field.strip() for field in line.split(delimiter))
    return tuple(line.split())


def contradictions(header: dict[str, str], counted: dict[str, int]) -> list[str]:
    """Return a note for each count of a header that is not what was ``counted`` under its key."""
    return [
        f"the header says {key} {stated}, the file holds {count}"
        for key, count in counted.items()
        if (stated := _stated_count(header.get(key))) is not None and stated != count
    ]


def check_rising(time: Array, lines: list[Line]) -> None:
    """Check that the times (K,) of ``lines`` are numbers that increase.

    Raises:
        InputError: one is not; it names the line.
    """
    for i in range(len(time)):
        if not np.isfinite(time[i]) or (i and time[i] <= time[i - 1]):
            raise lines[i].error(float(time[i]), "the time must be a number that increases from line to line")


def _stated_count(text: str | None) -> int | None:
    """Return a count as a header states it, None if there is none or it is no whole number."""
    try:
        return None if text is None else int(float(text))
    except (ValueError, OverflowError):
        return None


def number_table(lines: list[Line], names: tuple[str, ...]) -> tuple[Array, list[Line], list[str]]:
    """Return the numbers of the lines that hold any, a row each, the lines used, and notes.

    A last line that ends early was cut off while it was written: it is left out and noted.

    Args:
        lines: after the header.
        names: of the columns, for messages and for their number.

    Raises:
        InputError: a line has more or fewer fields than there are columns, or a field is no number.
    """
    used = [line for line in lines if line.filled]
    notes: list[str] = []
    if used and _width(used[-1], len(names)) < len(names):
        notes.append(f"line {used[-1].number} ends after {len(used[-1].filled)} of {len(names)} fields: left out")
        used = used[:-1]
    for line in used:
        width = _width(line, len(names))
        if width != len(names):
            raise line.error(f"{width} fields", f"the header names {len(names)} columns")
    rows = [[line.number_at(column, name) for column, name in enumerate(names)] for line in used]
    return np.array(rows, dtype=float).reshape(-1, len(names)), used, notes


def _width(line: Line, expected: int) -> int:
    # Empty fields at the end are missing values up to the last column and nothing beyond it.
    return max(len(line.filled), min(len(line.fields), expected))
