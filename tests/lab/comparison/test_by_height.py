"""Angles by wrist height; oracles: curves made by hand, and recorded lifts where they are at hand."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from liftopt.ergonomics.motion import Motion, motion_of
from liftopt.errors import InputError
from liftopt.lab.comparison.by_height import at_heights, read_height_curves, rmse_by_height
from liftopt.solution.interpolation import between_knots

RECORDED = Path(__file__).parents[4] / "shared" / "data" / "recorded_lifts" / "ammr_by_height.csv"
TABLE = """trial,quantity,0.9m,1.0m,1.1m,1.5m
A,elbow_flex_3d,50,60,70,nan
B,elbow_flex_3d,54,64,nan,nan
A,twist,0,0,0,nan
B,twist,0,0,nan,nan
"""


def motion(height: Any, elbow: Any) -> Motion:
    """Return a motion in which only wrist and elbow move."""
    zero = np.zeros(len(height))
    return Motion(np.asarray(elbow, float), *[zero] * 6, np.asarray(height, float), 1.0, 1, zero, None)


def test_the_mean_is_of_the_trials_that_passed(tmp_path: Path) -> None:
    (tmp_path / "curves.csv").write_text(TABLE)
    curves = read_height_curves(tmp_path / "curves.csv")
    np.testing.assert_allclose(curves.height, [0.9, 1.0, 1.1, 1.5])
    np.testing.assert_allclose(curves.mean("elbow_flex_3d"), [52.0, 62.0, 70.0, np.nan])


def test_angles_where_the_wrist_first_passes() -> None:
    """Up from 0.95 to 1.15 m and down again, with another elbow."""
    found = at_heights(motion([0.95, 1.05, 1.15, 0.95], [40.0, 60.0, 90.0, 10.0]), np.array([0.9, 1.0, 1.1]))
    np.testing.assert_allclose(found["elbow_flex_3d"], [np.nan, 50.0, 75.0])


def test_difference_over_the_heights_of_both(tmp_path: Path) -> None:
    """2 deg off at 1.0 m and 1 deg at 1.1 m; 1.5 m has no record and 0.9 m no prediction."""
    (tmp_path / "curves.csv").write_text(TABLE)
    off = rmse_by_height(motion([0.95, 1.05, 1.15], [62.0, 66.0, 76.0]), read_height_curves(tmp_path / "curves.csv"))
    assert off["elbow_flex_3d"] == pytest.approx(np.sqrt((2.0**2 + 1.0**2) / 2))
    assert off["twist"] == 0.0


def test_those_with_legs_have_knees_too() -> None:
    """Knees straighten from 80 to 20 deg and the trunk from 40 to 10 as the wrist rises from 0.5 to 1.0 m."""
    rising = motion([0.5, 1.0], [30.0, 30.0])
    legs = replace(rising, knee=np.array([80.0, 20.0]), trunk_inclination=np.array([40.0, 10.0]))
    found = at_heights(legs, np.array([0.5, 0.75]))
    np.testing.assert_allclose(found["knee_flex"], [80.0, 50.0])
    np.testing.assert_allclose(found["trunk_incl"], [40.0, 25.0])
    assert "knee_flex" not in at_heights(rising, np.array([0.75]))


def test_another_table_is_refused(tmp_path: Path) -> None:
    (tmp_path / "curves.csv").write_text("time,force\n0.0,1.0\n")
    with pytest.raises(InputError, match=r"curves\.csv"):
        read_height_curves(tmp_path / "curves.csv")


@pytest.mark.skipif(not RECORDED.exists(), reason="no recorded lifts")
@pytest.mark.parametrize("name", ["table5", "table5_near", "table5_free"])
def test_natural_lifts_are_near_recorded_ones(solved: Callable[..., Any], name: str) -> None:
    """One person's five lifts. The paper's weights are 80 deg off at the elbow and 37 deg in the turn of the trunk."""
    fine = between_knots(solved(name, "objective.preset=natural").solution)
    off = rmse_by_height(motion_of(fine, fine.persons[0]), read_height_curves(RECORDED))
    assert off["elbow_flex_3d"] < 13.0
    assert max(off["wrist_flex"], off["twist"]) < 12.0
    assert off["shoulder_elev_3d"] < 14.0
