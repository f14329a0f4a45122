"""The hand's force from recorded sensors: sums by hand, an ideal sensor in closed form, and broken files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from liftopt.commands.cli import main
from liftopt.errors import InputError
from liftopt.lab.forces.calibration import Calibration, Curve, calibrate, save_calibration
from liftopt.lab.forces.force_file import read_forces, write_forces
from liftopt.lab.forces.force_record import BEYOND, MISSING, SATURATED, hand_force, side
from liftopt.lab.forces.voltage_divider import Divider

SIX = ("finger1", "finger2", "finger3", "finger4", "thumb1", "thumb2")
# 2 N for a volt, up to 8 N: a straight line, so that every force can be checked by hand.
CALIBRATION = Calibration(
    divider=Divider(), curves={"all": Curve(voltage=(0.0, 1.0, 2.5, 4.0), force=(0.0, 2.0, 5.0, 8.0))}
)
HEADER = "time [s],mark," + ",".join(f"{name} [V]" for name in SIX)
# Irregular steps near 0.3 s, as the paper's Arduino took them.
ROWS = [
    "0.0,preload 1,0.1,0.1,0.1,0.1,0.2,0.0",
    "0.3,preload 1,0.1,0.1,0.3,0.1,0.2,0.0",
    "1.0,trial 1,1.1,1.1,1.2,1.1,0.7,0.5",
    "1.29,trial 1,2.1,1.1,1.2,1.1,0.7,0.5",
    "1.62,trial 1,3.1,1.1,1.2,1.1,0.7,0.5",
    "3.0,preload 2,0,0,0,0,0,0",
    "4.0,trial 2,1,1,1,1,1,1",
    "4.31,trial 2,4.2,1,1,1,1,1",
    "4.6,trial 2,5.0,1,1,1,1,1",
    "6.9,trial 2,1,,1,1,1,1",
]


def recording(path: Path, rows: list[str] = ROWS, header: str = HEADER, head: str = "# liftopt record\n") -> Path:
    path.write_text(head + "\n".join([header, *rows]) + "\n")
    return path


def test_fingers_minus_thumb_with_the_preload_subtracted(tmp_path: Path) -> None:
    first, second = read_forces(recording(tmp_path / "r.csv"), CALIBRATION)
    np.testing.assert_allclose(first.preload, [0.2, 0.2, 0.4, 0.2, 0.4, 0.0], atol=1e-12)
    np.testing.assert_allclose(first.force[0], [2.0, 2.0, 2.0, 2.0, 1.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(first.hand_force, [6.0, 8.0, 10.0], atol=1e-12)
    assert (first.trial, second.trial) == (1, 2)
    assert first.time.tolist() == [1.0, 1.29, 1.62]
    np.testing.assert_allclose(second.preload, 0.0)
    np.testing.assert_allclose(second.hand_force[:1], [4.0])
    assert not first.doubtful.any()
    assert any("preload from preload 1" in note for note in first.notes)


def test_saturated_beyond_and_missing_are_flagged_not_hidden(tmp_path: Path) -> None:
    record = read_forces(recording(tmp_path / "r.csv"), CALIBRATION)[1]
    assert record.flags[:, 0].tolist() == [0, BEYOND, BEYOND | SATURATED, 0]
    assert record.flags[:, 1].tolist() == [0, 0, 0, MISSING]
    np.testing.assert_allclose(record.force[1:3, 0], 8.0)  # at least this
    assert np.isnan(record.hand_force[3])
    assert record.doubtful.tolist() == [False, True, True, True]
    notes = "\n".join(record.notes)
    assert "no sample for 2.30 s after 4.60 s" in notes
    assert "saturated: finger1 in 1 of 4 samples" in notes
    assert "missing: finger2 in 1 of 4" in notes


def test_over_normalised_time_samples_are_joined_by_lines(tmp_path: Path) -> None:
    record = read_forces(recording(tmp_path / "r.csv"), CALIBRATION)[0]
    share = np.array([0.0, 0.29 / 0.62, 0.5, 1.0])
    by_hand = [6.0, 8.0, 8.0 + 2.0 * (0.31 - 0.29) / 0.33, 10.0]
    np.testing.assert_allclose(record.over_share(share), by_hand, atol=1e-9)
    np.testing.assert_allclose(record.over_share(np.array([0.5]), 1.0, 1.29), [7.0])
    with pytest.raises(InputError, match=r"holds 1 to 1\.62 s"):
        record.over_share(share, 0.5, 1.5)


def test_counts_millivolts_and_milliseconds(tmp_path: Path) -> None:
    header = "Time (ms);index [mV];thumb (counts)"
    path = recording(tmp_path / "r.csv", ["0;1000;0", "300;2500;204.6"], header, head="")
    record = read_forces(path, CALIBRATION)[0]
    np.testing.assert_allclose(record.time, [0.0, 0.3])
    np.testing.assert_allclose(record.hand_force, [2.0, 5.0 - 2.0], atol=1e-12)


def test_forces_of_another_tool_in_grams_with_an_unloaded_start(tmp_path: Path) -> None:
    """A file without marks, as the paper's program in MATLAB would have saved it."""
    rows = ["0,10,5", "0.3,10,5", "0.6,1010,105", "0.9,1010,105"]
    path = recording(tmp_path / "r.csv", rows, "time [s],finger1 [g],thumb1 [g]", head="")
    np.testing.assert_allclose(read_forces(path)[0].hand_force, 9.81e-3 * np.array([5.0, 5.0, 905.0, 905.0]))
    np.testing.assert_allclose(read_forces(path, unloaded=0.3)[0].hand_force, [0.0, 0.0, 8.829, 8.829], atol=1e-12)
    assert "no preload was recorded" in read_forces(path)[0].notes[-1]
    with pytest.raises(InputError, match=r"--unloaded = 0\.9: must be shorter than trial 1 of .*, which lasts 0\.9 s"):
        read_forces(path, unloaded=0.9)


