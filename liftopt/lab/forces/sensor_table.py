"""Tables of sensors as CSV: a header that states units, ``#`` remarks, and a last line that a crash may have cut."""

from __future__ import annotations

import csv
import re
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.mocap.text_file import Line, check_decimals, text_lines
from liftopt.types import Array

WORDS = ("mark", "series", "channel", "flags")  # columns of words; all others hold numbers and state their unit
SIGNATURE = "# liftopt"  # first words of the files that liftopt writes: every line of theirs ends with a newline


@dataclass(frozen=True)
class SensorTable:
    """Named columns with units.

    Attributes:
        source: the file.
        header: its header.
        lines: of the rows, for messages.
        names: (C,) columns of numbers.
        units: (C,) their units as stated.
        values: (S, C), NaN where a field is empty.
        words: the columns of words, (S,) each.
        notes: what was left out, one sentence each.
    """

    source: str
    header: Line
    lines: tuple[Line, ...]
    names: tuple[str, ...]
    units: tuple[str, ...]
    values: Array
    words: dict[str, tuple[str, ...]]
    notes: tuple[str, ...]

    def scaled(self, name: str, scales: dict[str, float]) -> Array:
        """Return one column (S,), its unit turned into the one whose scale is 1.

        Raises:
            InputError: there is no such column, or its unit is not among ``scales``.
        """
        if name not in self.names:
            raise self.header.error(", ".join(self.names), f"has no column {name} [{' or '.join(scales)}]")
        column = self.names.index(name)
        unit = self.units[column]
        if unit not in scales:
            raise self.header.error(f"{name} [{unit}]", f"the unit must be {' or '.join(scales)}")
        return np.asarray(self.values[:, column] * scales[unit], float)


def read_sensor_table(path: Path, what: str) -> SensorTable:
    """Return the table of a CSV file: fields separated by commas, semicolons or tabs, columns named ``name [unit]``.

    Decimal commas are read where semicolons or tabs separate the fields.

    Args:
        path: of the file.
        what: the kind of file expected (``"a recording of forces"``), for messages.

    Raises:
        InputError: the file cannot be read, states no units, or a field is wrong; the message names the line.
    """
    source = str(path)
    split, notes = text_lines(path, what)
    ours = split[0].startswith(SIGNATURE)
    if ours and split[-1]:
        # Its fields may be all there and the last number still short of digits.
        notes.append(f"line {len(split)} was cut off while it was written: left out")
        split[-1] = ""
    data = [(i, line) for i, line in enumerate(split, start=1) if _is_data(line)]
    if not data:
        raise InputError(source, NO_VALUE, f"holds no rows; expected {what}")
    delimiter = next((mark for mark in "\t;," if mark in data[0][1]), ",")
    lines = [Line(source, i, _fields(line, delimiter)) for i, line in data]
    header, rows = replace(lines[0], fields=lines[0].filled), lines[1:]
    names, units = _header(header)
    count = len(names)
    if rows and len(rows[-1].fields) < count and not ours:
        notes.append(f"line {rows[-1].number} ends after {len(rows[-1].fields)} of {count} fields: left out")
        rows = rows[:-1]
    # A separator behind the last value, as sketches and spreadsheets write it, starts no column.
    rows = [
        replace(line, fields=line.fields[:count]) if len(line.filled) <= count < len(line.fields) else line
        for line in rows
    ]
    for line in rows:
        if len(line.fields) != count:
            hint = "; where commas are decimal, semicolons must separate the fields" if delimiter == "," else ""
            raise line.error(f"{len(line.fields)} fields", f"the header names {count} columns{hint}")
    numbers = [i for i in range(count) if names[i] not in WORDS]
    check_decimals(rows, numbers)
    values = [[_number(line, i, names[i]) for i in numbers] for line in rows]
    return SensorTable(
        source=source,
        header=header,
        lines=tuple(rows),
        names=tuple(names[i] for i in numbers),
        units=tuple(units[i] for i in numbers),
        values=np.array(values, float).reshape(len(rows), len(numbers)),
        words={name: tuple(line.fields[i] for line in rows) for i, name in enumerate(names) if name in WORDS},
        notes=tuple(notes),
    )


def _header(line: Line) -> tuple[list[str], list[str]]:
    names, units = [], []
    for text in line.fields:
        found = re.fullmatch(r"(.*?)\s*(?:\[([^\[\]]*)\]|\(([^()]*)\))?", text)
        name, unit = (found[1].strip().lower(), (found[2] or found[3] or "").strip()) if found else (text, "")
        if not name:
            raise line.error(text, "a column has no name")
        if not unit and name not in WORDS:
            raise line.error(text, "a column states no unit; write it behind the name: time [s], finger1 [V]")
        if name in names:
            raise line.error(text, "two columns have this name")
        names.append(name)
        units.append(unit)
    return names, units


def _fields(line: str, delimiter: str) -> tuple[str, ...]:
    fields = line.split(delimiter)
    if '"' in line:  # a spreadsheet with decimal commas quotes its numbers where commas separate them too
        with suppress(csv.Error):
            fields = next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), fields)
    return tuple([field.strip().strip('"') for field in fields])


def _number(line: Line, column: int, name: str) -> float:
    value = line.number_at(column, name)
    if np.isinf(value):
        raise line.error(line.fields[column], f"the column {name} must hold finite numbers")
    return value


def _is_data(line: str) -> bool:
    return bool(line.strip(" ,;\t")) and not line.startswith("#")
