"""How hands lie on what they hold; oracle: anatomy in words, for someone who faces +X, and the mirror."""

from __future__ import annotations

import numpy as np
import pytest

from liftopt.multibody.edges import HOLDS, Hold
from liftopt.multibody.person.holds import hand_on

AHEAD, LEFT, UP = np.eye(3)


def directions(hold: Hold, hand: str) -> dict[str, np.ndarray]:
    """Return where fingers, thumb and palm look, from the axes of the grasp frame as the hand's own."""
    frame = hand_on(hold, "right" if hand == "right" else "left")
    return {"fingers": -frame[:, 0], "thumb": frame[:, 1], "palm": frame[:, 2] * (1.0 if hand == "right" else -1.0)}


@pytest.mark.parametrize("hold", HOLDS)
def test_frames_are_rotations_and_the_left_hand_is_the_right_ones_mirror_image(hold: Hold) -> None:
    for hand in ("right", "left"):
        frame = hand_on(hold, hand)  # type: ignore[arg-type]
        np.testing.assert_allclose(frame.T @ frame, np.eye(3), atol=1e-15)
        assert np.linalg.det(frame) == pytest.approx(1.0, abs=1e-15)
    right, left = directions(hold, "right"), directions(hold, "left")
    for part, way in right.items():
        np.testing.assert_allclose(left[part], way * (1.0, -1.0, 1.0), atol=1e-15)


@pytest.mark.parametrize(("hand", "outside"), [("right", -LEFT), ("left", LEFT)])
def test_hands_hold_as_people_do(hand: str, outside: np.ndarray) -> None:
    for hold in ("edge", "bottom"):  # palm up, fingers ahead, thumb outside
        found = directions(hold, hand)  # type: ignore[arg-type]
        np.testing.assert_array_equal([found["palm"], found["fingers"], found["thumb"]], [UP, AHEAD, outside])
    corner = directions("corner", hand)
    np.testing.assert_array_equal(corner["palm"], UP)
    assert corner["fingers"] @ AHEAD == pytest.approx(corner["fingers"] @ -outside)
    assert corner["fingers"] @ AHEAD > 0.0
    side = directions("side", hand)
    np.testing.assert_array_equal(side["palm"], -outside)
    assert side["fingers"] @ AHEAD == pytest.approx(side["fingers"] @ -UP)
    assert side["thumb"] @ UP > 0.0
    handle = directions("handle", hand)  # the bar of the handle, along X, lies across the palm
    np.testing.assert_array_equal([handle["palm"], handle["fingers"], handle["thumb"]], [-outside, -UP, AHEAD])
