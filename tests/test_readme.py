"""The README is true: its commands run as they stand there, its Python too, and CI runs its first two."""

from __future__ import annotations

import os
import re
import shlex
import signal
import subprocess
import sys
from pathlib import Path

import pytest
import xarray as xr

from liftopt.commands.cli import main

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
CHEAP = ("solver.starts=1", "solver.intervals=12")


def _blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", README, flags=re.MULTILINE | re.DOTALL)


def _commands() -> list[list[str]]:
    """Return the arguments of every ``liftopt`` command in the sh blocks, in the README's order."""
    found = []
    for block in _blocks("sh"):
        for line in block.replace("\\\n", " ").splitlines():
            for command in line.split("&&"):
                words = shlex.split(command, comments=True)
                if words and words[0].rpartition("/")[2] == "liftopt":
                    found.append(words[1:])
    return found


def _served_until_interrupted(words: list[str]) -> int:
    """Return the exit status of a served page, ended by Ctrl-C once its address stands there."""
    command = [sys.executable, "-m", "liftopt", *words, "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as served:
        assert served.stdout is not None
        for line in served.stdout:
            if "http://" in line:
                served.send_signal(signal.SIGINT)
                break
        served.stdout.read()
        return served.wait(timeout=300)  # only so that a hang fails


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Run all commands in order, in one folder, solves on a coarse mesh; what they leave is for the other tests."""
    folder, here = tmp_path_factory.mktemp("readme"), Path.cwd()
    os.chdir(folder)
    try:
        for words in _commands():
            extra: list[str] = []
            if words[0] in ("solve", "sensitivity", "pareto"):
                extra = [word for entry in CHEAP for word in ("--set", entry)]
            if words[0] == "pareto":
                extra += ["--points", "3"]
            if words == ["crosscheck"]:
                extra = ["--samples", "20"]
            if words[0] == "view" and "--html" not in words:
                assert _served_until_interrupted(words) == 0, words
            else:
                assert main([*words, *extra]) == 0, words
    finally:
        os.chdir(here)
    return folder


def test_first_two_commands_are_what_ci_runs() -> None:
    """CI takes the first two lines of sh blocks, with the very sed expression that stands in .ci/run."""
    first = _blocks("sh")[0].splitlines()
    assert len(first) == 2
    assert "pip install" in first[0]
    assert first[0].endswith("liftopt solve")
    assert first[1].endswith("pytest")
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    sed = re.search(r"sed -n '[^']+' README\.md \| head -n 2", script)
    assert sed is not None
    run = subprocess.run(["bash", "-c", sed[0]], cwd=ROOT, capture_output=True, text=True, check=True)
    assert run.stdout.splitlines() == first
    assert re.search(r'bash .*-c "\$command"', script)


def test_every_command_runs_in_the_readmes_order(lab: Path) -> None:
    commands = [words[0] for words in _commands()]
    assert commands.count("solve") >= 4
    assert {"crosscheck", "view", "report", "plot"} <= set(commands)
    assert (lab / "lift.html").stat().st_size > 1_000_000
    for folder in ("table5", "table5_near", "free", "mine"):
        with xr.open_dataset(lab / "results" / folder / "solution.nc", engine="h5netcdf") as result:
            assert result.attrs["status"] == "solved"


@pytest.mark.parametrize("index", range(len(_blocks("python"))))
def test_python_runs_beside_the_results(index: int, lab: Path) -> None:
    command = [sys.executable, "-c", _blocks("python")[index]]
    run = subprocess.run(command, cwd=lab, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    assert "solved" in run.stdout


def test_files_and_folders_it_names_exist(lab: Path) -> None:
    for name in re.findall(r"^\| `((?:liftopt|models|scripts|tests)/[^`*]*)`", README, flags=re.MULTILINE):
        assert (ROOT / name).exists(), name
    for name in ("LICENSE", "CHANGELOG.md", "models/human_arm_numbers.md"):
        assert f"`{name}`" in README
        assert (ROOT / name).exists(), name
    files = {path.relative_to(lab / "results/table5").as_posix() for path in (lab / "results/table5").rglob("*.*")}
    assert {"solution.nc", "scenario.toml"} <= files
    assert any(re.fullmatch(r"models/.*\.urdf", name) for name in files)


def test_papers_own_problem_is_spelled_as_the_command_takes_it() -> None:
    from liftopt.scenario.model import load_scenario

    entries = re.findall(r"--set\s+((?:objective|limits)\.\w+=[\d.]+)", README)
    assert len(entries) == 3
    scenario = load_scenario("table5", entries)
    assert (scenario.objective.acceleration_weight, scenario.objective.force_weight) == (0.0, 0.0)
    assert scenario.limits.balance_tolerance == 1.0


def test_script_is_the_command(tmp_path: Path) -> None:
    """Same scenario, same bytes in the trajectories, by the script and by ``python -m liftopt``."""
    arguments = [word for entry in CHEAP for word in ("--set", entry)]
    script = ROOT / "scripts" / "solve.py"
    for name, command in {"script": [str(script)], "module": ["-m", "liftopt", "solve"]}.items():
        run = subprocess.run(
            [sys.executable, *command, "table5_near", "--out", name, *arguments],
            cwd=tmp_path, capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert run.returncode == 0, run.stderr
    one, other = (xr.load_dataset(tmp_path / name / "solution.nc", engine="h5netcdf") for name in ("script", "module"))
    assert one.identical(other.assign_attrs(one.attrs))
    assert one.attrs["objective"] == other.attrs["objective"]
