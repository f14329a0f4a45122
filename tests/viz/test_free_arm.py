"""The free arm hangs from the shoulder that Pinocchio's trunk carries, and stays out of the object (coal)."""

from __future__ import annotations

import coal
import numpy as np
import pinocchio as pin
import pytest

from liftopt.multibody.person.anthropometry import link_lengths
from liftopt.multibody.person.human import human_agent
from liftopt.multibody.person.subject import Subject
from liftopt.viz.free_arm import HAND, INWARDS, hanging_arm
from liftopt.viz.scene_hand import LEFT

SUBJECT = Subject(1.75, 75.0, "male")
HALF = np.array([0.2, 0.2, 0.15])
FAR = np.array([[1.0, 0.0, 0.0, 9.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]])


def _trunks(*postures: tuple[float, float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Return T_base_trunk at zero and T_world_trunk (K, 4, 4) with Q1 to Q3 of ``postures`` [deg]."""
    model = human_agent(SUBJECT).model
    data, trunk = model.createData(), model.getJointId("human_Q3")
    placed = []
    for posture in ((0.0, 0.0, 0.0), *postures):
        q = np.zeros(model.nq)
        q[3:6] = np.radians(posture)
        pin.forwardKinematics(model, data, q)
        placed.append(data.oMi[trunk].homogeneous.copy())
    return placed[0], np.array(placed[1:])


def _arm(swung: np.ndarray, T_base_trunk: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return shoulder and fingertips (3,) of the arm in the world, given the frame that is fixed to it."""
    lengths = link_lengths(SUBJECT)
    shoulder = np.array([0.0, lengths.l3, lengths.l1 + lengths.l2, 1.0])
    tips = shoulder - [0.0, 0.0, lengths.l4 + lengths.l5 + HAND * lengths.l6, 0.0]
    upright = swung @ np.linalg.inv(T_base_trunk)
    return (upright @ shoulder)[:3], (upright @ tips)[:3]


def test_it_hangs_straight_down_from_its_shoulder_however_far_the_trunk_leans() -> None:
    T_base_trunk, trunks = _trunks((0.0, 0.0, 0.0), (0.0, 40.0, 0.0), (0.0, 70.0, 0.0), (0.0, -10.0, 0.0))
    swung = hanging_arm(SUBJECT, LEFT, T_base_trunk, trunks, np.tile(FAR, (4, 1, 1)), HALF)
    for arm, trunk in zip(swung, trunks, strict=True):
        shoulder, tips = _arm(arm, T_base_trunk)
        np.testing.assert_allclose(shoulder, _arm(trunk, T_base_trunk)[0], atol=1e-9)
        down = (tips - shoulder) / np.linalg.norm(tips - shoulder)
        np.testing.assert_allclose(down, [0.0, 0.0, -1.0], atol=1e-9)


@pytest.mark.parametrize(
    ("posture", "off"),
    [((-20.0, 0.0, 0.0), 0.0), ((10.0, 50.0, 0.0), 0.0), ((12.0, 0.0, 0.0), 12.0 - np.degrees(np.arcsin(INWARDS)))],
    ids=["over it", "ahead of the legs", "away from it"],
)
def test_where_the_trunk_bends_away_from_it_it_leans_on_the_hip(
    posture: tuple[float, float, float], off: float
) -> None:
    T_base_trunk, trunks = _trunks(posture)
    (arm,) = hanging_arm(SUBJECT, LEFT, T_base_trunk, trunks, FAR[None], HALF)
    shoulder, tips = _arm(arm, T_base_trunk)
    away = np.degrees(np.arccos(np.clip((shoulder - tips)[2] / np.linalg.norm(tips - shoulder), -1.0, 1.0)))
    assert away == pytest.approx(off, abs=0.1)


@pytest.mark.parametrize("ahead", [0.35, 0.45, 0.6])
def test_it_stays_out_of_the_object(ahead: float) -> None:
    T_base_trunk, trunks = _trunks((0.0, 45.0, 0.0))
    box = np.eye(4)
    box[:3, 3] = ahead, 0.15, 0.75
    (arm,) = hanging_arm(SUBJECT, LEFT, T_base_trunk, trunks, np.linalg.inv(box)[None], HALF)
    shoulder, tips = _arm(arm, T_base_trunk)
    along = tips - shoulder
    length = float(np.linalg.norm(along))
    across = np.cross([0.0, 1.0, 0.0], along / length)
    turn = np.column_stack([across, np.cross(along / length, across), along / length])
    distance = coal.distance(
        coal.Capsule(0.02, length), coal.Transform3s(turn, (shoulder + tips) / 2), coal.Box(*(2 * HALF)),
        coal.Transform3s(np.eye(3), box[:3, 3]), coal.DistanceRequest(), coal.DistanceResult(),
    )  # fmt: skip
    assert distance > -5e-3
