"""Squat, stoop or between: how a person with legs stands at one moment of a lift."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from liftopt.ergonomics.posture import Posture
from liftopt.multibody.sources import Source

Style = Literal["upright", "a squat", "a semi-squat", "a stoop"]

SOURCE = Source(
    "postural index of Burgess-Limerick & Abernethy (1997), Hum Factors 39:141-148: knee flexion over the sum of "
    "ankle, hip and lumbar flexion, near 0 in a stoop and near 1 in a full squat; the thirds are a choice of ours",
    "secondary",
)
STOOP, SQUAT = 1.0 / 3.0, 2.0 / 3.0  # index up to which it is a stoop, and from which it is a squat
DEEP = 60.0  # [deg] of knee flexion from which it can be a squat
STRAIGHT, ERECT = 30.0, 20.0  # [deg] of knee flexion and trunk inclination; less of both is upright


@dataclass(frozen=True)
class LiftingStyle:
    """How a person stands at one moment.

    Attributes:
        style: in a word.
        index: knee flexion over the sum of ankle, hip and trunk flexion; 0 where that sum is none.
        knee, hip, inclination: flexion of knees and hips, and the trunk against the vertical [deg].
    """

    style: Style
    index: float
    knee: float
    hip: float
    inclination: float


def lifting_style(posture: Posture, k: int) -> LiftingStyle:
    """Return how a person stands at time ``k``."""
    knee, hip, inclination = (float(each[k]) for each in (posture.knee, posture.hip, posture.trunk_inclination))
    others = hip + float(posture.ankle[k]) + float(posture.trunk_flexion[k])
    index = knee / others if others > 0.0 else 0.0
    style: Style = "a stoop" if index < STOOP else "a squat" if index >= SQUAT and knee >= DEEP else "a semi-squat"
    if knee < STRAIGHT and abs(inclination) < ERECT:
        style = "upright"
    return LiftingStyle(style, index, knee, hip, inclination)
