"""The hand's force from a file: units, overlap and size; the forces are those that were written."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from liftopt.errors import InputError
from liftopt.lab.mocap.from_markers import recorded_lift
from liftopt.lab.mocap.hand_force import HandForce, read_hand_force
from liftopt.lab.mocap.loads import Load

TIME = np.arange(200) / 100.0
LIFT = 30.0 * np.sin(np.pi * TIME / 2.0)


def _read(folder: Path, header: str, time: np.ndarray, force: np.ndarray) -> HandForce:
    path = folder / "force.csv"
    rows = [header, *(f"{t:.6f},0,0,{f:.6f}" for t, f in zip(time, force, strict=True))]
    path.write_text("\n".join(rows) + "\n")
    return read_hand_force(path, "Z")


@pytest.mark.parametrize(
    ("header", "time", "force"),
    [
        ("time,fx,fy,fz", 1.0, 1.0),
        ("time [s],fx [N],fy [N],fz [N]", 1.0, 1.0),
        ("Time (ms),Fx (kN),Fy (kN),Fz (kN)", 1000.0, 1e-3),
    ],
)
def test_units_behind_the_names_are_read(tmp_path: Path, header: str, time: float, force: float) -> None:
    found, outside = _read(tmp_path, header, time * TIME, force * LIFT).at(TIME)
    np.testing.assert_allclose(found[:, 2], LIFT, atol=1e-3)
    assert outside == 0


def test_counts_are_no_newtons(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"3e\+07 N.*at most 3000 N.*newtons"):
        _read(tmp_path, "time,fx,fy,fz", TIME, 1e6 * LIFT)


def test_a_number_that_stands_for_no_value_is_no_force(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"9999 N.*at most 3000 N"):
        _read(tmp_path, "time,fx,fy,fz", TIME, np.where(np.arange(200) == 90, -9999.0, LIFT))


def test_kilonewtons_taken_for_newtons_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"0\.03 N.*largest force.*fx \[kN\]"):
        _read(tmp_path, "time,fx,fy,fz", TIME, 1e-3 * LIFT)
    assert not _read(tmp_path, "time,fx,fy,fz", TIME, 0.0 * LIFT).force.any()


def test_a_hole_in_the_series_is_refused_where_the_force_changes(tmp_path: Path) -> None:
    kept = (TIME < 0.3) | (TIME > 0.9)
    with pytest.raises(InputError, match=r"no force from 0\.29 to 0\.91 s, while it changes by 16\.\d N"):
        _read(tmp_path, "time,fx,fy,fz", TIME[kept], LIFT[kept]).at(TIME)
    found, outside = _read(tmp_path, "time,fx,fy,fz", TIME[kept], np.full(kept.sum(), 20.0)).at(TIME)
    np.testing.assert_allclose(found[:, 2], 20.0)
    assert outside == 0


def test_milliseconds_taken_for_seconds_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"10 s.*too long to follow a lift.*time \[ms\]"):
        _read(tmp_path, "time,fx,fy,fz", 1000.0 * TIME, LIFT).at(TIME)


def test_a_series_of_another_time_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no force at any time.*100 to 101\.99 s.*0 to 1\.99 s.*--hand-force-start"):
        _read(tmp_path, "time,fx,fy,fz", 100.0 + TIME, LIFT).at(TIME)


def test_a_unit_that_is_none_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"fx \[lbf\].*must be N or kN"):
        _read(tmp_path, "time,fx [lbf],fy,fz", TIME, LIFT)


@pytest.mark.parametrize(("shift", "fits"), [(0.0, True), (0.4, True), (1.0, False), (-1.0, False)])
def test_a_series_of_a_part_of_the_lift_is_refused(truth: Any, shift: float, fits: bool) -> None:
    """The box is away from its place from 0.44 to 1.55 s; half of that without a force is no lift."""
    series = HandForce("grip.csv", TIME + shift, np.stack([0.0 * LIFT, 0.0 * LIFT, LIFT], axis=1))
    if fits:
        lift = recorded_lift(truth.recording, truth.mapping, Load(measured=series))
        turned = np.interp(lift.time, series.time, LIFT, left=0.0, right=0.0)
        np.testing.assert_allclose(lift.hand_force[:, 2], turned, atol=0.1)
        return
    with pytest.raises(InputError, match=r"grip\.csv.*does not hold the lift.*0\.44 to 1\.55 s.*--hand-force-start"):
        recorded_lift(truth.recording, truth.mapping, Load(measured=series))
