"""What the presets of the objective say where a scenario does not: weights, and how hands hold."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from typing import Any, Literal

from liftopt.files.section import Section

Preset = Literal["natural", "paper"]
DEFAULT: Preset = "natural"
OBJECTIVE, PRESET, AGENTS = "objective", "preset", "agents"
# By preset: what is left out of the objective, of a person and of a robot. The paper's are eq. 10 with both weights 1
# and a little of the others. The natural ones keep the objective on the paper's scale: 1600 squared shares of a
# strength of 40 Nm are its square [Nm].
DEFAULTS: dict[str, dict[str, dict[str, Any]]] = {
    "natural": {
        OBJECTIVE: {"acceleration_weight": 12.0, "force_weight": 0.1, "range_weight": 250.0, "tilt_weight": 50.0},
        "person": {"weight": 1600.0, "grasp": "wrench", "grasp_turn_deg": 60.0},
        "robot": {"weight": 16.0, "grasp": "wrench"},
    },
    "paper": {
        OBJECTIVE: {"acceleration_weight": 0.5, "force_weight": 0.01, "range_weight": 0.0, "tilt_weight": 0.0},
        "person": {"weight": 1.0, "grasp": "point", "grasp_turn_deg": 30.0},
        "robot": {"weight": 1.0, "grasp": "point"},
    },
}
NATURAL = DEFAULTS[DEFAULT]


def preset_of(tables: Mapping[str, Any]) -> str:
    """Return the preset that the tables of a scenario name, right or wrong; the default where they name none."""
    return str(_entries(tables.get(OBJECTIVE)).get(PRESET, DEFAULT))


def with_defaults(tables: Mapping[str, Any]) -> dict[str, Any]:
    """Return the tables of a scenario with what its agents leave out as its preset has it; wrong ones stay wrong."""
    preset, agents = DEFAULTS.get(preset_of(tables)), tables.get(AGENTS)
    if preset is None or not isinstance(agents, Mapping):
        return dict(tables)
    return {**tables, AGENTS: {name: _filled(agent, preset) for name, agent in agents.items()}}


def objective_with_defaults(objective: object) -> object:
    """Return an objective's entries with what they leave out as their preset has it; wrong ones stay wrong."""
    preset = DEFAULTS.get(preset_of({OBJECTIVE: objective}))
    return {**preset[OBJECTIVE], **objective} if preset and isinstance(objective, Mapping) else objective


def without_preset(tables: Mapping[str, Any]) -> dict[str, Any]:
    """Return a copy of a scenario's tables without what its presets say."""
    copy = deepcopy(dict(tables))
    sections = [(OBJECTIVE, copy.get(OBJECTIVE))]
    if isinstance(agents := copy.get(AGENTS), dict):
        sections += [(str(_entries(agent).get("kind")), agent) for agent in agents.values()]
    for name, section in sections:
        if isinstance(section, dict):
            for key in NATURAL.get(name, ()):
                section.pop(key, None)
    return copy


def defaults_at(key: str) -> dict[str, Any]:
    """Return the default of a key, ``"person.weight"`` or ``"objective.force_weight"``, by preset; empty for others."""
    section, _, entry = key.rpartition(".")
    return {preset: of[section][entry] for preset, of in DEFAULTS.items() if entry in of.get(section, {})}


def _filled(agent: object, preset: Mapping[str, Mapping[str, Any]]) -> object:
    given = _entries(agent)
    more = {key: value for key, value in preset.get(str(given.get("kind")), {}).items() if key not in given}
    if isinstance(agent, Section):
        return agent.changed(**more) if more else agent
    return {**agent, **more} if isinstance(agent, Mapping) else agent


def _entries(section: object) -> Mapping[str, Any]:
    """Return what a section or its tables say; its preset and kind, which have one default, always."""
    if isinstance(section, Section):
        given = {*section.model_fields_set, "kind", PRESET}
        return {name: getattr(section, name) for name in type(section).model_fields if name in given}
    return section if isinstance(section, Mapping) else {}
