"""The benchmark runs, says what it skips, holds what it held: oracles are its own file and the scenarios' ranges."""

from __future__ import annotations

import dataclasses
import json
import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

pytestmark = pytest.mark.long
ROOT = Path(__file__).parents[2]
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
    packages = dict.fromkeys(("snopt", "snopt_small", "snopt_zero"), "drake")
    packages |= dict.fromkeys(("moco", "moco_naive", "moco_fine"), "opensim")
    for key, package in packages.items():
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


def test_a_rival_is_compared_with_ours_on_its_own_problem_and_not_where_it_did_not_converge() -> None:
    goals, report = _module("goals"), _module("report")
    ours = {
        "banded": {"median_ms": 20.0, "cpu_median_ms": 10.0, "objective": 1.0},
        "ipopt": {"median_ms": 5.0, "cpu_median_ms": 5.0, "objective": None},
    }
    beside = {"beside": ours}
    rows = {
        "banded": goals.Row(10.0),
        "ipopt": goals.Row(100.0),
        "virtual_machine": goals.Row(300.0),
        "moco": goals.Row(4000.0, details=beside),
        "snopt": goals.Row(4000.0, details=beside | {"cpu_median_ms": 3000.0}),
        "moco_fine": goals.Row(None, "not converged after 600 s", details=beside),
    }
    ratios = report.record(rows, {}, "")["ratios"]
    assert ratios["moco"] == {"banded": 200.0}
    assert ratios["snopt"] == {"banded": 300.0}
    assert "moco_fine" not in ratios
    assert ratios["virtual_machine"] == {"ipopt": 3.0, "banded": 30.0}


def test_ours_beside_a_rival_has_the_papers_size_its_guess_and_its_slack() -> None:
    beside, rivals, case = _module("beside"), _module("rivals"), _module("case")
    lift = _module("scenarios").table5_paper()
    small = case.Case.of(lift.scenario(*rivals.PAPER), lift.ends, rivals.PAPER_INTERVALS).from_zero()
    # 8 free control points of 17 + 6 coordinates, 8 knots of 6 force components; the paper has 224.
    assert small.problem.layout.n_x == 232
    assert small.problem.task.balance_tolerance == 1.0
    control, force = small.problem.unpack(small.start)
    lower, upper = (small.problem.unpack(bound)[0] for bound in small.problem.bounds())
    assert ((control == 0.0) | (control == lower) | (control == upper)).all()
    assert (force == 10.0).all()
    found = beside.Beside(small).finish()
    assert {name: own["repeats"] for name, own in found.items()} == {"banded": 6, "ipopt": 6}
    for own in found.values():
        assert own["objective"] is not None and own["objective"] > 0.0, own["status"]


def test_moco_is_told_the_lift_and_what_comes_back_is_measured_on_our_models() -> None:
    """Our own optimum, written as Moco's answer would be: Pinocchio's torques and the forces that the solver found."""
    moco, path, case = _module("moco"), _module("moco_path"), _module("case")
    lift = _module("scenarios").table5_paper()
    given = case.Case.of(lift.scenario(), lift.ends)
    solved = given.solve(given.solver("banded"))
    told = moco.describe(dataclasses.replace(given, start=solved.x))
    answer = path.as_answer(told)
    half = {kind: {name: values[::2] for name, values in answer[kind].items()} for kind in ("q", "v", "a", "torques")}
    knots = path.on_our_models(given, half | {"time": answer["time"][::2]})
    assert max(knots.closure, knots.torque, knots.balance, knots.excess) < 1e-6
    between = path.on_our_models(given, answer)
    assert between.closure < 1e-3
    # Simpson's rule with the points midway against the trapezoid rule without them.
    assert between.objective == pytest.approx(solved.objective, rel=0.03)
    # A joint driven by another torque, or a body that is elsewhere, is seen.
    some = told["agents"][0]["joints"][0]["name"]
    wrong = answer | {"torques": answer["torques"] | {some: [tau + 5.0 for tau in answer["torques"][some]]}}
    assert path.on_our_models(given, wrong).torque > 1.0
    name = f"{told['object']['name']}_z"
    wrong = answer | {"q": answer["q"] | {name: [z + 0.01 for z in answer["q"][name]]}}
    assert path.on_our_models(given, wrong).closure == pytest.approx(0.01, rel=0.1)


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
            if key == "clearance":
                value = scenario.task.standing_distance - scenario.task.start.human_distance - scenario.object.depth
            else:
                value = scenario.value(key)
            assert lower - 1e-9 <= value <= upper + 1e-9, key


def _module(name: str) -> Any:
    """Return a module of the benchmark, as the script finds it."""
    import importlib

    sys.path.insert(0, str(SCRIPTS))
    try:
        return importlib.import_module(f"benchmarks.{name}")
    finally:
        sys.path.remove(str(SCRIPTS))
