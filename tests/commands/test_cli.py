"""The command line: oracle is the contract's exit statuses and streams; the solver is a stand-in."""

from __future__ import annotations

import errno
import json
import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

from liftopt.commands.cli import main
from liftopt.errors import InputError, SolverError
from liftopt.scenario.model import Scenario, load_scenario
from liftopt.solution.finding import Assessment, Finding

SCRIPT = Path(__file__).parents[2] / "scripts" / "solve.py"


class FakeLift(ModuleType):
    """Stands for liftopt.search.solve and the writer: writes what it must, and records what it was asked."""

    def __init__(self, solution: SimpleNamespace) -> None:
        super().__init__("liftopt.search.solve")
        self.solution, self.raises = solution, None
        self.asked: list[Scenario] = []
        self.saved: list[Path] = []
        self.aside = ""  # folder within the one asked for that an iterate goes to

    def solve(self, scenario: Scenario, *, progress: Any) -> SimpleNamespace:  # noqa: D102
        assert callable(progress)
        self.asked.append(scenario)
        if self.raises is not None:
            raise self.raises
        return self.solution

    def save(self, solution: SimpleNamespace, out: Path) -> Path:  # noqa: D102
        assert solution is self.solution
        self.saved.append(out)
        (out / self.aside).mkdir(exist_ok=True)
        (out / self.aside / "solution.nc").write_text("new")
        return out / self.aside


@pytest.fixture
def lift(solution: SimpleNamespace, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> FakeLift:
    fake = FakeLift(solution)
    monkeypatch.setitem(sys.modules, "liftopt.search.solve", fake)
    monkeypatch.setattr("liftopt.storage.writer.save", fake.save)
    monkeypatch.setattr("liftopt.solution.summary.between_knots", lambda solution: solution)
    monkeypatch.chdir(tmp_path)
    return fake


def test_solve_without_arguments_solves_table5_into_results(lift: FakeLift, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["solve"]) == 0
    assert (lift.asked, lift.saved) == ([load_scenario("table5")], [Path("results/table5")])
    assert Path("results/table5/solution.nc").exists()
    out, err = capsys.readouterr()
    assert out.startswith("table5: WARNING for the person\n")
    assert "Solve: solved and verified" in out
    assert "joint torques" not in out
    assert err == ""


def test_json_is_one_object_and_nothing_else(lift: FakeLift, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["solve", "table5_near", "--json", "--out", "deep/er", "--set", "object.mass=3", "--set", "name=heavy"]
    assert main(arguments) == 0
    scenario, out = lift.asked[0], lift.saved[0]
    assert (scenario.name, scenario.object.mass, scenario.task.standing_distance) == ("heavy", 3.0, 1.7)
    assert out == Path("deep/er")
    summary = json.loads(capsys.readouterr().out)
    assert (summary["solved"], summary["exit_status"], summary["out"]) == (True, 0, "deep/er")
    assert summary["assessment"] == lift.solution.assessment.plain()
    assert "deep/er/solution.nc" in summary["files"]


def test_details_add_findings_and_tables(lift: FakeLift, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["solve"]) == 0
    short = capsys.readouterr().out
    assert main(["solve", "--details"]) == 0
    out = capsys.readouterr().out
    assert out.startswith(short)
    for title in ("All findings", "Human joint torques", "Starts", "Verification: all passed"):
        assert title in out


def _error_line(capsys: pytest.CaptureFixture[str]) -> str:
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("liftopt: error: ")
    assert err.count("\n") == 1
    return err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--set", "object.mass=-1.0"], "object.mass = -1.0: must be a number from 0.05 to 50 kg"),
        (["--set", "human.stature=nan"], "human.stature = nan: must be"),
        (["--set", "robot.model=hal"], "robot.model = 'hal': must be"),
        (["nosuch.toml"], "nosuch.toml: no such file"),
        (["two\nlines.toml"], "two lines.toml: no such file"),
        (["."], ".: is not a file, nor a result folder with a solution.nc"),
        (["--out", "a_file"], "--out = 'a_file': cannot be written: Not a directory"),
        (["--out", "a_file/below"], "--out = 'a_file/below': cannot be written: Not a directory"),
        (["--out", "x" * 300], "cannot be written: File name too long"),
        (["--out", "taken"], "--out = 'taken': cannot be written: taken/solution.nc is in the way"),
        (["--out", "taken_too"], "--out = 'taken_too': cannot be written: taken_too/models is in the way"),
        (["--out", "/proc/liftopt"], "--out = '/proc/liftopt': cannot be written: "),
    ],
)
def test_bad_input_is_one_line_and_exit_2_before_any_solve(
    lift: FakeLift, capsys: pytest.CaptureFixture[str], arguments: list[str], message: str
) -> None:
    Path("a_file").write_text("precious")
    Path("taken/solution.nc").mkdir(parents=True)
    Path("taken_too").mkdir()
    Path("taken_too/models").write_text("")
    before = sorted(Path().rglob("*"))
    assert main(["solve", *arguments]) == 2
    assert message in _error_line(capsys)
    assert lift.asked == []
    assert sorted(Path().rglob("*")) == before


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_read_only_folder_is_bad_input(lift: FakeLift, capsys: pytest.CaptureFixture[str]) -> None:
    Path("locked").mkdir(mode=0o500)
    assert main(["solve", "--out", "locked"]) == 2
    assert "cannot be written: Permission denied" in _error_line(capsys)


