"""How people lifted: one by the height of the wrist, as means and deviations over five lifts, and seven from the floor.

One person, two hands on a box, an inertial suit; five lifts from 0.5 m to 1.1, 1.2, 1.2, 1.4 and 1.7 m. It is a trend
and no norm: one person, one box, few lifts, the fewer the higher. Published or larger data take precedence.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from liftopt.ergonomics.posture import Posture
from liftopt.multibody.sources import Source
from liftopt.types import Array

# Mean and measures of AnyBody's recordings were computed from their joint angles and rounded to degrees; the recordings
# themselves are not part of liftopt.
SOURCE = Source(
    "AnyBody Managed Model Repository, MocapExamples, BVH_BoxLift: five lifts of one person, means and standard "
    "deviations over the lifts by wrist height",
    "computed",
)
WIDTH = 1.0  # standard deviations on each side that a band is wide
SMALLEST = 5.0  # [deg]: least half width of a band, about what such angles can be measured to


@dataclass(frozen=True)
class RecordedAngle:
    """One angle at the heights of ``HEIGHTS``; arrays (H,).

    Attributes:
        meaning: what it is and how it is counted.
        mean, deviation: over the lifts that reached the height [deg]; the sample's standard deviation.
    """

    meaning: str
    mean: Array
    deviation: Array

    def band(self) -> tuple[Array, Array]:
        """Return lower and upper edge (H,) of the band around the mean [deg]."""
        half = np.maximum(WIDTH * self.deviation, SMALLEST)
        return self.mean - half, self.mean + half


HEIGHTS: Array = np.array([0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.3, 1.4])  # of the wrist above the floor [m]
LIFTS: tuple[int, ...] = (5, 5, 5, 5, 5, 4, 3, 2, 2)  # that reached each height


def _angle(meaning: str, mean: tuple[int, ...], deviation: tuple[int, ...]) -> RecordedAngle:
    return RecordedAngle(meaning, np.array(mean, dtype=float), np.array(deviation, dtype=float))


RECORDED: Mapping[str, RecordedAngle] = MappingProxyType(
    {
        "elbow": _angle(
            "elbow flexion: the angle between upper arm and forearm, 0 where the arm is straight",
            (34, 44, 53, 61, 69, 82, 93, 107, 105),
            (9, 12, 15, 17, 17, 11, 13, 4, 13),
        ),
        "humeral_elevation": _angle(
            "humeral elevation: the angle of the upper arm from the trunk's downward axis",
            (56, 45, 38, 35, 35, 38, 38, 42, 51),
            (3, 10, 11, 7, 3, 5, 2, 3, 3),
        ),
        "wrist_extension": _angle(
            "wrist extension: towards the back of the hand, 0 where hand and forearm are in line",
            (3, 5, 6, 7, 8, 10, 14, 18, 21),
            (2, 3, 3, 2, 2, 1, 3, 4, 3),
        ),
        "twist": _angle(
            "trunk twist: of the shoulders against the pelvis about the trunk's axis, with the recording's sign",
            (-3, -2, -1, -1, -3, -5, -1, 4, 6),
            (5, 3, 1, 3, 6, 9, 5, 4, 5),
        ),
    }
)

# Seven men who squatted to lift from the floor with both hands, as means of the published curves [deg].
SQUAT_SOURCE = Source("recorded means of seven men in squat lifts from the floor, as handed down", "unverified")
KNEE_START, KNEE_END = 120.0, 25.0
TRUNK_BAND, ELBOW_BAND = (20.0, 45.0), (30.0, 65.0)  # that trunk inclination and elbow flexion stayed in


def off_recorded_squat(posture: Posture) -> dict[str, float]:
    """Return how far a lift is off that of the seven men, by angle; more bent is positive [deg].

    Knees are compared at the start and at the end, trunk and elbows by how far they leave the band at most.
    """
    elbow = np.stack([arm.elbow_flexion for arm in posture.arms])
    return {
        "knees at the start": float(posture.knee[0]) - KNEE_START,
        "knees at the end": float(posture.knee[-1]) - KNEE_END,
        "trunk": _outside(posture.trunk_inclination, TRUNK_BAND),
        "elbows": _outside(elbow, ELBOW_BAND),
    }


def _outside(values: Array, band: tuple[float, float]) -> float:
    """Return by how much values leave a band at most: above it positive, below it negative."""
    above, below = float(values.max()) - band[1], band[0] - float(values.min())
    if max(above, below) <= 0.0:
        return 0.0
    return above if above >= below else -below
