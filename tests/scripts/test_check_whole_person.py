"""The campaign draws scenarios that are valid, varied and the same each time, and judges them by hand-made answers."""

from __future__ import annotations

import importlib.util
import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

SCRIPTS = Path(__file__).parents[2] / "scripts"


@pytest.fixture
def script(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(SCRIPTS))
    spec = importlib.util.spec_from_file_location("check_whole_person", SCRIPTS / "check_whole_person.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "check_whole_person", module)
    spec.loader.exec_module(module)
    return module


def test_the_sample_covers_what_it_says(script: ModuleType) -> None:
    drawn = [scenario for _, scenario in script.scenarios(60, 17)]
    people = [scenario.agents["human"] for scenario in drawn]
    assert all(person.body == "whole" for person in people)
    assert {person.hands for person in people} == {("right", "left"), ("right",), ("left",)}
    assert {person.sex for person in people} == {"female", "male"}
    assert {"robot" in scenario.agents for scenario in drawn} == {True, False}
    ends = np.array([[scenario.task.start.height, scenario.task.end.height] for scenario in drawn])
    assert (ends[:, 0] < ends[:, 1]).any() and (ends[:, 0] > ends[:, 1]).any()
    assert ends.min() >= 0.05 and ends.max() <= 1.9
    masses = [scenario.object.mass for scenario in drawn]
    assert min(masses) >= 1.0 and max(masses) <= 20.0
    assert drawn == [scenario for _, scenario in script.scenarios(60, 17)]


def test_what_is_neither_solved_nor_explained_fails(script: ModuleType) -> None:
    solved = script.Row("a lift", True, -5e-4, 100.0, 3.0, "")
    explained = script.Row("another", False, 0.0, np.nan, 5.0, "the right knee lacks 20 Nm torque")
    assert solved.passed and explained.passed
    assert not replace(solved, depth=-2e-3).passed
    assert not replace(explained, reason="").passed
    assert not replace(explained, doubted=True).passed
    told = script.summary([solved, explained])
    assert "2 lifts: 1 solved, deepest -0.50 mm; 1 not (torque 1); 0 fail" in told
    assert "median 4.0 s" in told
