"""REBA against worksheets filled in by hand, and its tables against what every table of risk must do: not fall."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from liftopt.ergonomics.coupling import Coupling
from liftopt.ergonomics.posture import Posture
from liftopt.ergonomics.reba import Reba, reba, reba_action
from liftopt.ergonomics.reba_tables import TABLE_A, TABLE_B, TABLE_C
from liftopt.ergonomics.scores import worse_side

OneArmed = Callable[..., Posture]


@pytest.fixture
def score(one_armed: OneArmed) -> Callable[..., Reba]:
    """Return a function that scores one posture with the right arm."""

    def scores(coupling: Coupling = "good", **values: float) -> Reba:
        (found,) = reba(one_armed(**values), coupling)
        return found

    return scores


def test_best_posture_scores_one(score: Callable[..., Reba]) -> None:
    assert score().grand[0] == 1
    assert set(score().at(0).values()) == {0, 1}


def test_worksheet_of_a_box_lifted_from_a_pallet(score: Callable[..., Reba]) -> None:
    # By hand: trunk 70 deg (4) and turned (5); knees 45 deg: legs 1 + 1; neck 1: Table A gives 6, 12 kg add 2: 8. Upper
    # arm 60 deg (3), elbow 20 deg (2), wrist 10 deg (1) and bent aside (2): Table B gives 5, poor coupling adds 2: 7.
    # Table C, row 8, column 7: 10.
    found = score("poor", trunk_inclination=70, trunk_turn=15, knee=45, upper_arm_flexion=60, elbow_flexion=20,
                  wrist_flexion=10, wrist_deviation=8, load=12)  # fmt: skip
    assert found.at(0) == {
        "trunk": 5, "neck": 1, "legs": 2, "load": 2, "upper_arm": 3, "lower_arm": 2, "wrist": 2, "coupling": 2,
        "body_with_load": 8, "arm_with_coupling": 7, "grand": 10,
    }  # fmt: skip
    assert reba_action(10) == "high risk, change soon"


def test_worksheet_of_a_deep_squat(score: Callable[..., Reba]) -> None:
    # By hand: trunk 30 deg (3), knees 110 deg: legs 1 + 2, neck 1: Table A 5; 6 kg add 1: 6. Arm at its best with a
    # fair coupling: Table B 1 + 1 = 2. Table C, row 6, column 2: 6.
    found = score("fair", trunk_inclination=30, knee=110, load=6)
    assert (found.body_with_load[0], found.arm_with_coupling[0], found.grand[0]) == (6, 2, 6)


@pytest.mark.parametrize(
    ("part", "entry", "bands"),
    [
        ("trunk", "trunk_inclination", {-21: 3, -20: 2, -6: 2, 0: 1, 5: 1, 20: 2, 21: 3, 60: 3, 61: 4}),
        ("trunk", "trunk_turn", {-11: 2, 0: 1, 11: 2}),
        ("trunk", "trunk_bend", {-11: 2, 0: 1, 11: 2}),
        ("legs", "knee", {0: 1, 29: 1, 30: 2, 60: 2, 61: 3, 130: 3}),
        ("load", "load", {0: 0, 4.9: 0, 5: 1, 10: 1, 10.1: 2}),
        ("upper_arm", "upper_arm_flexion", {-21: 2, -20: 1, 20: 1, 21: 2, 45: 2, 46: 3, 90: 3, 91: 4}),
        ("upper_arm", "upper_arm_out", {20: 1, 21: 2}),
        ("lower_arm", "elbow_flexion", {0: 2, 59: 2, 60: 1, 100: 1, 101: 2}),
        ("wrist", "wrist_flexion", {-16: 2, -15: 1, 0: 1, 15: 1, 16: 2}),
        ("wrist", "wrist_deviation", {-6: 2, 0: 1, 6: 2}),
    ],
)
def test_bands_of_the_method(score: Callable[..., Reba], part: str, entry: str, bands: dict[float, int]) -> None:
    assert {value: getattr(score(**{entry: value}), part)[0] for value in bands} == bands


@pytest.mark.parametrize("table", [TABLE_A, TABLE_B, TABLE_C], ids="ABC")
def test_a_worse_part_never_scores_better(table: np.ndarray) -> None:
    for axis in range(table.ndim):
        assert (np.diff(table, axis=axis) >= 0).all()


def test_tables_are_as_large_as_their_scores() -> None:
    assert (TABLE_A.shape, TABLE_B.shape, TABLE_C.shape) == ((3, 5, 4), (6, 2, 3), (12, 12))
    assert (TABLE_A.max(), TABLE_B.max(), TABLE_C.max()) == (9, 9, 12)


def test_each_side_is_scored_and_the_worse_one_told(one_armed: OneArmed) -> None:
    posture = one_armed()
    left = replace(posture.arms[0], side="left", upper_arm_flexion=np.array([100.0]))
    both = reba(replace(posture, arms=(*posture.arms, left)), "good")
    assert [(each.side, each.upper_arm[0]) for each in both] == [("right", 1), ("left", 4)]
    assert worse_side(both).side == "left"
    assert worse_side(both[::-1]).side == "left"
    assert worse_side([both[0], replace(both[0], side="left")]).side == "right"  # the first where they are equal
