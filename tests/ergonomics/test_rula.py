"""RULA against worksheets filled in by hand, and its tables against what every table of risk must do: not fall."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from liftopt.ergonomics.posture import Posture
from liftopt.ergonomics.rula import ACTION, Rula, rula
from liftopt.ergonomics.rula_tables import TABLE_A, TABLE_B, TABLE_C


@pytest.fixture
def score(one_armed: Callable[..., Posture]) -> Callable[..., Rula]:
    """Return a function that scores one posture with the right arm."""

    def scores(**values: float) -> Rula:
        (found,) = rula(one_armed(**values))
        return found

    return scores


def test_best_posture_scores_one(score: Callable[..., Rula]) -> None:
    assert score().grand[0] == 1
    assert set(score().at(0).values()) == {0, 1}  # no force, every part at its best


def test_worksheet_of_a_reach_with_a_turned_trunk(score: Callable[..., Rula]) -> None:
    # By hand: upper arm 30 deg (2) and abducted (3); elbow 50 (2); wrist 20 deg (3) and bent aside (4); twist 1:
    # Table A gives 5, force of 5 kg adds 1: 6. Trunk 30 deg (3) and turned (4), neck 1, legs 1: Table B gives 5, with
    # force 6. Table C, row 6, column 6: 7.
    scores = score(
        upper_arm_flexion=30, upper_arm_out=25, elbow_flexion=50, wrist_flexion=20, wrist_deviation=10,
        trunk_inclination=30, trunk_turn=15, hand_load=5,
    )  # fmt: skip
    assert scores.at(0) == {
        "upper_arm": 3, "lower_arm": 2, "wrist": 4, "wrist_twist": 1, "neck": 1, "trunk": 4, "legs": 1, "force": 1,
        "arm_with_force": 6, "body_with_force": 6, "grand": 7,
    }  # fmt: skip


def test_worksheet_of_light_bench_work(score: Callable[..., Rula]) -> None:
    # By hand: upper arm 30 deg (2), elbow 90 (1), wrist 10 deg (2), twist at its end (2): Table A 3. Trunk 10 deg (2),
    # neck 1, legs 1: Table B 2. No force. Table C, row 3, column 2: 3.
    scores = score(upper_arm_flexion=30, elbow_flexion=90, wrist_flexion=10, pronation=70, trunk_inclination=10)
    assert (scores.arm_with_force[0], scores.body_with_force[0], scores.grand[0]) == (3, 2, 3)


@pytest.mark.parametrize(
    ("part", "entry", "bands"),
    [
        ("upper_arm", "upper_arm_flexion", {-60: 2, -20: 1, 0: 1, 20: 1, 21: 2, 45: 2, 46: 3, 90: 3, 91: 4}),
        ("lower_arm", "elbow_flexion", {0: 2, 59: 2, 60: 1, 100: 1, 101: 2}),
        ("wrist", "wrist_flexion", {-16: 3, -15: 2, -5: 1, 0: 1, 5: 1, 6: 2, 15: 2, 16: 3}),
        ("wrist", "wrist_deviation", {-6: 2, 0: 1, 6: 2}),
        ("wrist_twist", "pronation", {-46: 2, -45: 1, 0: 1, 45: 1, 46: 2}),
        ("trunk", "trunk_inclination", {-6: 2, 0: 1, 5: 1, 20: 2, 21: 3, 60: 3, 61: 4}),
        ("trunk", "trunk_turn", {-11: 2, 0: 1, 11: 2}),
        ("trunk", "trunk_bend", {-11: 2, 0: 1, 11: 2}),
        ("lower_arm", "wrist_across", {-0.2: 1, 0.01: 2}),
        ("lower_arm", "wrist_outside", {0.04: 1, 0.06: 2}),
        ("legs", "heavier_foot", {0.5: 1, 0.66: 1, 0.67: 2, 1.0: 2}),
        ("force", "hand_load", {0: 0, 1.9: 0, 2: 1, 10: 1, 10.1: 2}),
    ],
)
def test_bands_of_the_method(score: Callable[..., Rula], part: str, entry: str, bands: dict[float, int]) -> None:
    assert {value: getattr(score(**{entry: value}), part)[0] for value in bands} == bands


@pytest.mark.parametrize("table", [TABLE_A, TABLE_B, TABLE_C], ids="ABC")
def test_a_worse_part_never_scores_better(table: np.ndarray) -> None:
    for axis in range(table.ndim):
        assert (np.diff(table, axis=axis) >= 0).all()


def test_tables_begin_at_one_and_cover_everyscore(score: Callable[..., Rula]) -> None:
    assert [table.flat[0] for table in (TABLE_A, TABLE_B, TABLE_C)] == [1, 1, 1]
    assert (TABLE_A.max(), TABLE_B.max(), TABLE_C.max()) == (9, 9, 7)
    worst = score(
        upper_arm_flexion=120, upper_arm_out=60, elbow_flexion=20, wrist_across=0.1, wrist_flexion=60,
        wrist_deviation=20, pronation=80, trunk_inclination=80, trunk_turn=40, trunk_bend=30, hand_load=30,
    )  # fmt: skip
    assert worst.grand[0] == 7
    assert set(ACTION) == set(range(1, 8))
