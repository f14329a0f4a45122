"""Measures of a motion; oracles: postures whose angles are known by hand, and paths of closed form."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from liftopt.ergonomics.motion import Motion, motion_of
from liftopt.solution.solution import Solution


@pytest.fixture
def moved(posed: Callable[..., Solution]) -> Callable[..., Motion]:
    """Return the motion of a person who holds a posture."""

    def measure(**degrees: float) -> Motion:
        lift = posed(**degrees)
        return motion_of(replace(lift, agents=(travelled(lift, 1.0), lift.agents[1])), travelled(lift, 1.0))

    return measure


def travelled(lift: Solution, pulses: float, aside: float = 0.0) -> object:
    """Return the person with a hand that rises by 1 m in so many pulses, and bulges aside by so much [m]."""
    share = lift.time / lift.time[-1]
    height = share - np.sin(2 * np.pi * pulses * share) / (2 * np.pi * pulses)
    path = np.stack([aside * np.sin(np.pi * height), 0.0 * height, height], axis=1)
    return replace(lift.persons[0], grasp_position=path[:, None])


def test_a_hanging_arm_is_straight_and_low(moved: Callable[..., Motion]) -> None:
    motion = moved()
    for name in ("elbow", "humeral_elevation", "abduction", "wrist_bend", "twist"):
        np.testing.assert_allclose(getattr(motion, name), 0.0, atol=1e-5)
    assert 0.6 < motion.wrist_height[0] < 1.0


@pytest.mark.parametrize(
    ("posture", "elevation", "abduction"),
    [
        ({"Q5": 60.0}, 60.0, 0.0),
        ({"Q4": -40.0}, 40.0, 40.0),
        ({"Q4": -120.0}, 120.0, 120.0),
        ({"Q5": 90.0, "Q2": 30.0}, 90.0, 0.0),  # against the trunk, however it leans
    ],
)
def test_the_upper_arm_by_hand(
    moved: Callable[..., Motion], posture: dict[str, float], elevation: float, abduction: float
) -> None:
    motion = moved(**posture)
    np.testing.assert_allclose(motion.humeral_elevation, elevation, atol=1e-6)
    np.testing.assert_allclose(motion.abduction, abduction, atol=1e-6)


def test_the_hand_against_the_forearm(moved: Callable[..., Motion]) -> None:
    """Two bends at right angles: cosines multiply."""
    motion = moved(Q9=-30.0, Q10=20.0, Q7=-70.0, Q3=12.0)
    expected = np.degrees(np.arccos(np.cos(np.radians(30.0)) * np.cos(np.radians(20.0))))
    np.testing.assert_allclose(motion.wrist_bend, expected)
    np.testing.assert_allclose((motion.elbow, motion.twist), [np.full(len(motion.elbow), v) for v in (70.0, 12.0)])
    np.testing.assert_allclose((motion.wrist_flexion[0], motion.wrist_deviation[0]), (30.0, 20.0))


@pytest.mark.parametrize("pulses", [1, 2, 3])
def test_peaks_of_the_hands_speed(posed: Callable[..., Solution], pulses: int) -> None:
    lift = posed()
    time = np.linspace(0.0, 2.0, 201)
    lift = replace(lift, time=time, agents=tuple(agent.every(1) for agent in lift.agents))
    person = replace(travelled(lift, pulses), q=np.zeros((201, lift.persons[0].q.shape[1])))
    person = replace(person, grasp_force=np.zeros((201, 1, 3)))
    assert motion_of(lift, person).speed_peaks == pulses


def test_path_over_chord(posed: Callable[..., Solution]) -> None:
    """1 for a straight path; of half a sine of amplitude a over 1 m, 1 + (pi a)**2 / 4 for small a."""
    lift = posed()
    assert motion_of(lift, travelled(lift, 1.0)).path_over_chord == pytest.approx(1.0, abs=1e-12)
    assert motion_of(lift, travelled(lift, 1.0, 0.05)).path_over_chord == pytest.approx(1.0 + 0.0061685, abs=1e-3)
