"""MOT and STO files: named columns over time, as OpenSim and its relatives write joint angles, moments and forces."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.mocap.text_file import check_rising, contradictions, number_table, read_lines
from liftopt.types import Array

WHAT = "a MOT or STO file"


@dataclass(frozen=True)
class MotionTable:
    """Columns over time, as another tool wrote them.

    Attributes:
        source: the file, for messages.
        title: its first line.
        in_degrees: what the file says of its angles; None if it says nothing.
        time: (K,) [s].
        names: (C,) columns without the time.
        values: (K, C) in the units of the file.
        notes: what was repaired, one sentence each.
    """

    source: str
    title: str
    in_degrees: bool | None
    time: Array
    names: tuple[str, ...]
    values: Array
    notes: tuple[str, ...]

    def column(self, name: str) -> Array:
        """Return one column (K,).

        Raises:
            InputError: there is none of that name.
        """
        if name not in self.names:
            raise InputError(self.source, name, f"no such column; the file has {', '.join(self.names)}")
        return self.values[:, self.names.index(name)]


def read_motion_table(path: Path) -> MotionTable:
    """Return the columns of a MOT or STO file.

    Layout: a title, ``key=value`` lines and remarks, ``endheader``, the names of the columns, rows. Rows may be
    separated by tabs, commas or blanks. Where counts of the header contradict the rows, the rows are believed and that
    is noted.

    Raises:
        InputError: the file cannot be read or is not laid out so, a name stands twice, or time does not increase; the
            message names the line.
    """
    (lines, notes), source = read_lines(path, WHAT), str(path)
    end = next((i for i, line in enumerate(lines) if line.fields[:1] == ("endheader",)), None)
    if end is None or end + 1 >= len(lines):
        raise InputError(source, NO_VALUE, f"has no line endheader with columns after it, so it is not {WHAT}")
    pairs = [" ".join(line.filled).partition("=") for line in lines[:end]]
    header = {key.strip().lower(): value.strip() for key, equals, value in pairs if equals}
    at = next((i for i in range(end + 1, len(lines)) if lines[i].filled), None)
    if at is None:
        raise InputError(source, NO_VALUE, "names no columns after endheader")
    names = lines[at].filled
    if names[0].lower() != "time":
        raise lines[at].error(names[0], "the first column must be time")
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise lines[at].error(twice[0], "the name stands over two columns")
    table, used, more = number_table(lines[at + 1 :], names)
    if not len(table):
        raise InputError(source, NO_VALUE, "holds no rows")
    notes += more + contradictions(header, {"nrows": len(table), "ncolumns": len(names)})
    time = table[:, 0]
    check_rising(time, used)
    degrees = {"yes": True, "no": False}.get(header.get("indegrees", "").lower())
    title = " ".join(lines[0].filled)
    return MotionTable(source, title, degrees, time, names[1:], table[:, 1:], tuple(notes))
