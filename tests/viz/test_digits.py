"""Fingers that close on a box: against coal's distance between capsules and boxes, and by hand."""

from __future__ import annotations

import coal
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from liftopt.multibody.person.subject import Subject
from liftopt.viz.digits import Digit, closed_on, distance_to_box
from liftopt.viz.scene_gripper import gripper_digits
from liftopt.viz.scene_hand import LEFT, RIGHT, hand_digits

HALF = np.array([0.20, 0.15, 0.02])
DEEPEST = 2e-3  # [m]: a bone is looked at in four places, and tapers where coal's capsule does not
DIGITS = (*hand_digits(Subject(1.75, 75.0, "male"), RIGHT), *gripper_digits(0.15))


def _placements(count: int) -> np.ndarray:
    """Return palms that come from all sides of the box's edge x < 0."""
    random = np.random.default_rng(7)
    placements = np.tile(np.eye(4), (count, 1, 1))
    placements[:, :3, :3] = Rotation.from_quat(random.standard_normal((count, 4))).as_matrix()
    placements[:, :3, 3] = random.uniform([-0.34, -0.1, -0.12], [-0.22, 0.1, 0.12], (count, 3))
    return placements


def _coal_distance(start: np.ndarray, end: np.ndarray, radius: float) -> float:
    along = end - start
    length = float(np.linalg.norm(along))
    turn = Rotation.align_vectors((along / length)[None], [[0.0, 0.0, 1.0]])[0].as_matrix()
    capsule, box = coal.Capsule(radius, length), coal.Box(*(2 * HALF))
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    at = coal.Transform3s(turn, (start + end) / 2)
    return float(coal.distance(capsule, at, box, coal.Transform3s(), request, result))


def _bones(digit: Digit, angles: np.ndarray, placement: np.ndarray) -> list[tuple[np.ndarray, np.ndarray, float]]:
    points = digit.points(angles) @ placement[:3, :3].T + placement[:3, 3]
    thin = [min(pair) for pair in zip(digit.radii[:-1], digit.radii[1:], strict=True)]
    return list(zip(points[:-1], points[1:], thin, strict=True))


@pytest.mark.parametrize("digit", DIGITS, ids=lambda digit: digit.name)
def test_no_bone_is_in_the_box_that_can_be_outside(digit: Digit) -> None:
    """Of palms outside the box, wherever the open digit is free: coal finds no bone deeper than a millimetre or two."""
    placements = _placements(60)
    angles = closed_on(digit, placements, HALF)
    free = 0
    for row, placement in zip(angles, placements, strict=True):
        opened = np.array([digit.opened[0], *np.zeros(len(digit.bones) - 1)])
        if min(_coal_distance(*bone) for bone in _bones(digit, opened, placement)) < 0.0:
            continue
        free += 1
        assert min(_coal_distance(*bone) for bone in _bones(digit, row, placement)) > -DEEPEST
    assert free > 20


def test_a_straight_finger_lies_down_at_the_angle_that_trigonometry_says() -> None:
    """One bone of 0.1 m, thin, hinged 0.05 m below the box's underside: its end touches at asin(0.05 / 0.1)."""
    digit = Digit(
        "one", np.zeros(3), np.array([1.0, 0.0, 0.0]), np.array([0.0, -1.0, 0.0]), (0.1,), (0.0, 0.0), (0.0,), (1.5,)
    )
    placement = np.eye(4)[None].copy()
    placement[0, :3, 3] = -0.1, 0.0, -HALF[2] - 0.05
    assert closed_on(digit, placement, HALF)[0, 0] == pytest.approx(np.arcsin(0.5), abs=2e-3)
    placement[0, 2, 3] = -1.0  # nothing there
    assert closed_on(digit, placement, HALF)[0, 0] == 1.5


def test_bones_are_as_long_as_they_are_whatever_the_angles() -> None:
    for digit in DIGITS:
        angles = np.random.default_rng(1).uniform(-1.0, 1.0, (5, len(digit.bones)))
        lengths = np.linalg.norm(np.diff(digit.points(angles), axis=1), axis=2)
        np.testing.assert_allclose(lengths, np.tile(digit.bones, (5, 1)), atol=1e-12)
        frames = digit.frames(angles)
        ends = frames[..., :3, 3] + frames[..., :3, 0] * np.array(digit.bones)[:, None]
        np.testing.assert_allclose(ends, digit.points(angles)[:, 1:], atol=1e-12)
        np.testing.assert_allclose(np.linalg.det(frames), 1.0, atol=1e-12)


def test_a_left_hand_is_the_mirror_image_of_a_right_one() -> None:
    subject = Subject(1.6, 60.0, "female")
    angles = np.array([[0.3, 0.4, 0.2]])
    for left, right in zip(hand_digits(subject, LEFT), hand_digits(subject, RIGHT), strict=True):
        np.testing.assert_allclose(left.points(angles), right.points(angles) * [1.0, -1.0, 1.0], atol=1e-12)


def test_the_distance_to_a_box_is_coals() -> None:
    points = np.random.default_rng(3).uniform(-0.4, 0.4, (50, 3))
    for point in points:
        radius = 1e-6
        ball, box = coal.Sphere(radius), coal.Box(*(2 * HALF))
        expected = coal.distance(
            ball,
            coal.Transform3s(np.eye(3), point),
            box,
            coal.Transform3s(),
            coal.DistanceRequest(),
            coal.DistanceResult(),
        )
        assert distance_to_box(point, HALF) == pytest.approx(expected + radius, abs=1e-6)
