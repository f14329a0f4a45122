"""``liftopt mocap``: a TRC file and a mapping in, recorded.nc and a summary out."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
import xarray
from marker_files import write_trc

from liftopt.commands.cli import main


@pytest.fixture
def files(truth: Any, tmp_path: Path) -> tuple[Path, Path]:
    """Return the lift of known motion as a TRC file, and its mapping without the person's mass."""
    trc, mapping = tmp_path / "lift.trc", tmp_path / "map.toml"
    write_trc(truth.recording, trc)
    mapping.write_text(tomli_w.dumps(truth.mapping_dict | {"subject": {"sex": "female", "stature": 1.7}}))
    return trc, mapping


def test_a_recording_becomes_a_recorded_lift(
    files: tuple[Path, Path], truth: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    trc, mapping = files
    before = trc.read_bytes()
    out = tmp_path / "out"
    options = ["--map", str(mapping), "--out", str(out), "--mass", "65", "--object-mass", "6", "--cutoff", "20"]
    assert main(["mocap", str(trc), *options]) == 0
    printed = capsys.readouterr().out
    assert "200 frames at 100 Hz" in printed
    assert "1.700 m (given), 65 kg, female" in printed
    assert "estimated: 50% of the force that moves 6 kg" in printed
    assert trc.read_bytes() == before
    with xarray.open_dataset(out / "recorded.nc", engine="h5netcdf") as lift:
        np.testing.assert_allclose(lift.human_q.values[:, 3:], truth.q[:, 3:], atol=3e-4)
        assert lift.human_joint.values[0] == "human_GT1"
        assert {lift[name].attrs["units"] for name in ("human_q", "human_tau", "marker_residual")} == {
            "rad",
            "N m",
            "m",
        }
    assert main(["mocap", str(trc), *options, "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["frames"] == 200
    assert summary["subject"] == {"stature": 1.7, "mass": 65.0, "sex": "female"}
    assert max(summary["residual_rms"].values()) < 1e-4


def test_a_measured_force(files: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    trc, mapping = files
    series = tmp_path / "force.csv"
    series.write_text("time,fx,fy,fz\n0.4,0,0,20\n1.6,0,0,20\n")
    options = ["--map", str(mapping), "--out", str(tmp_path), "--mass", "65", "--hand-force", str(series)]
    assert main(["mocap", str(trc), *options]) == 0
    assert "which has none for 79 of 200 frames (0 N there)" in capsys.readouterr().out
    assert main(["mocap", str(trc), *options, "--hand-force-start", "1.75"]) == 2
    assert "1.75 to 2.95 s': does not hold the lift" in capsys.readouterr().err


def test_part_of_a_trial(files: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    trc, mapping = files
    options = ["--map", str(mapping), "--out", str(tmp_path / "out"), "--mass", "65", "--object-mass", "6", "--json"]
    options += ["--from", "0.2", "--to", "1.8", "--ignore", "ARM1", "--ignore", "MC2:0.6-0.7", "--lift", "1"]
    assert main(["mocap", str(trc), *options]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["frames"] == 161
    assert summary["seconds"] == pytest.approx(1.6)
    assert "ARM1" not in summary["residual_rms"]
    assert [summary["carried"]] == summary["lifts"]
    assert [(gap["marker"], gap["first"], gap["last"]) for gap in summary["gaps"]] == [("MC2", 40, 50)]


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ([], "subject.mass: must be given in kg"),
        (["--mass", "-3"], "subject.mass = -3.0"),
        (["--mass", "65", "--cutoff", "70"], "cutoff = 70.0: must be above 0 and below half the rate"),
        (["--mass", "65", "--object-mass", "nan"], "--object-mass = nan"),
        (["--mass", "65", "--hand-share", "2"], "--hand-share = 2.0"),
        (["--mass", "65", "--hand-share", "0.3"], "--hand-share = 0.3: is a hand's share of --object-mass KG"),
        (["--mass", "65", "--hand-force-start", "1"], "--hand-force-start = 1.0: is when --hand-force FILE starts"),
        (["--mass", "65", "--hand-force", "none.csv"], "none.csv: no such file"),
        (["--mass", "65", "--ignore", "NOSE"], "--ignore = 'NOSE': no such marker"),
        (
            ["--mass", "65", "--ignore", "ARM1:a-b"],
            "--ignore = 'ARM1:a-b': must be MARKER or MARKER:FROM-TO in seconds",
        ),
        (["--mass", "65", "--from", "3"], "--from = '3'"),
        (["--mass", "65", "--to", "foot strike"], "has no events"),
        (["--mass", "65", "--lift", "2"], "--lift = 2"),
    ],
)
def test_bad_input_is_one_line_and_leaves_nothing(
    files: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str], options: list[str], match: str
) -> None:
    trc, mapping = files
    assert main(["mocap", str(trc), "--map", str(mapping), "--out", str(tmp_path / "out"), *options]) == 2
    error = capsys.readouterr().err
    assert match in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_files_of_another_kind_are_refused(
    files: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    other = tmp_path / "lift.csv"
    other.write_text("time\n")
    assert main(["mocap", str(other), "--map", str(files[1]), "--out", str(tmp_path), "--mass", "65"]) == 2
    assert ".c3d and .trc files are" in capsys.readouterr().err
    assert main(["mocap", str(files[0]), "--map", "no_map", "--out", str(tmp_path), "--mass", "65"]) == 2
    assert "no_map: no such file" in capsys.readouterr().err
