"""The front of human against robot effort; oracles: Pinocchio's verification, sums of the objective, definitions."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from matplotlib import rc_context

from liftopt.commands.cli import main
from liftopt.commands.pareto import front_dict, table
from liftopt.scenario.model import Scenario, load_scenario
from liftopt.search.solve import solve
from liftopt.studies.pareto import Front, pareto_front, ratio_text, weights_at
from liftopt.studies.pareto_plot import pareto_figure
from liftopt.viz.plots_style import STYLE

PAPER = ("objective.preset=paper", "limits.clearance=off")
ENTRIES = (*PAPER, "solver.name=banded", "solver.starts=1", "solver.intervals=12")
SET = [word for entry in ENTRIES for word in ("--set", entry)]


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    return load_scenario("table5_near", ENTRIES)


@pytest.fixture(scope="module")
def front(scenario: Scenario) -> Front:
    return pareto_front(scenario, 5)


def test_every_point_is_a_verified_optimum_of_its_weights(front: Front) -> None:
    """Efforts and the weighted objective by Pinocchio's torques, as the verification has them."""
    assert front.missing == ()
    for point in front.points + front.dominated:
        assert point.candidate.solved
        assert sum(point.weights) == pytest.approx(2.0)
        solution = point.candidate.solution([], {"setup": 0.0, "total": 0.0})
        assert solution.objective_terms["human"] == pytest.approx(point.efforts[0])
        assert solution.objective_terms["robot"] == pytest.approx(point.efforts[1])
        assert 0.0 < point.share < 1.0


def test_no_point_of_the_front_is_beaten_and_the_weights_are_obeyed(front: Front) -> None:
    """By definition: as the person's effort rises the robot's falls; more weight on the person, less effort of it."""
    human, robot = ([point.efforts[i] for point in front.points] for i in range(2))
    assert len(front.points) >= 4
    assert human == sorted(human)
    assert robot == sorted(robot, reverse=True)
    weights = [point.weights[0] for point in front.points]
    assert weights == sorted(weights, reverse=True)
    for point in front.dominated:
        assert any(p.efforts[0] <= point.efforts[0] and p.efforts[1] <= point.efforts[1] for p in front.points)


def test_points_are_no_worse_than_the_lift_solved_by_itself(front: Front, scenario: Scenario) -> None:
    """At the scenario's own weights, from the same starts and from both neighbours."""
    middle = next(p for p in front.points + front.dominated if p.weights[0] == pytest.approx(1.0))
    assert middle.candidate.result.objective <= solve(scenario).objective * (1 + 1e-6)


def test_no_motion_of_another_point_is_better_for_a_points_weights(front: Front) -> None:
    """What polishing is for: each motion is a candidate at all other weights, and none wins by much."""
    for point in front.points:
        for other in front.points:
            swapped = other.candidate.result.objective
            swapped += sum((a - b) * e for a, b, e in zip(point.weights, other.weights, other.efforts, strict=True))
            assert point.candidate.result.objective <= swapped * (1 + 1e-6)


def test_all_points_stand_on_one_mesh_where_one_takes_a_finer_one() -> None:
    """N = 8 leaves the grasps too far apart between knots, as the lift by itself shows."""
    coarse = load_scenario("table5_free", [*PAPER, "solver.starts=1", "solver.tries=0", "solver.intervals=8"])
    found = pareto_front(coarse, 2)
    (intervals,) = {point.candidate.spline.intervals for point in found.points}
    assert intervals in (16, 32)
    assert solve(coarse).intervals in (16, 32)


def test_a_natural_front_is_about_its_presets_ratio_and_counts_shares() -> None:
    """Efforts by the definition: torque over the limit in its direction, squared, by the trapezoid rule."""
    natural = load_scenario("table5_near", ["solver.starts=1", "solver.tries=0", "solver.intervals=12"])
    found = pareto_front(natural, 3)
    assert len(found.points) + len(found.dominated) == 3
    usual = natural.value("human.weight") / natural.value("robot.weight")
    ratios = sorted(point.weights[0] / point.weights[1] for point in found.points + found.dominated)
    assert ratios == pytest.approx([usual / 100, usual, usual * 100], rel=1e-9)
    for point in found.points:
        solution = point.candidate.solution([], {"setup": 0.0, "total": 0.0})
        for agent, effort in zip(solution.agents, point.efforts, strict=True):
            tau, limits = agent.tau[:, agent.moving], agent.limits
            share = np.where(tau > 0, tau / limits.tau_upper, tau / limits.tau_lower)
            assert effort == pytest.approx(np.trapezoid((share**2).sum(axis=1), solution.time), rel=1e-9)
    row = front_dict(found)["points"][0]
    assert {"human_effort_s", "robot_effort_s"} <= set(row)
    assert "shares of strength" in " ".join(table(found, front_dict(found)).split())


def test_weights_keep_their_sum_and_ratio() -> None:
    human, robot = weights_at(3.0, 1.0)
    assert human + robot == pytest.approx(3.0)
    assert human / robot == pytest.approx(10.0)


