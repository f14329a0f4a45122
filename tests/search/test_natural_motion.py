"""Natural lifts are motions that people make; oracle: bands for wrist, trunk, hand path, squeeze and tilt."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from liftopt.ergonomics.motion import motion_of
from liftopt.solution.grasp_loads import squeeze
from liftopt.solution.interpolation import between_knots

LIFTS = {
    "table5": (),
    "table5_near": (),
    "table5_free": (),
    "heavy": ("object.mass=10",),
    "fast": ("duration=1",),
    "slow": ("duration=4",),
}


@pytest.mark.parametrize("lift", LIFTS)
def test_a_natural_lift_is_one_that_people_make(solved: Callable[..., Any], lift: str) -> None:
    name = lift if lift.startswith("table5") else "table5"
    solution = solved(name, "objective.preset=natural", *LIFTS[lift]).solution
    assert solution.solved, solution.status
    fine = between_knots(solution)
    motion, weight = motion_of(fine, fine.persons[0]), 9.81 * fine.scenario.object.mass
    assert motion.wrist_bend.max() < 40.0
    assert np.abs(motion.twist).max() < 25.0
    assert motion.abduction.max() < 70.0
    assert motion.path_over_chord < 1.2
    assert motion.speed_peaks == 1
    assert np.abs(squeeze(fine.agents)).max() < 10.0 + 0.25 * weight
    assert np.degrees(np.abs(fine.object.pose[:, 3:5]).max()) < 5.0
