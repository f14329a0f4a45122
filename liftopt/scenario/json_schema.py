"""The JSON Schema of scenario files, with which editors complete keys, show what they mean and mark what is wrong."""

from __future__ import annotations

from typing import Any

from liftopt.scenario.agent_fields import NAME
from liftopt.scenario.agents import KINDS
from liftopt.scenario.model import REQUIRED, SCHEMA, Scenario
from liftopt.scenario.presets import OBJECTIVE, defaults_at

DIALECT = "https://json-schema.org/draft/2020-12/schema"
FILE_NAME = "scenario.schema.json"


def scenario_json_schema() -> dict[str, Any]:
    """Return the schema of a scenario file of schema 2."""
    made: dict[str, Any] = _as_in_files(Scenario.model_json_schema())
    made["$schema"] = DIALECT
    made["title"] = f"liftopt scenario, schema {SCHEMA}"
    version = {"const": SCHEMA, "description": "version of the scenario format"}
    made["properties"] = {"schema": version, **made["properties"]}
    made["properties"]["agents"]["propertyNames"] = {"pattern": f"^{NAME.pattern}$"}
    made["required"] = list(REQUIRED)
    for section, of in (("Objective", OBJECTIVE), *((kind.__name__, name) for name, kind in KINDS.items())):
        for key, field in made["$defs"][section]["properties"].items():
            if by_preset := defaults_at(f"{of}.{key}"):
                field.pop("default")
                told = ", ".join(f"{value} with preset {preset}" for preset, value in by_preset.items())
                field["description"] += f"; by default {told}"
    return made


def _as_in_files(node: Any) -> Any:
    """Return a part of pydantic's schema as files have it: no null, but the word that stands for it."""
    if isinstance(node, list):
        return [_as_in_files(inner) for inner in node]
    if not isinstance(node, dict):
        return node
    # A default of None stands for the word too, and what is left out is the default.
    kept = {key: inner for key, inner in node.items() if key not in ("word", "allowed", "title") and inner is not None}
    found = {key: _as_in_files(inner) for key, inner in kept.items()}
    if isinstance(found.get("description"), str):  # of a docstring the first paragraph
        found["description"] = found["description"].partition("\n\n")[0].replace("\n", " ")
        if not found["description"]:
            found.pop("description")
    if "anyOf" in found:
        kinds = [kind for kind in found["anyOf"] if kind != {"type": "null"}]
        if "word" in node:
            kinds.append({"const": node["word"]})
        found.pop("anyOf")
        found |= kinds[0] if len(kinds) == 1 else {"anyOf": kinds}
    return found