@pytest.mark.parametrize(
    ("error", "status", "message"),
    [
        (InputError("object.mass", 50.0, "must be less"), 2, "object.mass = 50.0: must be less"),
        (OSError(errno.ENOSPC, "No space left on device"), 2, "No space left on device"),
        (SolverError("IPOPT cannot be loaded"), 3, "IPOPT cannot be loaded"),
        (KeyboardInterrupt(), 130, "interrupted"),
    ],
)
def test_a_solve_that_ends_without_result_leaves_none_and_keeps_an_older_one(
    lift: FakeLift, capsys: pytest.CaptureFixture[str], error: BaseException, status: int, message: str
) -> None:
    lift.raises = error  # type: ignore[assignment]
    assert main(["solve"]) == status
    assert message in _error_line(capsys)
    assert list(Path().iterdir()) == []

    older = Path("results/table5/solution.nc")
    older.parent.mkdir(parents=True)
    older.write_text("old")
    assert main(["solve"]) == status
    assert older.read_text() == "old"


def test_failure_as_json_names_its_kind(lift: FakeLift, capsys: pytest.CaptureFixture[str]) -> None:
    lift.raises = SolverError("no such library")  # type: ignore[assignment]
    assert main(["solve", "--json"]) == 3
    assert json.loads(capsys.readouterr().out) == {
        "status": "SolverError",
        "solved": False,
        "exit_status": 3,
        "error": {"message": "no such library"},
    }
    assert main(["solve", "--json", "--set", "object.mass=nan"]) == 2
    assert json.loads(capsys.readouterr().out)["error"]["key"] == "object.mass"


@pytest.mark.parametrize("aside", ["", "unsolved"])
def test_unsolved_is_exit_3_with_the_reason_and_where_the_iterate_is_and_no_tables(
    lift: FakeLift, capsys: pytest.CaptureFixture[str], aside: str
) -> None:
    lift.solution.solved, lift.solution.status, lift.aside = False, "not converged: time limit", aside
    assert main(["solve"]) == 3
    out, err = capsys.readouterr()
    assert out == ""
    first, last = err.splitlines()
    assert first == "liftopt: error: no verified solution: not converged: time limit"
    where = "results/table5/unsolved; the solved result" if aside else "results/table5, marked as such"
    assert f"is in {where}" in last
    assert (Path("results/table5") / aside / "solution.nc").exists()
    assert main(["solve", "--json"]) == 3
    summary = json.loads(capsys.readouterr().out)
    assert (summary["solved"], summary["out"]) == (False, str(Path("results/table5") / aside))
    assert main(["solve", "--details"]) == 3
    out = capsys.readouterr().out
    assert "Starts" in out
    assert "joint torques" not in out


def test_a_reader_that_has_seen_enough_is_no_error(lift: FakeLift, monkeypatch: pytest.MonkeyPatch) -> None:
    read, write = os.pipe()
    os.close(read)
    with os.fdopen(write, "w") as pipe:
        monkeypatch.setattr(sys, "stdout", pipe)
        assert main(["solve"]) == 0


def test_text_that_the_terminal_cannot_show_is_no_error(lift: FakeLift, monkeypatch: pytest.MonkeyPatch) -> None:
    lift.solution.assessment = Assessment.of(
        [*lift.solution.assessment, Finding("person.note", "caution", "précis", "A précis.")]
    )
    with Path("out.txt").open("w", encoding="ascii") as stdout:
        monkeypatch.setattr(sys, "stdout", stdout)
        assert main(["solve"]) == 0
    assert "pr?cis" in Path("out.txt").read_text(encoding="ascii")


def test_crosscheck_passes_its_verdict_on(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    asked: list[tuple[int, int]] = []

    def crosscheck_report(samples: int, seed: int) -> SimpleNamespace:
        asked.append((samples, seed))
        return SimpleNamespace(passed=samples > 3)

    fake = ModuleType("liftopt.crosscheck.report")
    vars(fake).update(crosscheck_report=crosscheck_report, render=lambda report: "the table")
    monkeypatch.setitem(sys.modules, "liftopt.crosscheck.report", fake)
    assert main(["crosscheck", "--samples", "7"]) == 0
    assert main(["crosscheck", "--samples", "3"]) == 3
    assert asked == [(7, 0), (3, 0)]
    assert capsys.readouterr().out == "the table\nthe table\n"


def test_version_and_help(capsys: pytest.CaptureFixture[str]) -> None:
    for arguments, text in [
        (["--version"], "liftopt "),
        (["--help"], "crosscheck"),
        (["solve", "--help"], "object.mass\n      mass of the object: a number from 0.05 to 50 kg"),
    ]:
        with pytest.raises(SystemExit) as caught:
            main(arguments)
        assert caught.value.code == 0
        assert text in capsys.readouterr().out


def test_script_is_the_same_command_and_answers_bad_input_without_loading_the_solver() -> None:
    command = [sys.executable, "-X", "importtime", str(SCRIPT), "--set", "object.mass=0"]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (run.returncode, run.stdout) == (2, "")
    timed = [line for line in run.stderr.splitlines() if line.startswith("import time:")]
    errors = [line for line in run.stderr.splitlines() if line not in timed]
    assert errors == ["liftopt: error: object.mass = 0: must be a number from 0.05 to 50 kg (mass of the object)"]
    imported = {line.rpartition("|")[2].strip() for line in timed}
    assert "liftopt.commands.cli" in imported
    assert imported.isdisjoint({"numpy", "casadi", "pinocchio", "rich", "liftopt.search.solve"})


def test_a_solve_imports_nothing_that_it_does_not_need() -> None:
    """Each of these would make every solve wait."""
    code = """
import sys
import liftopt.search.solve, liftopt.commands.solved_text, h5netcdf
from liftopt.scenario.model import load_scenario
from liftopt.scenario.build import agents_of, object_of
agents_of(load_scenario()), object_of(load_scenario())
heavy = {"matplotlib", "rich", "scipy.interpolate", "scipy.optimize", "trimesh", "yourdfpy"}
print(*heavy.intersection(sys.modules))
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.split() == []
