"""Where a scenario is read from: a TOML file, one that is shipped, or the scenario that a result was solved for."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.bounded_read import read_regular
from liftopt.files.suggestions import MOST, did_you_mean, nearest
from liftopt.storage.result_folder import NETCDF, SCENARIO, first_entries, locked, results_in, standing_result

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

SHIPPED = Path(__file__).parent / "shipped"
LARGEST_FILE = 100_000  # bytes; a scenario has some 30 lines
MOST_DOTS = 200  # in a line; the longest key has two


def shipped_scenarios() -> tuple[str, ...]:
    """Return the names of the scenarios that come with liftopt."""
    return tuple(sorted(path.stem for path in SHIPPED.glob("*.toml")))


def read_scenario_file(source: str | Path) -> tuple[Path, dict[str, Any]]:
    """Return which file a scenario stands in, and its tables.

    Args:
        source: path of a TOML file, name of a shipped scenario (a str), or a result folder or its solution.nc, which
            stand for the scenario that was solved.

    Raises:
        InputError: the file cannot be read or is not TOML.
    """
    if source in shipped_scenarios():
        path = SHIPPED / f"{source}.toml"
        return path, _parsed(path)
    path = Path(source)
    folder = path.parent if path.name == NETCDF else path
    try:
        of_result = path.name == NETCDF or path.is_dir()
    except (OSError, ValueError):  # too long, a NUL: reading it says so
        of_result = False
    if not of_result:
        return path, _parsed(path)
    with locked(folder, to_write=False):
        path = standing_result(folder) / SCENARIO
        if not path.is_file():
            offer = did_you_mean([str(entry) for entry in results_in(folder)][:MOST])
            raise InputError(str(source), NO_VALUE, f"is not a file, nor a result folder with a {SCENARIO}{offer}")
        return path, _parsed(path)


def toml(text: str) -> dict[str, Any]:
    """Return the tables of a TOML text; raises ValueError or RecursionError."""
    # The parser takes the square of a key's parts in time: seconds for 10 000, an hour for a million.
    for number, line in enumerate(text.splitlines(), start=1):
        if line.count(".") > MOST_DOTS:
            raise ValueError(f"more than {MOST_DOTS} dots (in line {number})")
    return tomllib.loads(text)


def _parsed(path: Path) -> dict[str, Any]:
    try:
        return toml(_read(path))
    except (ValueError, RecursionError) as error:  # ValueError: TOMLDecodeError, or an integer of too many digits
        raise InputError(str(path), NO_VALUE, f"is not valid TOML: {error}") from None


def _read(path: Path) -> str:
    shown = str(path)
    try:
        raw = read_regular(path, LARGEST_FILE, "a scenario is a short TOML file")
    except FileNotFoundError:
        names = ", ".join(shipped_scenarios())
        raise InputError(shown, NO_VALUE, f"no such file, nor a shipped scenario ({names}){_meant(path)}") from None
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(shown, NO_VALUE, f"is not UTF-8 text (byte {error.start})") from None
    if "\0" in text:
        raise InputError(shown, NO_VALUE, "is a binary file; a scenario is a TOML file")
    return text


def _meant(path: Path) -> str:
    """Return the end of a message that says what a path that leads nowhere may have meant."""
    key, equals, value = str(path).partition("=")
    if equals and value and " " not in key:
        return f"; to change an entry write --set {path}"
    shipped = nearest(path.name.removesuffix(".toml"), shipped_scenarios())
    folder = path.parent
    there = {entry.stem: entry for entry in first_entries(folder) if entry.suffix == ".toml"}
    there |= {entry.name: entry for entry in results_in(folder)}
    stem = path.name if path.name in there else path.name.removesuffix(path.suffix)
    return did_you_mean([*(str(there[name]) for name in nearest(stem, there)), *shipped])
