"""``liftopt compare`` and ``liftopt scenario``: files in, a table, JSON, CSV, plots and the report's section out."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from liftopt.commands.cli import main
from liftopt.lab.comparison import plots as plots_comparison
from liftopt.lab.mocap.recorded_file import save_recorded
from liftopt.scenario.model import load_scenario
from liftopt.viz import report
from liftopt.viz.plots import PLOTS
from liftopt.viz.report_figures import InlineFigure

CHEAP = ("solver.intervals=10", "solver.starts=1")


@pytest.fixture(scope="module")
def result(solved: Callable[..., Any]) -> Any:
    return solved("table5", *CHEAP)


@pytest.fixture(scope="module")
def trials(result: Any, as_recorded: Callable[..., Any], tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """Return the folders of two recorded lifts whose angles are 1 deg lower and 1 deg higher than predicted."""
    folders = []
    for name, raised in (("a", -1.0), ("b", 1.0)):
        folder = tmp_path_factory.mktemp(name)
        save_recorded(as_recorded(result.solution, raised=np.radians(raised)), folder)
        folders.append(str(folder))
    return folders


@pytest.fixture(scope="module")
def sensors(tmp_path_factory: pytest.TempPathFactory) -> str:
    file = tmp_path_factory.mktemp("forces") / "forces.csv"
    rows = [f"{0.3 * k:.1f},trial {trial},{8 + trial},1" for trial in (1, 2) for k in range(10 * trial, 10 * trial + 8)]
    file.write_text("time [s],mark,finger1 [N],thumb1 [N]\n" + "\n".join(rows) + "\n")
    return str(file)


def test_a_comparison(
    result: Any,
    trials: list[str],
    sensors: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    # The others are drawn in the same way and take most of the time.
    plots = ("compared_human_arm", "compared_hand")
    monkeypatch.setattr(plots_comparison, "PLOTS", [plot for plot in plots_comparison.PLOTS if plot.name in plots])
    out = tmp_path / "compared"
    before = {path: path.read_bytes() for path in (Path(trials[0]) / "recorded.nc", Path(sensors))}
    words = ["compare", str(result.folder), "--mocap", *trials, "--forces", sensors, "--out", str(out)]
    assert main(words) == 0
    printed = capsys.readouterr().out
    assert re.search(r"^Elbow flexion +deg +[0-9.]+ +[0-9.]+ +[-+][0-9.]+ +0[. ]", printed, re.MULTILINE)
    assert max(len(line) for line in printed.splitlines() if not line.startswith(("Note", "differ", "Written"))) <= 80
    assert {path: path.read_bytes() for path in before} == before
    expected = {"comparison.json", "comparison.csv"}
    expected |= {f"{name}.{kind}" for name in plots for kind in ("svg", "png", "pdf")}
    assert {path.name for path in out.iterdir()} == expected
    summary = json.loads((out / "comparison.json").read_text())
    elbow = next(item for item in summary["quantities"] if (item["group"], item["name"]) == ("human_angle", "Q7"))
    # Trials at -1 and +1 about the mean have the standard deviation sqrt(2).
    assert (elbow["trials"], elbow["spread"]) == (2, pytest.approx(np.sqrt(2.0)))
    assert elbow["rmse"] < 0.01
    # Sensors: 9 - 1 and 10 - 1 N in the two trials of the file, 8.5 N on average.
    force = next(item for item in summary["quantities"] if item["name"] == "sensors")
    assert (force["trials"], force["peak_recorded"], force["correlation"]) == (2, pytest.approx(8.5), None)
    with (out / "comparison.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if (row["group"], row["name"]) == ("human_angle", "Q7")]
    assert [float(row["percent"]) for row in rows[::100]] == [0.0, 50.0, 100.0]
    assert float(rows[50]["trial 2"]) - float(rows[50]["trial 1"]) == pytest.approx(-2.0, abs=1e-3)  # flexion is -Q7
    assert main(words) == 2
    assert "exists already" in capsys.readouterr().err


def test_json_and_the_experiment_in_the_report(
    result: Any, sensors: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    # The figures of the prediction have tests of their own and take most of the time.
    blank = {plot.name: InlineFigure(plot.name, plot.caption, "<svg></svg>") for plot in PLOTS}
    monkeypatch.setattr(report, "inline_figures", lambda _: blank)
    words = ["compare", str(result.folder), "--forces", sensors, "--forces-lift", "0.3", "1.8", "--json", "--report"]
    assert main([*words, "--out", str(tmp_path / "out")]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert [item["name"] for item in summary["quantities"]] == ["sensors"]
    assert summary["duration"] == 2.0
    page = (tmp_path / "out" / "report.html").read_text()
    assert '<section id="experiment">' in page
    assert 'id="plot-compared_hand"' in page
    assert page.count("fingers minus thumb is compared with the vertical force") == 1
    assert "nothing here was measured" not in page


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ([], "needs recordings: --mocap, --forces or --robot"),
        (["--mocap", "nowhere"], "nowhere: no such file; liftopt mocap writes one"),
        (["--robot", "nowhere.bag"], "nowhere.bag: no such bag"),
        (["--forces", "nowhere.csv"], "nowhere.csv"),
    ],
)
def test_bad_input(
    result: Any, options: list[str], match: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["compare", str(result.folder), *options, "--out", str(tmp_path / "out")]) == 2
    printed = capsys.readouterr()
    assert match in printed.err
    assert printed.err.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_voltages_need_a_calibration(result: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "volts.csv"
    file.write_text("time [s],finger1 [V]\n0,1\n1,2\n")
    assert main(["compare", str(result.folder), "--forces", str(file), "--out", str(tmp_path / "out")]) == 2
    assert "volts.csv: holds voltages: a calibration is needed (--calibration CAL)" in capsys.readouterr().err


def test_a_recorded_lift_becomes_a_scenario(
    trials: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "box.toml"
    words = ["scenario", trials[0], "--object-mass", "2", "--out", str(file)]
    assert main(words) == 0
    assert "2 kg from 0.9 to 1.4 m in 2 s" in capsys.readouterr().out
    scenario = load_scenario(file)
    assert (scenario.object.mass, scenario.duration, scenario.agents["robot"].weight) == (2.0, 2.0, 0.0)
    assert main(words) == 2
    assert "exists already" in capsys.readouterr().err
