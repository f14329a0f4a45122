"""The report on one result: which checks it holds, and how it shows them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

import liftopt.crosscheck.motion_report as report
from liftopt.commands.cli import main
from liftopt.crosscheck.motion_report import motion_report, render, result_report
from liftopt.crosscheck.transcriptions import MeshRow, MeshStudy
from liftopt.errors import InputError
from liftopt.solution.checks import Check

CHEAP = ("solver.intervals=10", "solver.starts=1")


@pytest.fixture(scope="module")
def result(solved: Callable[..., Any]) -> Any:
    pytest.importorskip("mujoco", minversion="3.7", reason="mujoco is in the extra 'crosscheck'")
    return solved("table5_paper", *CHEAP)


@pytest.mark.usefixtures("result")
@pytest.mark.parametrize("name", ["table5_paper", "table5"])
def test_a_solved_lift_passes_every_check(solved, name):
    """Of grasps at points, and of those that transmit moments."""
    stages: list[str] = []
    checks = motion_report(solved(name, *CHEAP).solution, stages.append)
    assert all(check.passed for check in checks), render(checks)
    assert len({check.name for check in checks}) == len(checks)
    assert len(stages) == 3
    assert render(checks).endswith("The solved motion holds.")


def test_an_iterate_that_is_no_solution_is_refused(result):
    unsolved = replace(result.solution, outcome="infeasible: the shelf is too high")
    with pytest.raises(InputError, match=r"RESULT.*too high.*must be a solved"):
        result_report(unsolved, transcription=False)


def test_both_tables_and_the_verdict_on_both_are_in_one_report(result, monkeypatch):
    rows = tuple(MeshRow(n, 1.0 + 1 / n, 1.0, 0.0, (0.0, 0.0), True) for n in (10, 20))
    for found, passed in ((rows, True), (rows[::-1], False)):
        monkeypatch.setattr(report, "mesh_study", lambda *_, found=found, **__: MeshStudy(found, 1.0, 2))
        monkeypatch.setattr(report, "motion_report", lambda *_: (Check("a", 0.0, 1.0, "m", ""),))
        text, verdict = result_report(result.solution, transcription=True)
        assert verdict is passed
        assert "The solved motion holds." in text
        assert "Hermite-Simpson" in text
        kept_apart = result.solution.scenario.limits.clearance is not None
        assert ("Both leave clearance out" in text) is kept_apart


def test_command_passes_the_verdict_on_a_folder_on(result, monkeypatch, capsys):
    for limit, status in ((1.0, 0), (0.1, 3)):
        check = Check("a", 0.5, limit, "m", "")
        monkeypatch.setattr(report, "motion_report", lambda *_, check=check: (check,))
        assert main(["crosscheck", str(result.folder)]) == status
        assert ("FAIL" in capsys.readouterr().out) == (status == 3)


def test_command_needs_a_result_for_the_second_transcription(capsys):
    assert main(["crosscheck", "--transcription"]) == 2
    assert "needs a RESULT" in capsys.readouterr().err


def test_table_marks_what_fails_and_what_has_no_bound():
    checks = (Check("a", 2.0, 1.0, "m", ""), Check("b", 3.0, float("inf"), "rad", "there"))
    bad, open_ended, verdict = render(checks).splitlines()[1:]
    assert "FAIL" in bad
    assert "FAIL" not in open_ended
    assert "ok" not in open_ended
    assert verdict == "Checks that FAILED: 1."
