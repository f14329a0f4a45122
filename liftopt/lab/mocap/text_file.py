"""Text files of other tools as fields with their line numbers: tabs, commas or blanks, as each file has them."""

from __future__ import annotations

import codecs
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.bounded_read import read_regular
from liftopt.types import Array

LARGEST_FILE = 500_000_000  # bytes; an hour of 60 markers at 100 Hz in a TRC file
DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?")
NO_NUMBER = re.compile(r"[+-]?(?:1\.#(?:QNAN|SNAN|IND|INF)\d*|NaN\(.*\))", re.IGNORECASE)  # of C libraries


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
        """Return one field as a number, with a decimal point or comma; NaN where it is empty.

        Raises:
            InputError: it is something else than a number.
        """
        text = self.fields[column] if column < len(self.fields) else ""
        if not text:
            return np.nan
        try:
            return number_of(text)
        except ValueError:
            raise self.error(text, f"the column {name} must hold numbers") from None


def number_of(text: str) -> float:
    """Return a number with a decimal point or comma; NaN for what C libraries print instead of one.

    Raises:
        ValueError: it is none.
    """
    try:
        return float(text)
    except ValueError:
        if DECIMAL_COMMA.fullmatch(text):
            return float(text.replace(",", "."))
        if NO_NUMBER.fullmatch(text):
            return np.nan
        raise


def read_lines(path: Path, what: str) -> tuple[list[Line], list[str]]:
    """Return the lines of a text file, empty ones included, and notes.

    A line is split at its tabs; without a tab at semicolons, then at commas; without any at blanks. Commas between
    digits are decimal where others separate the fields.

    Args:
        path: of the file.
        what: the kind of file expected (``"a TRC file"``), for messages.

    Raises:
        InputError: the file cannot be read, is empty, too large, or not text; or it mixes decimal points and commas.
    """
    (split, notes), source = text_lines(path, what), str(path)
    return [Line(source, i, _fields(line)) for i, line in enumerate(split, start=1)], notes


def text_lines(path: Path, what: str) -> tuple[list[str], list[str]]:
    """Return the lines of a text file in UTF-8, UTF-16 or an 8-bit code, the last one without its end, and notes.

    NULs at the end, which a power cut leaves, are left out together with the line they cut.

    Raises:
        InputError: as of ``read_text``.
    """
    raw, notes = _without_tail(read_bytes(path, what))
    text = _decoded(raw)
    if "\0" in text:
        at = text[: text.index("\0")].count("\n") + 1
        raise InputError(str(path), NO_VALUE, f"is a binary file, or damaged from line {at} on; expected {what}")
    split = re.split(r"\r\n|\n|\r", text)
    if notes and split[-1]:
        notes = [f"{notes[0]}, with line {len(split)}, which they cut"]
        split[-1] = ""
    return split, notes


def read_text(path: Path, what: str) -> bytes:
    """Return the bytes of a file that is not empty and holds text.

    Args:
        path: of the file.
        what: the kind of file expected (``"a TRC file"``), for messages.

    Raises:
        InputError: the file cannot be read, is empty, too large, or not text.
    """
    raw = read_bytes(path, what)
    if b"\0" in raw:
        raise InputError(str(path), NO_VALUE, f"is a binary file; expected {what}")
    return raw


def read_bytes(path: Path, what: str) -> bytes:
    """Return the bytes of a file that is not empty.

    Raises:
        InputError: the file cannot be read, is empty or too large.
    """
    try:
        raw = read_regular(path, LARGEST_FILE, f"expected {what}")
    except FileNotFoundError:
        raise InputError(str(path), NO_VALUE, "no such file") from None
    if not raw.strip():
        raise InputError(str(path), NO_VALUE, f"is empty; expected {what}")
    if not raw.strip(b"\0 \r\n\t\x1a"):
        raise InputError(str(path), NO_VALUE, f"is a binary file: it holds nothing but NULs; expected {what}")
    return raw