def test_command_writes_table_json_and_figures(
    front: Front, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The front itself is the other tests'; the command is given it."""
    asked: list[tuple[Scenario, int]] = []

    def given(scenario: Scenario, count: int, _: object, between: object) -> Front:
        assert between is None
        asked.append((scenario, count))
        return front

    monkeypatch.setattr("liftopt.studies.pareto.pareto_front", given)
    assert main(["pareto", "table5_near", "--points", "5", "--out", str(tmp_path), *SET]) == 0
    assert asked == [(front.scenario, 5)]
    assert "100 : 1" in capsys.readouterr().out
    with (tmp_path / "pareto.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    found = json.loads((tmp_path / "pareto.json").read_text(encoding="utf-8"))
    assert [float(row["human_effort_N2m2s"]) for row in rows] == [p["human_effort_N2m2s"] for p in found["points"]]
    assert found["scenario"]["object"]["mass"] == 2.0
    starts = {"svg": b"<?xml", "png": b"\x89PNG", "pdf": b"%PDF"}
    for kind, first in starts.items():
        assert (tmp_path / f"pareto.{kind}").read_bytes().startswith(first)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(
        ["pareto.csv", "pareto.json", *(f"pareto.{kind}" for kind in starts)]
    )


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--points", "1"], "--points = 1"),
        (["--set", "human.weight=0", "--set", "robot.weight=0"], "human.weight"),
    ],
)
def test_wrong_use_is_refused(words: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["pareto", *words, "--out", str(tmp_path / "new")]) == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "new").exists()


def test_a_file_where_the_folder_should_be_is_told_before_any_solve(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def solved(*_: object) -> None:
        raise AssertionError("solved")

    monkeypatch.setattr("liftopt.studies.pareto.pareto_front", solved)
    (tmp_path / "taken").touch()
    for out in (tmp_path / "taken", tmp_path / "taken" / "new"):
        assert main(["pareto", "--out", str(out)]) == 2
        assert f"{tmp_path / 'taken'} is no folder" in capsys.readouterr().err


def test_terminal_and_figure_tell_the_same_ratios(front: Front) -> None:
    """The ratio with 1 for the smaller weight, by hand; the figure's labels start with what the table's rows do."""
    for weights, text in (((0.0198, 1.98), "1 : 100"), ((1.0, 1.0), "1 : 1"), ((3.98, 0.1), "39.8 : 1")):
        assert ratio_text(weights) == text
    rows = [line.strip() for line in table(front, front_dict(front)).splitlines()]
    labels = [text.get_text() for text in pareto_figure(front).axes[0].texts]
    assert "1 : 1" in {label.partition(",")[0] for label in labels}
    for label in labels:
        assert any(row.startswith(label.partition(",")[0] + "  ") for row in rows), label


@pytest.mark.parametrize("count", [3, 11, 60])
@pytest.mark.parametrize("bend", [0.02, 1.0])
def test_labels_cover_neither_each_other_nor_the_curve(front: Front, count: int, bend: float) -> None:
    """On a straight and on a bent front of few and many points: boxes of text as drawn, and samples of the curve."""
    share = np.linspace(0.0, 1.0, count)
    efforts = zip(30.0 * 100**share, 20.0 * 100 ** ((1 - share) ** (1 / bend)), strict=True)
    points = [
        replace(front.points[0], efforts=(float(a), float(b)), weights=weights_at(2.0, 2 - 4 * float(s)))
        for s, (a, b) in zip(share, efforts, strict=True)
    ]
    with rc_context(STYLE):
        figure = pareto_figure(replace(front, points=tuple(points), dominated=()))
        axes = figure.axes[0]
        figure.canvas.draw()
        boxes = [text.get_window_extent() for text in axes.texts]
    assert len(boxes) >= min(count, 8)
    ends = {text.get_text().partition(",")[0] for text in axes.texts}
    assert {"100 : 1", "1 : 100"} <= ends
    corners = axes.transData.transform([point.efforts for point in points])
    along = np.concatenate([np.linspace(a, b, 50) for a, b in pairwise(corners)])
    for i, box in enumerate(boxes):
        assert not any(box.overlaps(other) for other in boxes[:i])
        assert not np.any(np.all((box.min < along) & (along < box.max), axis=1))
        assert axes.bbox.x0 <= box.x0
        assert box.x1 <= axes.bbox.x1
    for axis in (axes.xaxis, axes.yaxis):
        low, high = axis.get_view_interval()
        ticks = [
            pair for m in (0, 1) for pair in zip(axis.get_ticklocs(minor=m), axis.get_ticklabels(minor=m), strict=True)
        ]
        marks = [label.get_window_extent() for at, label in ticks if label.get_text() and low <= at <= high]
        assert len(marks) >= 2
        assert not any(mark.overlaps(other) for i, mark in enumerate(marks) for other in marks[:i])
