"""The kinds of entries a scenario has: what each accepts, in which unit, and how it refuses the rest.

A scenario is a tree of frozen dataclasses whose fields are annotated with these kinds; the annotation is all there is
to know of an entry, and reading, checking, writing and help follow from it.
"""

from __future__ import annotations

import dataclasses
import re
from abc import ABC, abstractmethod
from collections.abc import Hashable, Iterator, Mapping
from dataclasses import MISSING, dataclass
from functools import cache
from typing import Any, NamedTuple, cast, get_type_hints

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.number_text import number_meant
from liftopt.files.suggestions import did_you_mean, nearest


@dataclass(frozen=True)
class Kind(ABC):
    """One kind of entry.

    Attributes:
        about: what the entry is, in a few words.
    """

    about: str

    @property
    @abstractmethod
    def allowed(self) -> str:
        """What is accepted, in words that follow "must be"."""

    @abstractmethod
    def accept(self, key: str, value: Any) -> Any:
        """Return ``value`` as the entry keeps it; raise ``InputError`` naming ``key`` if it is not allowed."""

    def plain(self, value: Any) -> Any:
        """Return a kept value as TOML writes it."""
        return value

    def refuse(self, key: str, value: object) -> InputError:
        """Return the error that says what would have been accepted at ``key``."""
        return InputError(key, value, f"must be {self.allowed} ({self.about}){self.meant(value)}")

    def meant(self, value: object) -> str:
        """Return the end of a message that says how to write what ``value`` may have meant; empty if nothing."""
        return ""


@dataclass(frozen=True)
class Number(Kind):
    """A finite number in a closed range; whole numbers are taken for it, booleans are not.

    Attributes:
        unit: SI unit, empty if there is none.
        low, high: range, both ends allowed.
        open_low: ``low`` itself is not allowed.
        word: a word that may stand instead; it is kept as None.
    """

    unit: str
    low: float
    high: float
    open_low: bool = False
    word: str | None = None

    @property
    def allowed(self) -> str:  # noqa: D102
        span = f"above {self.low:g} and at most" if self.open_low else f"from {self.low:g} to"
        number = f"a number {span} {self.high:g} {self.unit}".rstrip()
        return number if self.word is None else f'{number}, or "{self.word}"'

    def accept(self, key: str, value: Any) -> float | None:  # noqa: D102
        if self.word is not None and (value is None or value == self.word):
            return None
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise self.refuse(key, value)
        if not self.low <= value <= self.high or (self.open_low and value == self.low):  # NaN fails the first
            raise self.refuse(key, value)
        return float(value)

    def meant(self, value: object) -> str:  # noqa: D102
        if self.word is not None and isinstance(value, str) and value.lower() == self.word:
            return f"; write {self.word}"
        return number_meant(value, self.unit, self.low, self.high)

    def plain(self, value: Any) -> Any:  # noqa: D102
        return self.word if value is None else value


@dataclass(frozen=True)
class Whole(Kind):
    """A whole number in a closed range."""

    low: int
    high: int

    @property
    def allowed(self) -> str:  # noqa: D102
        return f"a whole number from {self.low} to {self.high}"

    def accept(self, key: str, value: Any) -> int:  # noqa: D102
        if isinstance(value, bool) or not isinstance(value, int) or not self.low <= value <= self.high:
            raise self.refuse(key, value)
        return value

    def meant(self, value: object) -> str:  # noqa: D102
        if isinstance(value, float) and value.is_integer() and self.low <= value <= self.high:
            return f"; write {value:.0f}"
        offer = number_meant(value, "", self.low, self.high) if isinstance(value, str) else ""
        return "" if "." in offer else offer


@dataclass(frozen=True)
class Switch(Kind):
    """True or false."""

    @property
    def allowed(self) -> str:  # noqa: D102
        return "true or false"

    def accept(self, key: str, value: Any) -> bool:  # noqa: D102
        if not isinstance(value, bool):
            raise self.refuse(key, value)
        return value

    def meant(self, value: object) -> str:  # noqa: D102
        word = str(value).lower() if isinstance(value, (str, int)) else ""
        truth = {"true": "true", "yes": "true", "on": "true", "1": "true"} | {
            "false": "false", "no": "false", "off": "false", "0": "false",
        }  # fmt: skip
        return f"; write {truth[word]}" if word in truth else ""


