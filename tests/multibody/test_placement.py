"""Where agents stand: oracle is the rotation about Z by hand."""

from __future__ import annotations

import numpy as np
import pytest

from liftopt.multibody.placement import Placement, facing


@pytest.mark.parametrize(
    ("yaw_deg", "ahead"), [(0.0, [1, 0, 0]), (90.0, [0, 1, 0]), (180.0, [-1, 0, 0]), (30.0, [np.sqrt(0.75), 0.5, 0])]
)
def test_it_faces_along_the_turned_x(yaw_deg: float, ahead: list[float]) -> None:
    place = Placement.at(1.5, -0.2, yaw_deg)
    np.testing.assert_allclose(place.ahead, ahead, atol=1e-15)
    np.testing.assert_allclose(place.T_world_base[:3, :3] @ [1.0, 0.0, 0.0], ahead, atol=1e-15)
    np.testing.assert_allclose(place.T_world_base[:3, 3], [1.5, -0.2, 0.0])


def test_who_faces_a_person_at_the_origin_looks_back_exactly() -> None:
    np.testing.assert_array_equal(facing(1.9).ahead, [-1.0, 0.0, 0.0])
