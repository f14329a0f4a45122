"""Scenario files of schema 1: one ``[human]``, one ``[robot]`` and a ``[table]``; they mean what they meant."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

AGENTS = {"human": "person", "robot": "robot"}


def as_schema_2(tables: Mapping[str, Any]) -> dict[str, Any]:
    """Return the tables of schema 2 that say the same; what is wrong stays wrong, and is told where it is checked."""
    result = {key: value for key, value in tables.items() if key not in (*AGENTS, "table")} | {"schema": 2}
    objective = result.get("objective")
    weights = dict(objective) if isinstance(objective, Mapping) else {}
    agents: dict[str, Any] = {}
    for name, kind in AGENTS.items():
        given = tables.get(name, {})
        agents[name] = {**given, "kind": kind} if isinstance(given, Mapping) else given
        if isinstance(agents[name], dict) and f"{name}_weight" in weights:
            agents[name]["weight"] = weights.pop(f"{name}_weight")
    result["agents"] = agents
    if "table" in tables:
        result["object"] = tables["table"]
    if isinstance(objective, Mapping):
        result["objective"] = weights
    # What files meant before there was a choice.
    meant = {"task": {"rest": "acceleration"}, "objective": {"preset": "paper"}, "limits": {"clearance": "off"}}
    for section, entries in meant.items():
        given = result.get(section, None if section == "task" else {})
        if isinstance(given, Mapping):
            result[section] = {**entries, **given}
    return result
