"""The tables of checked robots in the documentation are such as the script writes them."""

from __future__ import annotations

import csv
import importlib.util
import sys
import tomllib
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("yourdfpy")

from liftopt.multibody.robots.catalogue import known_robots

ROOT = Path(__file__).parents[2]
TABLES = ROOT / "docs/tables"


def _rows(name: str) -> list[dict[str, str]]:
    with (TABLES / name).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module")
def columns() -> list[str]:
    spec = importlib.util.spec_from_file_location("check_robots", ROOT / "scripts/check_robots.py")
    assert spec is not None and spec.loader is not None
    module: Any = importlib.util.module_from_spec(spec)
    sys.modules["check_robots"] = module
    spec.loader.exec_module(module)
    return [entry.name for entry in fields(module.Row)]


def test_the_rows_are_those_of_robots_that_are_known(columns: list[str]) -> None:
    rows, known = _rows("checked_robots.csv"), known_robots()
    assert list(rows[0]) == columns
    assert all(known[row["name"]].maker == row["maker"] for row in rows)
    lifted = [row for row in (*rows, *_rows("checked_table1.csv")) if row["outcome"] == "solved"]
    assert len(lifted) >= 20 and len({row["maker"] for row in lifted}) >= 8


def test_those_of_the_paper_are_listed_with_what_they_are(columns: list[str]) -> None:
    rows = _rows("checked_table1.csv")
    listed = tomllib.loads((TABLES / "table1_robots.toml").read_text(encoding="utf-8"))["robot"]
    assert list(rows[0]) == columns
    assert [row["name"] for row in rows] == [robot["name"] for robot in listed]
    assert all(row["source"] == robot["source"] for row, robot in zip(rows, listed, strict=True))