def _without_tail(raw: bytes) -> tuple[bytes, list[str]]:
    text = raw.rstrip(b"\0\x1a")  # DOS programs end a text by 0x1A
    count = len(raw) - len(text)
    if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)) or _is_wide(raw):
        count -= (count + len(raw)) % 2  # the upper half of the last character
        text = raw[: len(raw) - count]
        text = text[: len(text) - len(text) % 2]
    nuls = raw[len(text) :].count(b"\0")
    return text, [f"it ends in {nuls} NUL bytes, as a power cut leaves them: left out"] if nuls else []


def _is_wide(raw: bytes) -> bool:
    """Return whether text is in UTF-16, little-endian, without the mark that says so."""
    start = raw[:200]
    return len(start) > 8 and start[1::2].count(0) > 0.9 * len(start[1::2]) and not start[::2].count(0)


def _decoded(raw: bytes) -> str:
    if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return raw.decode("utf-16", errors="replace")
    if _is_wide(raw):
        return raw.decode("utf-16-le", errors="replace")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        # Names of markers, units and paths may be in an 8-bit code; numbers never are.
        return raw.decode("latin-1")


def _fields(line: str) -> tuple[str, ...]:
    if "\t" in line:
        return tuple([field.strip() for field in line.split("\t")])
    if ";" in line:
        fields = [field.strip() for field in line.split(";")]
        if all("," not in field or DECIMAL_COMMA.fullmatch(field) for field in fields):
            return tuple(fields)
    blank = line.split()
    if "," in line and not (len(blank) > 1 and all(_is_number(field) for field in blank)):
        return tuple([field.strip() for field in line.split(",")])
    return tuple(blank)


def _is_number(text: str) -> bool:
    try:
        number_of(text)
    except ValueError:
        return False
    return True


def check_decimals(lines: list[Line], columns: Sequence[int]) -> None:
    """Check that the numbers of a table are written in one way: 1,234 may mean two things where 1.5 stands elsewhere.

    Args:
        lines: of the table.
        columns: of numbers.

    Raises:
        InputError: decimal points and commas stand in one file; it names the line where that changes.
    """
    seen = ""
    for line in lines:
        for column in columns:
            text = line.fields[column] if column < len(line.fields) else ""
            mark = "," if "," in text else "." if "." in text else ""
            if mark and seen and mark != seen:
                raise line.error(text, f"mixes decimal points and commas: further above it is {seen!r}")
            seen = seen or mark


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


def number_table(lines: list[Line], names: tuple[str, ...], group: int = 0) -> tuple[Array, list[Line], list[str]]:
    """Return the numbers of the lines that hold any, a row each, the lines used, and notes.

    A last line that ends early was cut off while it was written: it is left out and noted.

    Args:
        lines: after the header.
        names: of the columns, for messages and for their number.
        group: lines may go on behind the named columns by this many fields, or a multiple; 0 for none. What stands
            there is left out and noted. They may end as many fields early: what is not there is missing.

    Raises:
        InputError: a line has more or fewer fields than there are columns, or a field is no number.
    """
    used = [line for line in lines if line.filled]
    notes: list[str] = []
    if used and _width(used[-1], len(names)) < len(names):
        notes.append(f"line {used[-1].number} ends after {len(used[-1].filled)} of {len(names)} fields: left out")
        used = used[:-1]
    extra, first, short = 0, 0, []
    for line in used:
        width = _width(line, len(names))
        beyond = width - len(names)
        if (beyond and (not group or beyond % group)) or width <= group:
            raise line.error(f"{width} fields", f"the header names {len(names)} columns")
        if beyond < 0:
            short.append(line.number)
        if beyond > extra:
            extra, first = beyond, first or line.number
    if extra:
        notes.append(f"{extra} columns behind the {len(names)} that have a name are left out, from line {first} on")
    if short:
        notes.append(f"lines end before the last column, the first is line {short[0]}: markers there were not seen")
    check_decimals(used, range(len(names)))
    rows = [[line.number_at(column, name) for column, name in enumerate(names)] for line in used]
    return np.array(rows, dtype=float).reshape(-1, len(names)), used, notes


def _width(line: Line, expected: int) -> int:
    # Empty fields at the end are missing values up to the last column and nothing beyond it.
    return max(len(line.filled), min(len(line.fields), expected))
