"""The tuning script changes one constant for every module that has it, and sums up by hand-made answers."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

SCRIPTS = Path(__file__).parents[2] / "scripts"


@pytest.fixture
def script(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(SCRIPTS))
    spec = importlib.util.spec_from_file_location("tune_search", SCRIPTS / "tune_search.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "tune_search", module)
    spec.loader.exec_module(module)
    return module


def test_a_constant_changes_in_every_module_that_has_it_and_comes_back(script: ModuleType) -> None:
    from liftopt.search import mesh_refinement, optima

    before = optima.PROMISING
    with script.changed("optima.PROMISING", 2.5):
        assert mesh_refinement.PROMISING == optima.PROMISING == 2.5
    assert mesh_refinement.PROMISING == optima.PROMISING == before


def test_a_constant_that_does_not_exist_is_refused(script: ModuleType) -> None:
    with pytest.raises(SystemExit, match=r"liftopt\.collocation\.solvers\.banded has no constant HASTE"):
        script.module_of("collocation.solvers.banded.HASTE")


def test_objectives_compare_where_all_values_solve_on_one_mesh(script: ModuleType) -> None:
    """By hand: of four lifts one is unsolved and one on two meshes; 1.00 and 1.21 have the mean 1.1."""
    answer = script.Answer
    one = [answer(10.0, 20, 5, 1.0), answer(12.1, 20, 5, 1.0), answer(np.nan, 20, 5, 1.0), answer(1.0, 20, 5, 1.0)]
    two = [answer(10.0, 20, 7, 1.0), answer(10.0, 20, 7, 1.0), answer(3.0, 20, 7, 1.0), answer(9.0, 40, 7, 1.0)]
    lines = script.table("x", {"1": one, "2": two}).splitlines()
    assert lines[2] == "| 1 | 3 of 4 | 10.00 % | 1, 1 of 2 | 20 | 4.0 |"
    assert lines[3] == "| 2 | 4 of 4 | 0.00 % | 2, 2 of 2 | 28 | 4.0 |"
