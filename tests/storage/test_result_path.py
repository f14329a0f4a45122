"""Paths that stand for a result or a scenario, or were meant to: taken where it is clear, else told what was meant."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from liftopt.commands.cli import main
from liftopt.errors import InputError
from liftopt.scenario.model import load_scenario
from liftopt.storage.reader import load_result
from liftopt.storage.result_path import result_file
from liftopt.storage.solved_scenario import scenario_or_solved

CHEAP = ("solver.intervals=10", "solver.starts=1")


@pytest.fixture
def results(solved: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder to work in, with results/table5, a scenario of the user's and an empty folder."""
    monkeypatch.chdir(tmp_path)
    shutil.copytree(solved("table5", *CHEAP).folder, Path("results", "table5"))
    Path("lab.toml").write_text(load_scenario().to_toml(), encoding="utf-8")
    Path("empty").mkdir()
    return Path("results")


@pytest.mark.parametrize("name", ["", "solution.nc", "scenario.toml"])
def test_folder_netcdf_and_scenario_stand_for_the_result(results: Path, name: str) -> None:
    assert load_result(results / "table5" / name).scenario == load_scenario("table5", CHEAP)
    assert result_file(results / "table5" / name) == results / "table5" / "solution.nc"


@pytest.mark.parametrize("name", ["", "solution.nc", "scenario.toml"])
def test_a_result_stands_for_the_scenario_that_was_solved(results: Path, name: str) -> None:
    heavier = scenario_or_solved(str(results / "table5" / name), ["object.mass=3"])
    assert heavier == load_scenario("table5", [*CHEAP, "object.mass=3"])


RESULT_COMMANDS = (
    "view --html x",
    "report --html x",
    "plot --out x",
    "crosscheck",
    "export --out x",
    "dry-run --out x",
)


@pytest.mark.parametrize("command", [*RESULT_COMMANDS, "compare --robot x --out x", "view results/table5 --with"])
@pytest.mark.usefixtures("results")
def test_every_command_says_which_result_was_meant(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    before = sorted(Path().rglob("*"))
    assert main([*command.split(), "table5"]) == 2
    out, err = capsys.readouterr()
    assert "table5: is no result: there is no file solution.nc there; did you mean results/table5?" in err
    assert (out, err.count("\n")) == ("", 1)
    assert sorted(Path().rglob("*")) == before


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("results", "did you mean results/table5?"),
        ("results/tabel5", "did you mean results/table5?"),
        ("tabel5", "did you mean results/table5?"),
        ("table5.nc", "did you mean results/table5?"),
        ("results/table5/models/sawyer.urdf", "did you mean results/table5?"),
        ("results/table5/report.html", "did you mean results/table5?"),
        ("lab.toml", "it is a scenario: liftopt solve lab.toml makes a result of it"),
        ("table5_near", "it is a scenario: liftopt solve table5_near makes a result of it"),
        ("empty", "is no result: there is no file solution.nc there"),
        ("nowhere", "is no result: there is no file solution.nc there"),
    ],
)
@pytest.mark.usefixtures("results")
def test_what_is_no_result_is_told_with_what_was_meant(path: str, said: str) -> None:
    with pytest.raises(InputError) as caught:
        load_result(path)
    assert str(caught.value).startswith(f"{path}: is no result")
    assert str(caught.value).endswith(said)


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("tabel5", "did you mean table5?"),
        ("Table5", "did you mean table5?"),
        ("table5.toml", "did you mean table5?"),
        ("scenarios/table5_nera.toml", "did you mean table5_near?"),
        ("lab", "did you mean lab.toml?"),
        ("lab.tml", "did you mean lab.toml?"),
        ("results/tabel5", "did you mean results/table5 or table5?"),
        ("results", "nor a result folder with a solution.nc; did you mean results/table5?"),
        ("empty", "is not a file, nor a result folder with a solution.nc"),
        (
            "nowhere/x.toml",
            "no such file, nor a shipped scenario (floor_box, pallet, table5, table5_bare, table5_free, table5_near, "
            "table5_paper, two_people)",
        ),
    ],
)
@pytest.mark.usefixtures("results")
def test_what_is_no_scenario_is_told_with_what_was_meant(path: str, said: str) -> None:
    with pytest.raises(InputError) as caught:
        scenario_or_solved(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert str(caught.value).endswith(said)


def test_a_result_folder_is_no_command(results: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([str(results / "table5")]) == 2
    assert "did you mean liftopt view results/table5?" in capsys.readouterr().err
