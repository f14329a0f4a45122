"""The README of the wheel of its own says what the module covers. The module's own list of names is the oracle."""

from __future__ import annotations

import re
from pathlib import Path

import pinocchio as pin

from liftopt.pinocchio_casadi import built

README = (Path(__file__).parents[2] / "liftopt/pinocchio_casadi/README.md").read_text(encoding="utf-8")
COVERED, NOT_COVERED = README.partition("## What it covers")[2].partition("\nNot covered:")[::2]


def named(text: str) -> set[str]:
    return set(re.findall(r"`(\w+)`", text)) - {"pinocchio"}


def test_it_names_what_the_module_has() -> None:
    enumerations = {name for name in built.__all__ if hasattr(pin, name) and not callable(getattr(built, name))}
    kinds = {"Convention", "FrameType", "ReferenceFrame"}
    sequences = {name for name in built.__all__ if name.startswith("StdVec_")} - {"StdVec_Force"}
    assert named(COVERED) == set(built.__all__) - enumerations - kinds - sequences


def test_it_names_nothing_missing_that_is_there() -> None:
    missing = named(NOT_COVERED.partition("\n## ")[0])
    assert {"aba", "integrate"} <= missing
    assert not [name for name in missing if hasattr(built, name)]


def test_its_example_takes_only_names_that_are_there() -> None:
    (example,) = re.findall(r"^```python\n(.*?)^```$", README, flags=re.MULTILINE | re.DOTALL)
    assert set(re.findall(r"cpin\.(\w+)", example)) <= set(built.__all__)
