"""Squat, stoop or between: postures whose index is worked by hand."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from liftopt.ergonomics.lifting_style import lifting_style
from liftopt.ergonomics.posture import Posture


# Ankle, knee, hip, trunk against pelvis, trunk against the vertical [deg].
@pytest.mark.parametrize(
    ("angles", "style", "index"),
    [
        ((30.0, 120.0, 95.0, 15.0, 35.0), "a squat", 120 / 140),
        ((0.0, 10.0, 60.0, 40.0, 90.0), "a stoop", 0.1),
        ((20.0, 60.0, 80.0, 20.0, 60.0), "a semi-squat", 0.5),
        ((15.0, 45.0, 40.0, 5.0, 21.0), "a semi-squat", 0.75),  # the knees are hardly bent
        ((3.0, 5.0, 2.0, 0.0, 0.0), "upright", 1.0),
        ((0.0, 0.0, 0.0, 0.0, 0.0), "upright", 0.0),
        ((0.0, 0.0, 0.0, 45.0, 45.0), "a stoop", 0.0),
    ],
)
def test_postural_index(one_armed: Callable[..., Posture], angles: tuple[float, ...], style: str, index: float) -> None:
    ankle, knee, hip, flexion, inclination = angles
    posture = one_armed(ankle=ankle, knee=knee, hip=hip, trunk_flexion=flexion, trunk_inclination=inclination)
    found = lifting_style(posture, 0)
    assert (found.style, found.index) == (style, pytest.approx(index))
    assert (found.knee, found.hip, found.inclination) == (knee, hip, inclination)