def test_written_forces_are_read_back_with_their_flags(tmp_path: Path) -> None:
    trials = read_forces(recording(tmp_path / "r.csv"), CALIBRATION)
    write_forces(trials, tmp_path / "forces.csv")
    again = read_forces(tmp_path / "forces.csv")
    assert [one.trial for one in again] == [1, 2]
    for one, other in zip(trials, again, strict=True):
        assert one.channels == other.channels
        np.testing.assert_allclose(other.force, one.force, atol=1e-5)
        np.testing.assert_allclose(other.time, one.time)
        np.testing.assert_array_equal(other.flags, one.flags)
    with pytest.raises(InputError, match="exists already"):
        write_forces(trials, tmp_path / "forces.csv")


def test_the_whole_chain_is_right_within_a_count_of_the_converter(tmp_path: Path) -> None:
    """Against sensors whose conductance is proportional to the force, calibrated and read by a 10-bit converter."""

    def counts(force: float) -> int:
        product = 1e4 * 2e-5 * force
        return round(1023 * product / (1.0 + product))

    series = tmp_path / "s.csv"
    rows = [f"{counts(9.81e-3 * grams)},{grams}" for grams in range(0, 901, 3)]
    series.write_text("\n".join(["voltage [counts],weight [g]", *rows]) + "\n")
    calibration = calibrate([series], Divider()).calibration
    rng = np.random.default_rng(1)
    true = rng.uniform(0.0, 8.8, (50, 6))
    rows = [",".join([f"{0.3 * k:g}", *(str(counts(f)) for f in row)]) for k, row in enumerate(true)]
    path = recording(tmp_path / "r.csv", rows, "time [s]," + ",".join(f"{name} [counts]" for name in SIX), head="")
    (record,) = read_forces(path, calibration)
    count = (1.0 + 0.2 * true) ** 2 / 0.2 / 1023  # N, of a count, at each force
    assert np.all(np.abs(record.force - true) < count)  # half from the calibration, half from the reading
    assert np.all(np.abs(record.hand_force - (true[:, :4].sum(axis=1) - true[:, 4:].sum(axis=1))) < count.sum(axis=1))
    assert not record.doubtful.any()


@pytest.mark.parametrize("cut", [1, 3, 20])
def test_a_last_line_cut_by_a_crash_is_left_out_and_noted(cut: int, tmp_path: Path) -> None:
    """With one byte gone all fields are there: only the newline tells."""
    path = recording(tmp_path / "r.csv")
    whole = path.read_bytes()
    path.write_bytes(whole[:-cut])
    second = read_forces(path, CALIBRATION)[1]
    assert second.time.tolist() == [4.0, 4.31, 4.6]
    assert f"line {2 + len(ROWS)} was cut off" in second.notes[0]
    assert path.read_bytes() == whole[:-cut]


