"""The posture as measured: the oracle is one joint moved at a time, where anatomy says what the goniometer reads."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from liftopt.ergonomics.posture import ArmPosture, Posture, posture_by, posture_of
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.person.whole_body import whole_human_agent
from liftopt.multibody.trajectory import agent_trajectory

ANGLES = (
    "trunk_flexion", "trunk_bend", "trunk_turn", "trunk_inclination", "upper_arm_flexion", "upper_arm_out",
    "elbow_flexion", "wrist_flexion", "wrist_deviation",
)  # fmt: skip


def _posture(lift: Any) -> Posture:
    return posture_of(lift, lift["human"])


def _arm(lift: Any) -> ArmPosture:
    return _posture(lift).arm("right")


def _found(posture: Posture) -> dict[str, float]:
    """Return the angles of trunk and right arm at the first time by name."""
    angles = vars(posture) | vars(posture.arm("right"))
    return {name: float(angles[name][0]) for name in ANGLES}


@pytest.mark.parametrize(
    ("joints", "wanted"),
    [
        ({}, {}),
        ({"Q5": 50.0}, {"upper_arm_flexion": 50.0}),
        ({"Q5": -30.0}, {"upper_arm_flexion": -30.0}),
        ({"Q4": -40.0}, {"upper_arm_out": 40.0}),
        ({"Q7": -75.0}, {"elbow_flexion": 75.0}),
        ({"Q9": -25.0}, {"wrist_flexion": 25.0}),
        ({"Q10": 12.0}, {"wrist_deviation": 12.0}),
        # The arm is carried along by the trunk: against it, it does not move.
        ({"Q2": 30.0, "Q5": 50.0}, {"trunk_flexion": 30.0, "trunk_inclination": 30.0, "upper_arm_flexion": 50.0}),
        # Bent aside and forward, it is inclined by the forward bend alone.
        ({"Q1": 20.0, "Q2": 70.0}, {"trunk_bend": 20.0, "trunk_flexion": 70.0, "trunk_inclination": 70.0}),
        ({"Q1": 15.0, "Q3": 20.0}, {"trunk_bend": 15.0, "trunk_turn": 20.0}),
    ],
    ids=str,
)
def test_one_joint_moves_one_angle(
    posed: Callable[..., Any], joints: dict[str, float], wanted: dict[str, float]
) -> None:
    found = _found(_posture(posed(**joints)))
    assert found == pytest.approx(dict.fromkeys(ANGLES, 0.0) | wanted, abs=1e-9)


def test_forearm_counts_from_the_middle_of_its_range(posed: Callable[..., Any]) -> None:
    # Full supination is Q8 = 0, full pronation -160 deg: the thumb is up at -80.
    assert [_arm(posed(Q8=angle)).pronation[0] for angle in (0.0, -80.0, -160.0)] == pytest.approx([-80, 0, 80])


def test_wrist_across_and_outside(posed: Callable[..., Any]) -> None:
    hanging = _arm(posed())
    assert hanging.wrist_outside[0] == pytest.approx(0.0, abs=1e-9)  # straight below the shoulder
    assert hanging.wrist_across[0] < -0.1  # on its own side
    across = _arm(posed(Q5=90.0, Q4=0.0, Q6=60.0, Q7=-90.0))
    assert across.wrist_across[0] > hanging.wrist_across[0] + 0.1
    raised = _arm(posed(Q4=-90.0))
    assert raised.wrist_outside[0] > 0.4


def test_hand_load_is_the_force_as_a_mass(posed: Callable[..., Any]) -> None:
    posture = _posture(posed(force=(3.0, 4.0, 12.0)))
    for load in (posture.load, posture.arm("right").hand_load):
        np.testing.assert_allclose(load, 13.0 / 9.81, rtol=1e-12)


def _whole(hands: tuple[str, ...] = ("right", "left"), **degrees: float) -> Posture:
    """Return the posture of a whole person at rest, joints by name in deg, 30 N on the object from each hand."""
    agent = whole_human_agent(Subject(1.75, 75.0, "male"), hands=hands)
    q = np.zeros((1, len(agent.moving_joints)))
    for joint, angle in degrees.items():
        q[:, agent.moving_joints.index(f"human_{joint}")] = np.radians(angle)
    force = np.tile((0.0, 0.0, 30.0), (1, len(hands), 1))
    return posture_by(agent, agent_trajectory(agent, q, np.zeros_like(q), np.zeros_like(q), force), np.eye(3), 0.18)


def test_legs_and_trunk_incline_the_trunk_together() -> None:
    """By hand: the shank leans forward, the thigh back, the trunk forward again."""
    posture = _whole(ankle=25.0, knee=100.0, hip=95.0, Q2=10.0)
    assert (posture.ankle[0], posture.knee[0], posture.hip[0]) == pytest.approx((25.0, 100.0, 95.0))
    assert posture.trunk_inclination[0] == pytest.approx(25.0 - 100.0 + 95.0 + 10.0)
    assert _whole(hip=110.0).trunk_inclination[0] == pytest.approx(110.0)
    assert _whole(hip=110.0).trunk_flexion[0] == 0.0


def test_both_arms_are_measured_alike() -> None:
    pose = {"Q4": -25.0, "Q5": 40.0, "Q6": 15.0, "Q7": -60.0, "Q8": -70.0, "Q9": -12.0, "Q10": 7.0}
    posture = _whole(**{f"{side}_{joint}": angle for side in ("right", "left") for joint, angle in pose.items()})
    right, left = (vars(posture.arm(side)) for side in ("right", "left"))
    for name in set(right) - {"side"}:
        assert left[name][0] == pytest.approx(right[name][0], abs=1e-9), name
    assert right["elbow_flexion"][0] == pytest.approx(60.0)


def test_the_load_of_each_hand_and_of_both() -> None:
    both, left = _whole(), _whole(hands=("left",))
    assert [arm.hand_load[0] for arm in both.arms] == pytest.approx([30.0 / 9.81] * 2)
    assert both.load[0] == pytest.approx(60.0 / 9.81)
    assert [arm.hand_load[0] for arm in left.arms] == pytest.approx([0.0, 30.0 / 9.81])


def test_weight_on_both_feet() -> None:
    """Even where nothing is aside; by hand, 30 N held by one hand move the centre of pressure towards it."""
    assert _whole().heavier_foot[0] == pytest.approx(0.5, abs=1e-6)
    agent = whole_human_agent(Subject(1.75, 75.0, "male"), hands=("left",))
    q = np.zeros((1, len(agent.moving_joints)))
    person = agent_trajectory(agent, q, q, q, np.array([[[0.0, 0.0, 30.0]]]))
    aside = 30.0 * person.grasp_position[0, 0, 1] / person.ground_force[0, 2]
    found = posture_by(agent, person, np.eye(3), 0.18).heavier_foot[0]
    assert found == pytest.approx(0.5 + aside / 0.18, rel=1e-6)
