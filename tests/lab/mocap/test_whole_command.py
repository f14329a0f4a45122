"""``liftopt mocap`` and ``scenario`` of a whole person: files of full-body markers in, what the lift was out."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import tomli_w
import xarray
from marker_files import write_c3d, write_trc
from whole_markers import MAPPING, WholeTruth, whole_truth

from liftopt.commands.cli import main
from liftopt.lab.mocap.from_markers import recorded_lift
from liftopt.lab.mocap.loads import Load
from liftopt.lab.mocap.recorded_scenario import recorded_scenario
from liftopt.lab.mocap.whole_map import WholeMap
from liftopt.scenario.model import load_scenario

CUTOFF = ["--cutoff", "20"]


@pytest.fixture(scope="module")
def truth() -> WholeTruth:
    return whole_truth("squat")


@pytest.mark.parametrize("kind", ["trc", "c3d"])
def test_full_body_markers_become_a_recorded_lift(
    truth: WholeTruth, tmp_path: Path, capsys: pytest.CaptureFixture[str], kind: str
) -> None:
    if kind == "c3d":
        pytest.importorskip("ezc3d", reason="ezc3d is not installed (it is in the extra 'test')")
    file, mapping, out = tmp_path / f"lift.{kind}", tmp_path / "map.toml", tmp_path / "out"
    (write_trc if kind == "trc" else write_c3d)(truth.recording, file)
    mapping.write_text(tomli_w.dumps(MAPPING))
    before = file.read_bytes()
    options = ["--map", str(mapping), "--out", str(out), "--object-mass", "6", "--hand-share", "0.6", *CUTOFF]
    assert main(["mocap", str(file), *options]) == 0
    printed = capsys.readouterr().out
    assert "Force of the hands: right hand estimated: 60% of the force that moves 6 kg" in printed
    assert "left hand estimated: 40%" in printed
    assert "knee 0.465, hip 0.875 m above the floor" in printed
    assert "Note: both legs are followed as one" in printed
    assert file.read_bytes() == before
    with xarray.open_dataset(out / "recorded.nc", engine="h5netcdf") as lift:
        np.testing.assert_allclose(np.degrees(lift.human_q.values), np.degrees(truth.q), atol=0.25)
        assert lift.human_joint.values[:3].tolist() == ["human_ankle", "human_knee", "human_hip"]
        assert lift.grasp.values.tolist() == ["human_right", "human_left"]
        assert lift.grasp_force.dims == ("time", "grasp", "xyz")
        assert lift.centre_of_pressure.attrs["units"] == "m"
    assert main(["mocap", str(file), *options, "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["whole"]["hip"] == pytest.approx(truth.lengths.hip, abs=1e-3)
    assert len(summary["angles"]) == 20


def test_a_shipped_set_takes_axis_and_object_from_the_command_line(
    truth: WholeTruth, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    labels = [s + name for s in "RL" for name in ("Hip", "Knee", "Ankle", "Shoulder", "Elbow", "Wrist")]
    feet = ["RHEE", "LHEE", "RTOE", "LTOE"]
    recording = truth.with_labels(*labels, *feet)
    renamed = dict(zip(feet, ("RHeel", "LHeel", "RBigToe", "LBigToe"), strict=True))
    recording = type(recording)(
        **{**vars(recording), "labels": tuple(renamed.get(label, label) for label in recording.labels)}
    )
    write_trc(recording, tmp_path / "lift.trc")
    who = ["--mass", "65", "--sex", "female", "--stature", "1.7"]
    options = [str(tmp_path / "lift.trc"), "--map", "pose2sim", "--out", str(tmp_path / "out"), *who, *CUTOFF]
    assert main(["mocap", *options]) == 2
    assert "trunk over pelvis says" in capsys.readouterr().err
    assert main(["mocap", *options, "--up", "Z", "--object-markers", "B1, B2,B3,B4"]) == 0
    printed = capsys.readouterr().out
    assert "Object: away from its place from 1.67" in printed
    assert "Note: no marker shows human_Q2" in printed
    assert main(["mocap", *options, "--up", "up"]) == 2
    assert "up = 'up': must be" in capsys.readouterr().err


def test_the_left_hand_belongs_to_a_whole_person(
    truth: WholeTruth, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_trc(truth.recording, tmp_path / "lift.trc")
    options = ["--map", "box_lift", "--out", str(tmp_path / "out"), "--mass", "65", "--hand-share-left", "0.5"]
    assert main(["mocap", str(tmp_path / "lift.trc"), *options]) == 2
    assert "--hand-share-left: box_lift maps trunk and right arm only" in capsys.readouterr().err


def test_the_scenario_has_the_whole_person_alone_with_hands_where_they_held(
    truth: WholeTruth, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Where box and hands are in the motion put in, at the start and end of the time in which the box moves."""
    write_trc(truth.recording, tmp_path / "lift.trc")
    (tmp_path / "map.toml").write_text(tomli_w.dumps(MAPPING))
    recorded, made = tmp_path / "out", tmp_path / "made.toml"
    options = ["--map", str(tmp_path / "map.toml"), "--out", str(recorded), "--object-mass", "6", *CUTOFF]
    assert main(["mocap", str(tmp_path / "lift.trc"), *options]) == 0
    assert main(["scenario", str(recorded), "--object-mass", "6", "--out", str(made)]) == 0
    assert "the box's centre" in capsys.readouterr().out
    scenario = load_scenario(made)
    assert list(scenario.agents) == ["human"]
    human = scenario.first("person")
    assert (human.body, human.hands, human.stature) == ("whole", ("right", "left"), 1.7)
    centre = np.mean([truth.points[f"B{i}"] for i in range(1, 5)], axis=0)
    off = [np.linalg.norm(centre - centre[k], axis=1) > 0.005 for k in (150, -1)]
    lifted = np.flatnonzero((np.arange(300) >= 150) & off[0] & off[1])
    start, end = scenario.value("task.start.z"), scenario.value("task.end.z")
    assert start == pytest.approx(centre[lifted[0], 2], abs=0.01)
    assert end == pytest.approx(centre[-1, 2], abs=0.01)
    for side, mark in (("right", "R"), ("left", "L")):
        held = scenario.object.grasps[f"human_{side}"]
        away = (truth.points[f"{mark}Grasp"] - centre)[lifted].mean(axis=0)
        np.testing.assert_allclose(held.position, away, atol=0.005)


def test_a_hand_that_bears_nothing_does_not_hold(truth: WholeTruth) -> None:
    lift = recorded_lift(truth.recording, WholeMap.checked(MAPPING), Load(mass=6.0, share=0.0), 20.0)
    scenario = recorded_scenario(lift, 6.0)
    assert scenario.first("person").hands == ("left",)
    assert list(scenario.object.grasps) == ["human"]
