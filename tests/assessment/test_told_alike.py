"""One verdict everywhere: what Python has is what solution.nc, ``--json``, the terminal and the report tell."""

from __future__ import annotations

import json
from html import unescape
from pathlib import Path
from typing import Any

import h5netcdf
import h5py
import pytest

from liftopt.commands.cli import main
from liftopt.ergonomics.measures import ergonomics_of
from liftopt.errors import InputError
from liftopt.solution.interpolation import between_knots
from liftopt.solution.summary import summary_dict
from liftopt.storage.reader import load_result
from liftopt.storage.writer import save
from liftopt.viz.report import report_html

pytestmark = pytest.mark.long
CONTRACT = {"code", "severity", "agent", "joint", "time", "value", "limit", "source", "message"}


def test_the_attribute_is_the_list(heavy: Any) -> None:
    with h5netcdf.File(heavy.folder / "solution.nc", "r") as file:
        told = json.loads(file.attrs["assessment"], parse_constant=pytest.fail)
    assert told == heavy.solution.assessment.plain() == summary_dict(heavy.solution)["assessment"]
    assert all(set(finding) >= CONTRACT for finding in told)
    assert load_result(heavy.folder).assessment == heavy.solution.assessment


@pytest.mark.parametrize("name", ["table5", "table5_paper"])
def test_terminal_json_and_report_of_one_solve(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], undrawn: None
) -> None:
    """Of the default lift, and of one that leads to a warning."""
    out = str(tmp_path / "r")
    arguments = ["solve", name, "--out", out, "--set", "solver.intervals=10", "--set", "solver.starts=1"]
    assert main(arguments) == 0
    terminal = " ".join(capsys.readouterr().out.split())
    assert main([*arguments, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    solution = load_result(out)
    page = unescape(report_html(solution))
    assert told["assessment"] == solution.assessment.plain()
    assert terminal.startswith(f"{name}: ")
    warnings = [finding for finding in told["assessment"] if finding["severity"] == "warning"]
    assert name == "table5" or (warnings and terminal.startswith("table5_paper: WARNING for "))
    for finding in told["assessment"]:
        assert finding["message"] in page
        if finding["severity"] == "warning" and "." in finding["code"] and not finding["code"].startswith("verdict"):
            assert finding["title"] in terminal or finding["message"] in terminal


def test_peaks_are_the_same_numbers_everywhere(heavy: Any) -> None:
    solution = heavy.solution
    dense = between_knots(solution)
    fine = ergonomics_of(dense, dense["human"])
    rows = {row["joint"]: row for row in summary_dict(solution)["joints"]["human"]}
    for use in fine.strength:
        assert rows[use.joint]["largest_share_of_limit"] == pytest.approx(use.peak, rel=1e-12)
    strength = [finding for finding in solution.assessment if finding.code == "person.strength"]
    for finding in strength:
        row = rows[finding.joint.removeprefix("human_")]
        assert finding.value / finding.limit == pytest.approx(row["largest_share_of_limit"], rel=1e-12)
        assert finding.time == pytest.approx(row["largest_share_at_s"])


def _respelled(folder: Path, change: Any) -> None:
    with h5py.File(folder / "solution.nc", "r+") as file:
        told = json.loads(file.attrs["assessment"])
        file.attrs["assessment"] = change(told)


def test_a_result_from_before_there_was_an_assessment_is_judged_when_read(heavy: Any, tmp_path: Path) -> None:
    save(heavy.solution, tmp_path)
    with h5py.File(tmp_path / "solution.nc", "r+") as file:
        del file.attrs["assessment"]
    assert load_result(tmp_path).assessment == heavy.solution.assessment


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda told: "no json", "JSONDecodeError"),
        (lambda told: json.dumps(told[3:]), "KeyError"),
        (lambda told: json.dumps([*told, {**told[0], "severity": "fatal"}]), "severity is 'fatal'"),
        (lambda told: json.dumps([*told, {**told[0], "value": "much"}]), "Finding.value is 'much'"),
        (lambda told: json.dumps([*told, {**told[0], "limit": float("inf")}]), "limit of"),
        (lambda told: json.dumps([*told, {**told[0], "more": 1}]), "TypeError"),
        (lambda told: json.dumps({}), "is {}"),
    ],
    ids=["no JSON", "no verdicts", "severity", "text for a number", "infinite", "unknown entry", "no list"],
)
def test_a_damaged_assessment_is_one_input_error(heavy: Any, tmp_path: Path, change: Any, words: str) -> None:
    save(heavy.solution, tmp_path)
    _respelled(tmp_path, change)
    with pytest.raises(InputError, match="is no whole result of liftopt") as caught:
        load_result(tmp_path)
    assert words in str(caught.value)
