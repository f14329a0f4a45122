"""What is lifted, by whom, from where to where: a TOML file or mapping becomes a checked ``Scenario``.

SI units; radians unless the key says otherwise. The world frame has Z up and X from the human to the robot.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from copy import deepcopy
from pathlib import Path
from typing import Any

import tomli_w
from pydantic import ValidationError, model_validator

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.section import first_fault, refusal_at
from liftopt.scenario.checks import check
from liftopt.scenario.fields import ScenarioFields, safe_name
from liftopt.scenario.file import read_tables
from liftopt.scenario.hands import without_hands
from liftopt.scenario.keys import Changes, changes_in, leaves, path_of, set_entry, value_at
from liftopt.scenario.listing import describe
from liftopt.scenario.presets import preset_of, with_defaults, without_preset
from liftopt.scenario.refusals import refusal
from liftopt.scenario.robot_defaults import with_files, without_model
from liftopt.scenario.schema1 import as_schema_2

SCHEMA = 2
REQUIRED = ("schema", "duration", "agents", "object", "task")  # in a file
VERSION = "must be 2 (version of the scenario format)"


class Scenario(ScenarioFields):
    """One lift to be solved. An invalid one cannot be made: every value is checked on construction.

    Raises:
        InputError: a value has the wrong type or is out of its range, or two values contradict each other.
    """

    @model_validator(mode="before")
    @classmethod
    def _by_preset(cls, values: Any) -> Any:
        return with_defaults(values) if isinstance(values, Mapping) else values

    @model_validator(mode="after")
    def _agrees(self) -> Scenario:
        check(self)
        return self

    def describe(self) -> Iterator[tuple[str, str]]:
        """Yield every dotted key and what it holds: meaning, range and default."""
        yield "schema", f"version of the scenario format: must be {SCHEMA}"
        yield from describe(type(self), {name: agent.kind for name, agent in self.agents.items()})

    def value(self, key: str) -> Any:
        """Return the value at a dotted key; ``human.stature`` addresses an agent by its name.

        Raises:
            InputError: the scenario has no such key.
        """
        return value_at(self, path_of(key, self.agents, self.object.name))

    def entries(self) -> dict[str, Any]:
        """Return every value as a file has it by its dotted key, all defaults filled in."""
        return dict(leaves(self.to_dict()))

    def replace(self, changes: Mapping[str, Any]) -> Scenario:
        """Return the scenario with some entries changed; this one stays as it is.

        Another ``objective.preset`` brings its own weights and grasps, another ``body`` its hands; those among
        ``changes`` stand.

        Args:
            changes: value by dotted key, ``{"object.mass": 3.0, "human.stature": 1.6}``; an agent is addressed by its
                name, a value may be a section.

        Raises:
            InputError: a key is unknown, or the result is no scenario.
        """
        return scenario_from_dict(_changed(self.to_dict(), changes))

    def to_dict(self) -> dict[str, Any]:
        """Return the scenario as nested plain values as a file has them, all defaults filled in."""
        return {"schema": SCHEMA, **self.plain()}

    def to_toml(self) -> str:
        """Return the scenario as a TOML file, all defaults filled in; reading it gives an equal scenario."""
        return tomli_w.dumps(self.to_dict())

    @classmethod
    def refusal(cls, error: ValidationError, values: Any, prefix: str = "") -> InputError:
        """Return our error for pydantic's, with an agent's keys by its name."""
        return refusal(cls, first_fault(error), values)


def load_scenario(source: str | Path | None = None, changes: Changes = ()) -> Scenario:
    """Return the scenario of a TOML file.

    Args:
        source: path of the file, or the name of a shipped scenario (a str); None is ``"table5"``.
        changes: entries that differ: value by dotted key, as ``Scenario.replace`` takes them, or texts ``KEY=VALUE``
            as the command line has them; later ones win. Another ``objective.preset`` brings its own weights and
            grasps; those among the changes stand.

    Raises:
        InputError: the file cannot be read, is not TOML, or does not describe a scenario.
    """
    path, tables = read_tables("table5" if source is None else source)
    tables = _schema_2(tables)
    if "agents" in tables:
        tables["agents"] = with_files(tables["agents"], path.parent)
    with suppress(InputError):  # a file name need not be a name
        tables.setdefault("name", safe_name(path.stem))
    return _scenario(_changed(tables, changes))


def scenario_from_dict(tables: Mapping[str, Any]) -> Scenario:
    """Return the scenario that a mapping, laid out like the TOML file, describes.

    Raises:
        InputError: naming the key that is missing, unknown or wrong.
    """
    return _scenario(_schema_2(tables))


def _changed(tables: Mapping[str, Any], changes: Changes) -> dict[str, Any]:
    """Return the tables of a scenario with some entries changed; what another preset or body says is dropped."""
    wanted = changes_in(changes)
    changed = _with_entries(deepcopy(dict(tables)), wanted)
    kept = tables if preset_of(changed) == preset_of(tables) else without_preset(tables)
    return _with_entries(without_model(without_hands(kept, changed), changed), wanted)


def _with_entries(tables: dict[str, Any], entries: Iterable[tuple[str, Any]]) -> dict[str, Any]:
    for key, value in entries:
        set_entry(tables, key, deepcopy(value))
    return tables


def _schema_2(tables: Mapping[str, Any]) -> dict[str, Any]:
    version = tables.get("schema")
    if type(version) is int and version == 1:
        return as_schema_2(tables)
    if "schema" in tables and (type(version) is not int or version != SCHEMA):
        raise InputError("schema", version, "must be 2, or 1 in older files (version of the scenario format)")
    return dict(tables)


def _scenario(tables: Mapping[str, Any]) -> Scenario:
    if "schema" not in tables:
        raise InputError("schema", NO_VALUE, f"is missing; {VERSION}")
    if tables["schema"] != SCHEMA:  # by a change
        raise InputError("schema", tables["schema"], VERSION)
    if "duration" not in tables:  # in Python it has a default
        raise refusal_at(Scenario, ("duration",), "missing", None)
    return Scenario(**{key: value for key, value in tables.items() if key != "schema"})
