"""A whole person's lift beside records of it: made from the prediction with known differences, it gives them back."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from liftopt.commands.cli import main
from liftopt.errors import InputError
from liftopt.lab.comparison.comparison import Comparison
from liftopt.lab.comparison.experiment import Experiment, experiment
from liftopt.lab.mocap.recorded_file import save_recorded
from liftopt.lab.mocap.recorded_lift import RecordedLift
from liftopt.multibody.person.whole_joints import JOINTS
from liftopt.solution.solution import Solution
from liftopt.storage.writer import save

Made = Callable[..., RecordedLift]


@pytest.fixture(scope="module")
def squat(team_solution: Callable[[str], Any]) -> Solution:
    solution: Solution = team_solution("squat").solution
    return solution


@pytest.fixture(scope="module")
def arm(solved: Callable[..., Any]) -> Solution:
    solution: Solution = solved("table5", "solver.intervals=10", "solver.starts=1").solution
    return solution


def _one(found: Experiment, group: str, name: str) -> Comparison:
    (wanted,) = [item for item in found.group(group) if item.name == name]
    return wanted


def test_legs_trunk_and_both_arms_are_listed(squat: Solution, as_recorded: Made) -> None:
    found = experiment(squat, mocap=[as_recorded(squat), as_recorded(squat, scale=1.1)])
    for group in ("human_angle", "human_torque"):
        assert tuple(one.name for one in found.group(group)) == JOINTS
    knee = _one(found, "human_angle", "knee").measures
    assert knee.rmse == pytest.approx(
        0.05 * np.sqrt(np.mean(_one(found, "human_angle", "knee").predicted ** 2)), rel=0.01
    )
    assert knee.peak_difference == pytest.approx(100.0 * (1.0 / 1.05 - 1.0), abs=0.1)
    elbow = _one(found, "human_angle", "left_Q7")
    assert elbow.measures.peak_predicted > 0.0  # flexion, as anatomy counts it
    names = [one.name for one in found.group("hand_path")]
    assert names == ["x", "z", "right_x", "right_z", "left_x", "left_z"]
    assert [one.name for one in found.group("hand_force")] == ["mocap", "right_mocap", "left_mocap"]


def test_the_ground_is_compared_by_the_motion_or_by_plates(squat: Solution, as_recorded: Made) -> None:
    found = experiment(squat, mocap=[as_recorded(squat)])
    assert _one(found, "ground", "vertical").measures.rmse == pytest.approx(0.0, abs=2.0)
    assert _one(found, "ground", "pressure").measures.rmse == pytest.approx(0.0, abs=1e-3)
    assert any("what the recorded motion asks for" in note for note in found.notes)


def test_by_the_height_of_the_hand_pace_does_not_count(squat: Solution, as_recorded: Made) -> None:
    """A record that is late by 15 % of the lift differs by time, and hardly where its hands are as high."""
    late = experiment(squat, mocap=[as_recorded(squat, late=0.15)])
    assert _one(late, "human_angle", "knee").measures.rmse > 5.0
    (note,) = [note for note in late.notes if note.startswith("angles by the height of the hand")]
    by_height = dict(pair.rsplit(" ", 1) for pair in note.partition("RMSE of ")[2].removesuffix(" deg").split(", "))
    assert tuple(by_height) == JOINTS
    assert float(by_height["knee"]) < 0.5


def test_only_the_right_arm_is_the_same_in_both_bodies(squat: Solution, arm: Solution, as_recorded: Made) -> None:
    for prediction, record in ((squat, as_recorded(arm)), (arm, as_recorded(squat))):
        found = experiment(prediction, mocap=[record])
        names = [one.name.removeprefix("right_") for one in found.group("human_angle")]
        assert names == [f"Q{k}" for k in range(4, 11)]
        assert any("only the right arm's joints are compared" in note for note in found.notes)
    with pytest.raises(InputError, match=r"--mocap.*of body 'arm', but.*of 'whole'"):
        experiment(squat, mocap=[as_recorded(squat), as_recorded(arm)])


def test_the_command_writes_tables_plots_and_figures_of_legs(
    squat: Solution, as_recorded: Made, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    save(squat, tmp_path / "result")
    save_recorded(as_recorded(squat), tmp_path / "recorded")
    out = tmp_path / "out"
    options = ["--mocap", str(tmp_path / "recorded"), "--out", str(out)]
    assert main(["compare", str(tmp_path / "result"), *options]) == 0
    printed = capsys.readouterr().out
    for shown in ("Knee flexion", "Left elbow flexion", "Right shoulder flexion", "Centre of pressure"):
        assert shown in printed, shown
    written = {path.name for path in out.iterdir()}
    assert {"compared_human_legs.svg", "compared_ground.svg", "compared_human_arm.svg"} <= written
    summary = json.loads((out / "comparison.json").read_text())
    assert {"knee", "left_Q7", "Q2"} <= {quantity["name"] for quantity in summary["quantities"]}
