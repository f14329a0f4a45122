"""The public face: what it gives does what the rooms behind it do, which are the oracle."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import xarray as xr

from liftopt.errors import InputError
from liftopt.face import lift as face

CHEAP = ("solver.intervals=10", "solver.starts=1")


@pytest.fixture
def loaded(solved: Callable[..., Any]) -> face.Solution:
    """The solution of a result folder."""
    return face.load(solved("table5", *CHEAP).folder)


def test_what_is_solved_is_saved_loaded_and_shown(
    solved: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = solved("table5", *CHEAP).solution
    monkeypatch.setattr("liftopt.search.solve.solve", lambda scenario, progress=None: found)
    solution = face.solve(found.scenario)
    assert isinstance(solution, face.Solution)
    assert solution["robot"].tau.shape == (len(solution.time), 10)
    folder = solution.save(str(tmp_path / "mine"))
    again = face.load(str(folder))
    assert again.objective == solution.objective
    again.report(str(tmp_path / "lift.html"))
    assert "</html>" in (tmp_path / "lift.html").read_text(encoding="utf-8")
    file = xr.load_dataset(folder / "solution.nc", engine="h5netcdf")
    xr.testing.assert_identical(solution.to_xarray(), file)


def test_a_changed_solution_keeps_its_methods(loaded: face.Solution, tmp_path: Path) -> None:
    other = replace(loaded, notes=("changed",))
    assert face.load(other.save(tmp_path)).notes == ("changed",)


def test_an_unknown_agent_is_told_with_who_was_meant(loaded: face.Solution) -> None:
    with pytest.raises(InputError, match="must be one of human, robot; did you mean robot"):
        loaded["robto"]
