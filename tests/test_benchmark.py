"""The benchmark runs, says what it skips, holds what it held: oracles are its own file and the scenarios' ranges."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[1]
SCRIPTS = ROOT / "scripts"
# As if what the rivals need were not installed.
WITHOUT = """
import runpy, sys
sys.modules.update(pydrake=None, opensim=None)
sys.argv[:2] = sys.argv[1:2]
sys.path.insert(0, sys.argv[0].rpartition("/")[0])
runpy.run_path(sys.argv[0], run_name="__main__")
"""


def _run(*words: str) -> str:
    command = [sys.executable, "-c", WITHOUT, str(SCRIPTS / "benchmark.py"), *words]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    return run.stdout


@pytest.fixture(scope="module")
def first(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    folder = tmp_path_factory.mktemp("benchmark")
    return folder, _run("--quick", "--only", "banded", "snopt", "moco", "--out", str(folder))


def test_one_row_is_measured_and_kept_with_its_goal(first: tuple[Path, str]) -> None:
    folder, said = first
    kept = json.loads((folder / "benchmark.json").read_text(encoding="utf-8"))
    row = kept["rows"]["banded"]
    assert row["value"] > 0.0
    assert (row["goal"], row["beyond"], row["unit"]) == (30, 15, "ms")
    assert row["verdict"] in ("missed", "reached", "beyond")
    assert row["note"] == "", "the solution was not verified"
    assert (
        row["counts"]["unknowns"] == 21 * 23 + 21 * 6
    )  # 19 free control points of 17 + 6 coordinates, 21 knots of 6 force components
    assert row["counts"]["iterations"] > 5
    assert {"cpu", "cores"} <= set(kept["machine"])
    assert kept["versions"]["casadi"] != "not installed"
    assert "banded, cold from a given start" in said


def test_what_is_not_installed_is_said_and_skipped(first: tuple[Path, str]) -> None:
    folder, said = first
    rows = json.loads((folder / "benchmark.json").read_text(encoding="utf-8"))["rows"]
    for key, package in (("snopt", "drake"), ("moco", "opensim")):
        assert rows[key]["value"] is None
        assert f"pip install {package}" in rows[key]["note"]
    assert "skipped" in said


def test_compared_with_itself_no_count_changes_and_a_changed_one_is_shown(first: tuple[Path, str]) -> None:
    from rich.console import Console

    report = _module("report")
    run = json.loads((first[0] / "benchmark.json").read_text(encoding="utf-8"))
    console = Console(record=True, width=200)
    report.compare(run, run, console)
    assert "No count has changed" in console.export_text()
    old = json.loads(json.dumps(run))
    old["rows"]["banded"]["counts"]["iterations"] = 2 * run["rows"]["banded"]["counts"]["iterations"]
    report.compare(old, run, console)
    shown = console.export_text()
    assert "banded, iterations" in shown
    assert "-50.0 %" in shown


def test_meshes_are_timed_by_themselves_and_from_one_to_the_next() -> None:
    row = _module("solves").scaling(1, (10, 20, 40), ("banded",))
    found = row.details["banded"]
    assert found["not_converged"] == []
    assert all(ms > 0.0 for key in ("ms", "stepwise_ms") for ms in found[key]) and len(found["stepwise_ms"]) == 3
    an_interval = [ms / n for ms, n in zip(found["ms"], (10, 20, 40), strict=True)]
    assert row.value == pytest.approx(max(an_interval) / min(an_interval))


@pytest.mark.parametrize(
    ("value", "more", "verdict"),
    [(9.0, False, "beyond"), (15.0, False, "reached"), (21.0, False, "missed"), (21.0, True, "beyond")],
)
def test_verdict_by_both_bounds(value: float, more: bool, verdict: str) -> None:
    goals = _module("goals")
    bounds = (15.0, 20.0) if more else (20.0, 10.0)
    assert goals.Goal("", "ms", *bounds, more=more).verdict(value) == verdict


def test_varied_scenarios_are_kept_in_their_ranges_with_their_references() -> None:
    scenarios = _module("scenarios")
    kept = scenarios.varied_scenarios()
    assert len(kept) == scenarios.COUNT
    assert len({varied.overrides for varied in kept}) == scenarios.COUNT
    references = [varied.objective for varied in kept]
    assert all(value is not None and math.isfinite(value) for value in references[: scenarios.WITH_REFERENCE])
    assert references[scenarios.WITH_REFERENCE :] == [None] * (scenarios.COUNT - scenarios.WITH_REFERENCE)
    for varied in kept:
        scenario = varied.scenario()
        for key, (lower, upper) in scenarios.RANGES.items():
            value: Any = scenario
            if key == "clearance":
                value = scenario.task.standing_distance - scenario.task.start.human_distance - scenario.table.depth
            else:
                for name in key.split("."):
                    value = getattr(value, name)
            assert lower - 1e-9 <= value <= upper + 1e-9, key


def _module(name: str) -> Any:
    """Return a module of the benchmark, as the script finds it."""
    import importlib

    sys.path.insert(0, str(SCRIPTS))
    try:
        return importlib.import_module(f"benchmarks.{name}")
    finally:
        sys.path.remove(str(SCRIPTS))
