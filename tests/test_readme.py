"""The README's first two commands are what CI runs; tests/docs runs all others, and its Python."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import xarray as xr

from liftopt.scenario.model import load_scenario

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
CHEAP = ("solver.starts=1", "solver.intervals=12")


def _blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", README, flags=re.MULTILINE | re.DOTALL)


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


def test_files_it_names_exist() -> None:
    for name in ("LICENSE", "CHANGELOG.md", "models/human_arm_numbers.md"):
        assert f"`{name}`" in README
        assert (ROOT / name).exists(), name


def test_the_papers_own_problem_is_a_shipped_one() -> None:
    page = (ROOT / "docs" / "concepts" / "method.md").read_text(encoding="utf-8")
    assert "table5_bare" in page
    scenario = load_scenario("table5_bare")
    assert [agent.weight for agent in scenario.agents.values()] == [1.0, 1.0]
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
