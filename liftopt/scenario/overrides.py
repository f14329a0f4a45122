"""Entries of a scenario changed by ``KEY=VALUE``, and keys that no scenario has."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Any

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.suggestions import did_you_mean, nearest_keys
from liftopt.files.toml_text import toml
from liftopt.scenario.schema import Section, describe, entries, shown_key

EXAMPLE = "table.mass=3"
SEVERAL = re.compile(r"^[^\[{\"'\n]*[,;\s]\s*[A-Za-z]\w*\.[\w.]*\w\s*=")  # a second key in what should be one value


def set_entry(data: dict[str, Any], override: str) -> None:
    """Change one entry of a scenario's tables.

    Args:
        data: changed.
        override: ``"dotted.key=value"``; the value is a TOML value, and what is none is taken as a string.

    Raises:
        InputError: it is no such text, or leads into a value.
    """
    key, equals, text = override.partition("=")
    parts = [part.strip() for part in key.split(".")]
    if not equals or not all(parts):
        found = re.fullmatch(r"([\w.-]+)\s*[:\s]\s*(\S+)", override.strip())
        offer = f"write --set {found[1]}={found[2]}" if found and not equals else f"for example {EXAMPLE}"
        raise InputError("--set", override, f"must be KEY=VALUE with a dotted key; {offer}")
    if SEVERAL.search(text):
        raise InputError("--set", override, "holds several entries; give each its own --set")
    for depth, part in enumerate(parts[:-1], start=1):
        inner = data.get(part, {})
        if not isinstance(inner, dict):
            raise InputError(".".join(parts), NO_VALUE, f"{'.'.join(parts[:depth])} is a value, not a section")
        data[part] = inner
        data = inner
    data[parts[-1]] = _value(text.strip())


def refuse_contradictions(overrides: Iterable[str]) -> None:
    """Raise ``InputError`` where ``KEY=VALUE`` texts give one key two values."""
    known: dict[str, str] = {}
    for override in overrides:
        key, _, text = (part.strip() for part in override.partition("="))
        if known.setdefault(key, text) != text:
            raise InputError("--set", NO_VALUE, f"{key} is given twice, as {known[key]} and as {text}; give it once")


def refuse_unknown_keys(data: Mapping[str, Any], of: type[Any]) -> None:
    """Raise ``InputError`` for the first key that a scenario does not have, with those that may have been meant.

    Args:
        data: the scenario's tables.
        of: the dataclass of a scenario.
    """
    for key, value, here in _unknown(data, of, ""):
        meant = nearest_keys(key, [*(leaf for leaf, _ in describe(of)), *_sections(of, "")])
        offer = did_you_mean(meant) or "; known here: " + ", ".join(here)
        raise InputError(shown_key(key), value, "unknown key" + offer)


def _unknown(data: Mapping[str, Any], of: type[Any], prefix: str) -> Iterable[tuple[str, Any, list[str]]]:
    """Yield key, value and the keys that are known beside it."""
    known = {entry.name: entry.kind for entry in entries(of)}
    for name, value in data.items():
        kind = known.get(name)
        if kind is None:
            # Of a section that is not known its first entry says more than all of it.
            inner = next(iter(value.items()), None) if isinstance(value, Mapping) else None
            yield (f"{prefix}{name}", value, list(known)) if inner is None else (
                f"{prefix}{name}.{inner[0]}", inner[1], list(known)
            )  # fmt: skip
        elif isinstance(kind, Section) and isinstance(value, Mapping):
            yield from _unknown(value, kind.of, f"{prefix}{name}.")


def _sections(of: type[Any], prefix: str) -> list[str]:
    found = []
    for name, kind, _, _ in entries(of):
        if isinstance(kind, Section):
            found += [prefix + name, *_sections(kind.of, f"{prefix}{name}.")]
    return found


def _value(text: str) -> Any:
    try:
        parsed = toml(f"value = {text}")
    except (ValueError, RecursionError):
        return text
    return parsed["value"] if len(parsed) == 1 else text  # a line break could smuggle in a second key
