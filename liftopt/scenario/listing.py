"""Every key that a scenario has, with what it holds: for help, reports and offers in messages."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from liftopt.files.frozen_table import FrozenTable
from liftopt.files.section import about, allowed, sections_in
from liftopt.scenario.agents import KINDS
from liftopt.scenario.keys import AGENTS
from liftopt.scenario.presets import defaults_at

DEFAULT_TEAM = {"human": "person", "robot": "robot"}  # of the shipped scenarios


def fields_of(of: type[BaseModel], agents: Mapping[str, str], prefix: str = "") -> Iterator[tuple[str, FieldInfo]]:
    """Yield the dotted key and the field of every section and entry of a scenario or of a section of it.

    Args:
        of: the model.
        agents: kind by name; their entries stand under their names.
        prefix: of the keys, with its dot.
    """
    for name, field in of.model_fields.items():
        key = prefix + name
        if key == AGENTS:
            for agent, kind in agents.items():
                yield from fields_of(KINDS[kind], agents, f"{agent}.")
            continue
        yield key, field
        inner: dict[str, FieldInfo] = {}
        for section in sections_in(field):
            inner = dict(fields_of(section, agents, f"{key}.")) | inner
        yield from inner.items()


def describe(of: type[BaseModel], agents: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """Yield the dotted key of every entry and what it holds: meaning, range and default; arguments as ``fields_of``."""
    for key, field in fields_of(of, agents):
        if not sections_in(field):
            yield key, f"{about(field)}: {allowed(field)}{_default(key, field, agents)}"


def _default(key: str, field: FieldInfo, agents: Mapping[str, str]) -> str:
    """Return the end of a line that says what a field is by default: of what presets differ in, by each of them."""
    first, _, rest = key.partition(".")
    if by_preset := defaults_at(f"{agents.get(first, first)}.{rest}"):
        return "; default " + ", ".join(f"{value} ({preset})" for preset, value in by_preset.items())
    plain = not field.is_required() and field.default_factory is None and field.default not in (None, (), FrozenTable())
    return f"; default {field.default}" if plain else ""
