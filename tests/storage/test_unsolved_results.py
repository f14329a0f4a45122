"""A run that ends unsolved never replaces a solved result; oracle: the solved result's bytes."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from liftopt.assessment.assess import assessed
from liftopt.commands.cli import main
from liftopt.errors import InputError
from liftopt.solution.solution import Solution
from liftopt.storage.reader import load_result
from liftopt.storage.writer import save

pytestmark = pytest.mark.long
TOO_FAST = ("solve", "--set", "duration=0.2", "--set", "solver.intervals=10", "--set", "solver.tries=4")
# Writes one result on and on, until it is told to end.
WRITE_ON_AND_ON = """
import sys
from pathlib import Path
from liftopt.storage.reader import load_result
from liftopt.storage.writer import save
solution = load_result(sys.argv[1])
print(save(solution, Path(sys.argv[2])), flush=True)
while True:
    save(solution, Path(sys.argv[2]))
"""


@pytest.fixture(scope="module")
def iterate(kept: Any) -> Solution:
    """The same lift as a solve that failed would leave it."""
    return assessed(replace(kept.solution, outcome="not converged: time limit"))


@pytest.fixture
def folder(kept: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The default folder of a solved result; the process stands above it."""
    monkeypatch.chdir(tmp_path)
    shutil.copytree(kept.folder, tmp_path / "results" / "table5")
    return Path("results/table5")


def _files(folder: Path) -> dict[str, bytes]:
    """Return the result and what stands beside it, without what is in the folder for iterates."""
    files = [folder / "solution.nc", folder / "scenario.toml", *sorted((folder / "models").iterdir())]
    return {file.name: file.read_bytes() for file in files}


@pytest.mark.parametrize("arguments", [[], ["--refine"], ["--out", "results/table5"]], ids=" ".join)
def test_an_infeasible_solve_leaves_the_solved_result_and_says_where_its_iterate_is(
    folder: Path, arguments: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    before = _files(folder)
    assert main([*TOO_FAST, *arguments]) == 3
    out, err = capsys.readouterr()
    assert _files(folder) == before
    assert out == ""
    assert err.count("\n") <= 12
    assert "is in results/table5/unsolved; the solved result in results/table5 is as it was" in err
    assert load_result(folder).solved
    assert not load_result(folder / "unsolved").solved
    assert load_result(folder / "unsolved").scenario.duration == 0.2
    if arguments:  # the iterate is where it always is, and its pages are made once
        return
    for command in (["report", "--html", "r.html"], ["view", "--html", "v.html"]):
        assert main([command[0], str(folder / "unsolved"), *command[1:]]) == 0


def test_json_says_where_the_iterate_is(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*TOO_FAST, "--json"]) == 3
    summary = json.loads(capsys.readouterr().out)
    assert (summary["solved"], summary["out"]) == (False, "results/table5/unsolved")
    assert all(Path(name).is_file() for name in summary["files"])
    assert all(Path(name).is_relative_to(folder / "unsolved") for name in summary["files"])


def test_iterates_replace_each_other_and_a_solution_replaces_an_iterate(
    kept: Any, iterate: Solution, tmp_path: Path
) -> None:
    fresh = tmp_path / "fresh"
    later = assessed(replace(iterate, outcome="not converged: later"))
    for solution in (iterate, later, kept.solution):
        assert save(solution, fresh) == fresh
        assert load_result(fresh).status == solution.status
    for solution in (iterate, later):
        assert save(solution, fresh) == fresh / "unsolved"
        assert load_result(fresh / "unsolved").status == solution.status
    assert _files(fresh) == _files(kept.folder)


@pytest.mark.parametrize("content", [b"", b"\x89HDF\r\n\x1a\n" + 100 * b"x"], ids=["empty", "damaged"])
def test_a_file_that_may_be_worth_something_is_kept(content: bytes, iterate: Solution, tmp_path: Path) -> None:
    (tmp_path / "solution.nc").write_bytes(content)
    assert save(iterate, tmp_path) == tmp_path / "unsolved"
    assert (tmp_path / "solution.nc").read_bytes() == content


def test_a_link_leads_no_iterate_out_of_the_folder(kept: Any, iterate: Solution, tmp_path: Path) -> None:
    out, elsewhere = tmp_path / "out", tmp_path / "elsewhere"
    shutil.copytree(kept.folder, out)
    elsewhere.mkdir()
    (out / "unsolved").symlink_to(elsewhere)
    with pytest.raises(InputError, match="is a link"):
        save(iterate, out)
    assert list(elsewhere.iterdir()) == []
    assert _files(out) == _files(kept.folder)


def test_two_processes_at_once(kept: Any, iterate: Solution, tmp_path: Path) -> None:
    """One writes iterates without a pause; from when the solved result was written, nothing else stands there."""
    out = tmp_path / "out"
    save(iterate, tmp_path / "iterate")
    command = [sys.executable, "-c", WRITE_ON_AND_ON, str(tmp_path / "iterate"), str(out)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as other:
        assert other.stdout is not None
        assert other.stdout.readline() == f"{out}\n"
        save(kept.solution, out)
        seen = [load_result(out).solved for _ in range(5)]
        other.kill()
    assert all(seen)
    assert _files(out) == _files(kept.folder)
    assert not load_result(out / "unsolved").solved
