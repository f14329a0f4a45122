"""How far a lift is off recorded ones: postures whose distance is worked by hand."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from liftopt.ergonomics.posture import Posture
from liftopt.ergonomics.recorded_lifts import off_recorded_squat


def test_distance_from_the_recorded_squat_lift(one_armed: Callable[..., Posture]) -> None:
    one = one_armed(elbow_flexion=50.0)
    lift = replace(one, knee=np.array([110.0, 70.0, 31.0]), trunk_inclination=np.array([30.0, 52.0, 20.0]))
    assert off_recorded_squat(lift) == pytest.approx(
        {"knees at the start": -10.0, "knees at the end": 6.0, "trunk": 7.0, "elbows": 0.0}
    )
    upright = replace(lift, trunk_inclination=np.array([44.0, 30.0, 5.0]))
    assert off_recorded_squat(upright)["trunk"] == pytest.approx(-15.0)
