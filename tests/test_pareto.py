"""The front of human against robot effort; oracles: Pinocchio's verification, sums of the objective, definitions."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

from liftopt.cli import main
from liftopt.lift import lift
from liftopt.pareto import Front, pareto_front, weights_at
from liftopt.scenario import Scenario, load_scenario

ENTRIES = ("solver.name=banded", "solver.starts=1", "solver.intervals=12")
SET = [word for entry in ENTRIES for word in ("--set", entry)]


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    return load_scenario("table5_near", ENTRIES)


@pytest.fixture(scope="module")
def front(scenario: Scenario) -> Front:
    return pareto_front(scenario, 5)


def test_every_point_is_a_verified_optimum_of_its_weights(front: Front, scenario: Scenario) -> None:
    """Efforts and the weighted objective by Pinocchio's torques, as the verification has them."""
    assert front.missing == ()
    for point in front.points + front.dominated:
        assert point.plan.solved
        assert sum(point.weights) == pytest.approx(2.0)
        solution = point.plan.solution([], {"setup": 0.0, "total": 0.0})
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
    assert middle.plan.result.objective <= lift(scenario).objective * (1 + 1e-6)


def test_no_motion_of_another_point_is_better_for_a_points_weights(front: Front) -> None:
    """What polishing is for: each motion is a candidate at all other weights, and none wins by much."""
    for point in front.points:
        for other in front.points:
            swapped = other.plan.result.objective
            swapped += sum((a - b) * e for a, b, e in zip(point.weights, other.weights, other.efforts, strict=True))
            assert point.plan.result.objective <= swapped * (1 + 1e-6)


def test_all_points_stand_on_one_mesh_where_one_takes_a_finer_one() -> None:
    """N = 8 leaves the grasps too far apart between knots, as the lift by itself shows."""
    coarse = load_scenario("table5_free", ["solver.starts=1", "solver.tries=0", "solver.intervals=8"])
    found = pareto_front(coarse, 2)
    (intervals,) = {point.plan.spline.intervals for point in found.points}
    assert intervals in (16, 32)
    assert lift(coarse).intervals in (16, 32)


def test_weights_keep_their_sum_and_ratio() -> None:
    human, robot = weights_at(3.0, 1.0)
    assert human + robot == pytest.approx(3.0)
    assert human / robot == pytest.approx(10.0)


def test_command_writes_table_json_and_figures(
    front: Front, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The front itself is the other tests'; the command is given it."""
    asked: list[tuple[Scenario, int]] = []

    def given(scenario: Scenario, count: int, _: object) -> Front:
        asked.append((scenario, count))
        return front

    monkeypatch.setattr("liftopt.pareto.pareto_front", given)
    assert main(["pareto", "table5_near", "--points", "5", "--out", str(tmp_path), *SET]) == 0
    assert asked == [(front.scenario, 5)]
    assert "1.98 : 0.0198" in capsys.readouterr().out
    with (tmp_path / "pareto.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    found = json.loads((tmp_path / "pareto.json").read_text(encoding="utf-8"))
    assert [float(row["human_effort_N2m2s"]) for row in rows] == [p["human_effort_N2m2s"] for p in found["points"]]
    assert found["scenario"]["table"]["mass"] == 2.0
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
        (["--set", "objective.human_weight=0", "--set", "objective.robot_weight=0"], "objective.human_weight"),
    ],
)
def test_wrong_use_is_refused(words: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["pareto", *words, "--out", str(tmp_path / "new")]) == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "new").exists()