@dataclass(frozen=True)
class Choice(Kind):
    """One of a few values, of the very type listed."""

    values: tuple[str | int, ...]

    @property
    def allowed(self) -> str:  # noqa: D102
        return " or ".join(f'"{value}"' if isinstance(value, str) else str(value) for value in self.values)

    def accept(self, key: str, value: Any) -> str | int:  # noqa: D102
        for choice in self.values:
            if type(value) is type(choice) and value == choice:  # True == 1 and 1.0 == 1
                return choice
        raise self.refuse(key, value)

    def meant(self, value: object) -> str:  # noqa: D102
        words = [choice for choice in self.values if isinstance(choice, str)]
        return did_you_mean(nearest(value, words)) if isinstance(value, str) else ""


@dataclass(frozen=True)
class Name(Kind):
    """A short name that can also be that of a folder."""

    @property
    def allowed(self) -> str:  # noqa: D102
        return "1 to 64 letters, digits, spaces or _ . + -, a letter or a digit first"

    def accept(self, key: str, value: Any) -> str:  # noqa: D102
        if not isinstance(value, str) or not re.fullmatch(r"[^\W_](?:[\w .+-]{0,62}[\w+-])?", value):
            raise self.refuse(key, value)
        return value


@dataclass(frozen=True)
class Section(Kind):
    """A group of entries: a dataclass whose fields are annotated with their kinds, or are sections themselves."""

    of: type[Any]

    @property
    def allowed(self) -> str:  # noqa: D102
        return "a section with the keys " + ", ".join(entry.name for entry in entries(self.of))

    def accept(self, key: str, value: Any) -> Any:  # noqa: D102
        if isinstance(value, self.of):
            value = {entry.name: getattr(value, entry.name) for entry in entries(self.of)}
        if not isinstance(value, Mapping):
            raise self.refuse(key, value)
        known = {entry.name: entry for entry in entries(self.of)}
        prefix = f"{key}." if key else ""
        for name in value:
            if name not in known:
                raise InputError(prefix + shown_key(str(name)), value[name], _unknown(str(name), list(known)))
        for name, (_, kind, required, _) in known.items():
            if required and name not in value:
                raise InputError(prefix + name, NO_VALUE, f"is missing; must be {kind.allowed} ({kind.about})")
        return self.of(**{name: known[name].kind.accept(prefix + name, value[name]) for name in value})

    def plain(self, value: Any) -> dict[str, Any]:  # noqa: D102
        return {name: kind.plain(getattr(value, name)) for name, kind, _, _ in entries(self.of)}


class Entry(NamedTuple):
    """One field of a section; ``default`` is MISSING where it is required or a section."""

    name: str
    kind: Kind
    required: bool
    default: Any


def entries(of: type[Any]) -> tuple[Entry, ...]:
    """Return the entries of a section in the order they are declared."""
    return _entries(cast(Hashable, of))


@cache
def _entries(of: Any) -> tuple[Entry, ...]:
    hints = get_type_hints(of, include_extras=True)
    result = []
    for f in dataclasses.fields(of):
        hint = hints[f.name]
        marks = [mark for mark in getattr(hint, "__metadata__", ()) if isinstance(mark, Kind)]
        required = f.default is MISSING and f.default_factory is MISSING
        result.append(Entry(f.name, marks[0] if marks else section(hint), required, f.default))
    return tuple(result)


def section(of: type[Any]) -> Section:
    """Return the kind of a section; its docstring's first line says what it is."""
    return Section((of.__doc__ or "").partition("\n")[0].rstrip("."), of)


def describe(of: type[Any], prefix: str = "") -> Iterator[tuple[str, str]]:
    """Yield the dotted key of every leaf below a section and what it holds: meaning, range and default."""
    for name, kind, _, default in entries(of):
        if isinstance(kind, Section):
            yield from describe(kind.of, f"{prefix}{name}.")
        else:
            shown = "" if default is MISSING else f"; default {kind.plain(default)}"
            yield prefix + name, f"{kind.about}: {kind.allowed}{shown}"


def shown_key(key: str) -> str:
    """Return a dotted key as a message shows it: an odd one in quotes, a long one cut."""
    return key if re.fullmatch(r"[A-Za-z0-9_-]{1,60}(\.[A-Za-z0-9_-]{1,60})*", key) else f"{key[:60]!r}"


def _unknown(name: str, known: list[str]) -> str:
    return "unknown key" + (did_you_mean(nearest(name, known)) or "; known here: " + ", ".join(known))
