"""Where a scenario is read from: a TOML file, or one that is shipped."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.bounded_read import first_entries, read_regular
from liftopt.files.suggestions import did_you_mean, nearest
from liftopt.files.toml_text import toml

SHIPPED = Path(__file__).parent / "shipped"
LARGEST_FILE = 100_000  # bytes; a scenario has some 30 lines


def shipped_scenarios() -> tuple[str, ...]:
    """Return the names of the scenarios that come with liftopt."""
    return tuple(sorted(path.stem for path in SHIPPED.glob("*.toml")))


def read_tables(source: str | Path) -> tuple[Path, dict[str, Any]]:
    """Return which file a scenario stands in, and its tables.

    Args:
        source: path of a TOML file, or the name of a shipped scenario (a str).

    Raises:
        InputError: the file cannot be read or is not TOML.
    """
    path = SHIPPED / f"{source}.toml" if source in shipped_scenarios() else Path(source)
    try:
        return path, toml(_read(path))
    except (ValueError, RecursionError) as error:  # ValueError: TOMLDecodeError, or an integer of too many digits
        raise InputError(str(path), NO_VALUE, f"is not valid TOML: {error}") from None


def no_scenario(path: Path, others: list[str]) -> InputError:
    """Return the error that a path leads to no scenario, with what it may have meant: ``others``, or files beside."""
    names = ", ".join(shipped_scenarios())
    why = f"no such file, nor a shipped scenario ({names})"
    key, equals, value = str(path).partition("=")
    if equals and value and " " not in key:
        return InputError(str(path), NO_VALUE, f"{why}; to change an entry write --set {path}")
    shipped = nearest(path.name.removesuffix(".toml"), shipped_scenarios())
    there = {entry.stem: entry for entry in first_entries(path.parent) if entry.suffix == ".toml"}
    near = [str(there[name]) for name in nearest(path.name.removesuffix(path.suffix), there)]
    return InputError(str(path), NO_VALUE, why + did_you_mean([*others, *near, *shipped]))


def _read(path: Path) -> str:
    shown = str(path)
    try:
        raw = read_regular(path, LARGEST_FILE, "a scenario is a short TOML file")
    except FileNotFoundError:
        raise no_scenario(path, []) from None
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(shown, NO_VALUE, f"is not UTF-8 text (byte {error.start})") from None
    if "\0" in text:
        raise InputError(shown, NO_VALUE, "is a binary file; a scenario is a TOML file")
    return text
