"""The JSON schema for editors: oracle is the validator of jsonschema, on files that load and on some that do not."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from liftopt.files.toml_text import toml
from liftopt.scenario.file import SHIPPED
from liftopt.scenario.json_schema import FILE_NAME, scenario_json_schema
from liftopt.scenario.model import load_scenario

TEAMS = Path(__file__).with_name("teams")
FILES = sorted([*SHIPPED.glob("*.toml"), *TEAMS.glob("*.toml")])


@pytest.fixture(scope="module")
def validator() -> Any:
    jsonschema = pytest.importorskip("jsonschema")
    schema = json.loads((SHIPPED.parent / FILE_NAME).read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def test_the_published_file_is_that_of_the_models() -> None:
    """scripts/export_schema.py writes it."""
    assert json.loads((SHIPPED.parent / FILE_NAME).read_text(encoding="utf-8")) == scenario_json_schema()


@pytest.mark.parametrize("path", FILES, ids=[path.stem for path in FILES])
def test_files_that_load_are_valid_as_they_stand_and_with_all_defaults(path: Path, validator: Any) -> None:
    assert list(validator.iter_errors(toml(path.read_text(encoding="utf-8")))) == []
    assert list(validator.iter_errors(toml(load_scenario(path).to_toml()))) == []


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("schema", 1),
        ("duration", "2 s"),
        ("agents.human.stature", 3.0),
        ("agents.human.sex", "man"),
        ("agents.human.position", [1.0]),
        ("agents.human.kind", "dog"),
        ("agents.human.hands", ["middle"]),
        ("object.grasps", {"human": "top"}),
        ("agents.2nd", {"kind": "robot", "model": "sawyer"}),
        ("object.mas", 2.0),
        ("task.start.human_distance", "far"),
        ("limits.max_grasp_force", 0.0),
        ("solver.intervals", 20.5),
    ],
)
def test_an_editor_marks_what_is_wrong(key: str, value: object, validator: Any) -> None:
    tables = load_scenario().to_dict()
    *outer, last = key.split(".")
    inner = tables
    for part in outer:
        inner = inner[part]
    inner[last] = value
    assert list(validator.iter_errors(tables))


def test_every_entry_tells_what_it_is_and_in_which_unit() -> None:
    found = scenario_json_schema()
    stature = found["$defs"]["Person"]["properties"]["stature"]
    assert stature == {
        "description": "height of the person",
        "minimum": 1.2,
        "maximum": 2.2,
        "type": "number",
        "unit": "m",
    }
    for section in found["$defs"].values():
        for name, entry in section["properties"].items():
            assert "description" in entry or "$ref" in entry, name