@pytest.mark.parametrize(
    ("rows", "header", "said"),
    [
        (["0,x,1"], "time [s],mark,finger1 [V]", "line 3 = 'x': the mark must be"),
        (["0,trial 1,1", "1,trial 2,1", "2,trial 1,1"], "time [s],mark,finger1 [V]", "line 5 = 'trial 1'.*one block"),
        (["0,1", "1,2", "0.5,2"], "time [s],finger1 [V]", "line 5 = 0.5: the time must increase"),
        ([",1"], "time [s],finger1 [V]", "line 3 = '': the time is missing"),
        (["0,1"], "time [s],toe [V]", "line 2 = 'toe': must start with finger"),
        (["0,1"], "time [s],finger1 [A]", r"line 2 = 'finger1 \[A\]'"),
        (["0,1,1"], "time [s],finger1 [V],thumb1 [N]", r"'thumb1 \[N\]': the unit must be V"),
        (["0,1,1"], "time [s],finger1 [V],finger1 [V]", "two columns have this name"),
        (["0"], "time [s]", "has no columns of sensors"),
        (["0,1"], "clock [s],finger1 [V]", r"has no column time \[s or ms\]"),
        (["0,1"], "time [min],finger1 [V]", "the unit must be s or ms"),
        (["0,1", "1,7.5"], "time [s],finger1 [V]", "line 4 = 'finger1 7.5 V': must be from 0 to the supply"),
        (["0,1", "1,1,5", "2,1"], "time [s],finger1 [V]", "line 4 = '3 fields'"),
        (["0,1", "1,1e300"], "time [s],finger1 [kg]", "line 4 = 'finger1 1e\\+300 kg': must be within 10000 N"),
        (["0,trial ²,1"], "time [s],mark,finger1 [V]", "the mark must be"),
        (["0,1,toe:beyond"], "time [s],finger1 [N],flags", "line 3 = 'toe:beyond'"),
        (["0,preload 1,1"], "time [s],mark,finger1 [V]", "holds no trial"),
        (["0,preload 1,5", "1,trial 1,2"], "time [s],mark,finger1 [V]", "channel finger1: is saturated throughout"),
        ([], "time [s],finger1 [V]", "holds no rows"),
    ],
)
def test_a_bad_recording_is_named_with_line_or_channel(rows: list[str], header: str, said: str, tmp_path: Path) -> None:
    path = recording(tmp_path / "r.csv", rows, header)
    with pytest.raises(InputError, match=said) as caught:
        read_forces(path, CALIBRATION)
    assert str(path) in str(caught.value)


def test_voltages_without_a_calibration_and_channels_without_a_curve(tmp_path: Path) -> None:
    path = recording(tmp_path / "r.csv")
    with pytest.raises(InputError, match="a calibration is needed"):
        read_forces(path)
    only = Calibration(divider=Divider(), curves={"finger1": CALIBRATION.curves["all"]})
    with pytest.raises(InputError, match="channel finger2"):
        read_forces(path, only)


def test_sides_of_the_board() -> None:
    assert [side(name) for name in ("finger1", "Thumb_2", "middle", "little")] == [1, -1, 1, 1]
    assert hand_force(SIX, np.array([1.0, 2.0, 3.0, 4.0, 0.5, 0.25])) == pytest.approx(9.25)


def test_the_command_writes_newtons_and_says_what_is_doubtful(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, calibration, out = recording(tmp_path / "r.csv"), tmp_path / "cal.toml", tmp_path / "forces.csv"
    save_calibration(CALIBRATION, calibration)
    before = path.read_bytes()
    assert main(["forces", str(path), "--calibration", str(calibration), "--out", str(out)]) == 0
    said = capsys.readouterr().out
    assert "Trial 1: 0.62 s, hand 8.00 N on average, at most 10.00 N at 1.62 s" in said
    assert "saturated: finger1 in 1 of 4 samples" in said
    assert path.read_bytes() == before
    assert len(read_forces(out)) == 2
    assert main(["forces", str(path)]) == 2
    assert "a calibration is needed" in capsys.readouterr().err
    assert main(["forces", str(path), "--calibration", str(calibration), "--unloaded", "-1"]) == 2
