"""Dotted keys: ``human.stature``, ``object.mass``, ``task.end.height``; the one place where they are taken apart.

An agent is addressed by its name, ``human.stature`` for ``agents.human.stature``; ``table.*`` and the object's own name
stand for ``object.*``; an obstacle is addressed by its name, ``obstacles.shelf.position``.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from numbers import Integral, Real
from typing import Any

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.section import Section
from liftopt.files.toml_text import toml
from liftopt.scenario.obstacles import name_of

AGENTS, OBJECT, TABLE, OBSTACLES = "agents", "object", "table", "obstacles"
EXAMPLE = "object.mass=3"
SEVERAL = re.compile(r"^[^\[{\"'\n]*[,;\s]\s*[A-Za-z]\w*\.[\w.]*\w\s*=")  # a second key in what should be one value
Path = tuple[str, ...]
Changes = Mapping[str, Any] | Iterable[str]


def changes_in(changes: Changes) -> list[tuple[str, Any]]:
    """Return keys and values: of a mapping, or of texts ``KEY=VALUE`` as the command line has them.

    The value in a text is a TOML value; what is none is taken as a string.

    Raises:
        InputError: a text is malformed.
    """
    if isinstance(changes, Mapping):
        return [(key, _plain(value)) for key, value in changes.items()]
    return [_change(text) for text in changes]


def set_entry(tables: dict[str, Any], key: str, value: Any) -> None:
    """Change one entry of a scenario's tables.

    Args:
        tables: of schema 2; changed.
        key: dotted.
        value: as TOML has it.

    Raises:
        InputError: the key leads into a value.
    """
    path = path_of(key, tables.get(AGENTS), _name_of_object(tables))
    inside, outer = tables, path[:-1]
    if len(path) > 2 and path[0] == OBSTACLES:
        listed = tables.get(OBSTACLES)
        tables[OBSTACLES] = [dict(item) for item in listed] if isinstance(listed, list) else []
        inside, outer = _by_name(tables[OBSTACLES]), path[1:-1]
        if path[1] not in inside:
            raise InputError(shown(path), value, f"there is no obstacle {path[1]!r}; {_known(inside)}")
    for depth, part in enumerate(outer, start=len(path) - len(outer)):
        inner = inside.get(part, {})
        if not isinstance(inner, dict):
            raise InputError(shown(path), NO_VALUE, f"{shown(path[:depth])} is a value, not a section")
        inside[part] = inner
        inside = inner
    inside[path[-1]] = value


def path_of(key: str, agents: object, object_name: object = TABLE) -> Path:
    """Return the names that lead from a scenario to an entry.

    Args:
        key: dotted.
        agents: that the scenario has, by name; anything else than a mapping is none.
        object_name: what the scenario calls its object.
    """
    first, *rest = (part.strip() for part in key.split("."))
    if isinstance(agents, Mapping) and first in agents:
        return (AGENTS, first, *rest)
    if first == TABLE or (first == object_name and rest):
        return (OBJECT, *rest)
    return (first, *rest)


def value_at(scenario: Any, path: Sequence[str]) -> Any:
    """Return the value that names lead to in a scenario.

    Raises:
        InputError: they lead to none.
    """
    value = scenario
    for part in path:
        value = _by_name(value) if isinstance(value, tuple) and path[0] == OBSTACLES else value
        known = value if isinstance(value, Mapping) else getattr(type(value), "model_fields", {})
        if part not in known:
            raise InputError(shown(path), NO_VALUE, "is no entry of the scenario")
        value = value[part] if isinstance(value, Mapping) else getattr(value, part)
    return value


def leaves(tables: Mapping[str, Any], path: Path = ()) -> Iterator[tuple[str, Any]]:
    """Yield every value of a scenario's tables with its dotted key, an agent's by its name."""
    for name, value in tables.items():
        if isinstance(value, Mapping):
            yield from leaves(value, (*path, name))
        elif name == OBSTACLES:
            yield from leaves(_by_name(value), (*path, name))
        else:
            yield shown((*path, name)), value


def shown(path: Sequence[str]) -> str:
    """Return the dotted key of an entry, an agent's by its name."""
    return ".".join(path[1:] if len(path) > 1 and path[0] == AGENTS else path)


def refuse_contradictions(overrides: Iterable[str]) -> None:
    """Raise ``InputError`` where ``KEY=VALUE`` texts give one key two values."""
    known: dict[str, str] = {}
    for override in overrides:
        key, _, text = (part.strip() for part in override.partition("="))
        key = shown(path_of(key, None))
        if known.setdefault(key, text) != text:
            raise InputError("--set", NO_VALUE, f"{key} is given twice, as {known[key]} and as {text}; give it once")


def _by_name(obstacles: Sequence[Any]) -> dict[str, Any]:
    """Return the obstacles of a list by their names, given or by default."""
    return {name_of(obstacles, k): obstacle for k, obstacle in enumerate(obstacles)}


def _known(obstacles: Mapping[str, Any]) -> str:
    return f"there are {', '.join(obstacles)}" if obstacles else "the scenario has none"


def _change(text: str) -> tuple[str, Any]:
    key, equals, value = text.partition("=")
    if not equals or not all(part.strip() for part in key.split(".")):
        found = re.fullmatch(r"([\w.-]+)\s*[:\s]\s*(\S+)", text.strip())
        offer = f"write --set {found[1]}={found[2]}" if found and not equals else f"for example {EXAMPLE}"
        raise InputError("--set", text, f"must be KEY=VALUE with a dotted key; {offer}")
    if SEVERAL.search(value):
        raise InputError("--set", text, "holds several entries; give each its own --set")
    return key.strip(), _value(value.strip())


def _value(text: str) -> Any:
    try:
        parsed = toml(f"value = {text}")
    except (ValueError, RecursionError):
        return text
    return parsed["value"] if len(parsed) == 1 else text  # a line break could smuggle in a second key


def _plain(value: Any) -> Any:
    if isinstance(value, Section):
        return value.plain()
    if isinstance(value, bool) or not isinstance(value, Real):
        return value
    return int(value) if isinstance(value, Integral) else float(value)  # NumPy's too


def _name_of_object(tables: Mapping[str, Any]) -> object:
    inside = tables.get(OBJECT)
    return inside.get("name", TABLE) if isinstance(inside, Mapping) else TABLE
