"""Write liftopt/scenario/scenario.schema.json: the keys of a scenario for editors. Run it when a key has changed."""

from __future__ import annotations

import json
from pathlib import Path

from liftopt.scenario.json_schema import FILE_NAME, scenario_json_schema

TARGET = Path(__file__).resolve().parents[1] / "liftopt" / "scenario" / FILE_NAME


def text() -> str:
    """Return the file's text."""
    return json.dumps(scenario_json_schema(), indent=2) + "\n"


if __name__ == "__main__":
    TARGET.write_text(text(), encoding="utf-8")
