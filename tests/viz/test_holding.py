"""Hands and grippers hold what is lifted: palm and fingers at the grasp point, and none of it in the object (coal)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import coal
import numpy as np
import pinocchio as pin
import pytest
from scipy.spatial.transform import Rotation

from liftopt.ergonomics.lift import subject_in
from liftopt.multibody.person.anthropometry import link_lengths
from liftopt.viz.holding import gripper_roll
from liftopt.viz.playback import Playback, playback_of
from liftopt.viz.scene_gripper import gripper_digits
from liftopt.viz.scene_hand import PALM, RIGHT, hand_digits, palm_tilt

CHEAP = ("solver.intervals=10", "solver.starts=1", "objective.preset=paper")
WRENCH = ("human.grasp=wrench", "robot.grasp=wrench")
CLOSURE = 1e-3  # [m]: what a verified solution allows between knots
ROOT = 1 / 7  # of a bone
# [m]: coal's capsules are as thin as the thinner end of a bone.
DEEPEST, TOUCHES = 3e-3, 5e-3


@pytest.fixture(scope="module", params=[(), WRENCH, (*WRENCH, "object.height=0.25")], ids=["point", "wrench", "box"])
def lift(request: pytest.FixtureRequest, solved: Callable[..., Any]) -> Any:
    return solved("table5", *CHEAP, *request.param).solution


@pytest.fixture(scope="module")
def playback(lift: Any) -> Playback:
    return playback_of(lift, 10.0)


def _frame(playback: Playback, body: str, k: int) -> np.ndarray:
    placement = np.eye(4)
    placement[:3, :3] = Rotation.from_quat(playback.bodies[body].quaternion[k]).as_matrix()
    placement[:3, 3] = playback.bodies[body].position[k]
    return placement


def _apart(playback: Playback, lift: Any, names: list[str], bones: list[tuple[float, float]], k: int) -> np.ndarray:
    """Distance of bones (length, radius) from the object at frame k by coal, negative inside [m]."""
    table = lift.scenario.object
    box = coal.Box(table.depth, table.width, table.height)
    at = _frame(playback, lift.object.name, k)
    found = []
    for name, (length, radius) in zip(names, bones, strict=True):
        bone = _frame(playback, name, k)
        turn = bone[:3, [1, 2, 0]]  # coal's capsule lies along z, a bone along x
        # A bone's root is flesh of what carries it, and no hinge can move it.
        root, length = ROOT * length, (1.0 - ROOT) * length
        middle = bone[:3, 3] + bone[:3, 0] * (root + length / 2)
        found.append(
            coal.distance(
                coal.Capsule(radius, length), coal.Transform3s(turn, middle), box,
                coal.Transform3s(at[:3, :3], at[:3, 3]), coal.DistanceRequest(), coal.DistanceResult(),
            )
        )  # fmt: skip
    return np.array(found)


def _bones(name: str, digits: Any) -> tuple[list[str], list[tuple[float, float]]]:
    names = [f"{name}_{digit.name}_{j + 1}" for digit in digits for j in range(len(digit.bones))]
    sizes = [
        (bone, min(pair))
        for digit in digits
        for bone, pair in zip(digit.bones, zip(digit.radii[:-1], digit.radii[1:], strict=True), strict=True)
    ]
    return names, sizes


def test_the_palms_knuckles_are_at_the_grasp_point(lift: Any, playback: Playback) -> None:
    """Flesh lies around the model's bone: half a palm's thickness off the grasp point at most."""
    subject = subject_in(lift, "human")
    reach = link_lengths(subject).l6
    for k, point in enumerate(playback.forces["human"].point):
        palm = _frame(playback, "human_right_palm", k)
        knuckles = palm[:3, 3] + reach * palm[:3, 0]
        assert np.linalg.norm(knuckles - point) < PALM + 1e-3
    assert palm_tilt(subject) == pytest.approx(np.arcsin(PALM / reach))


def test_the_palm_hangs_on_the_models_wrist(lift: Any, playback: Playback) -> None:
    """Pinocchio's wrist (Q10's origin is the wrist's centre): the palm starts there, and leans no more than it may."""
    from liftopt.scenario.build import agents_of

    (person,) = (agent for agent in agents_of(lift.scenario) if agent.kind == "person")
    data, frame = person.model.createData(), person.model.getFrameId(person.hands[0])
    for k in (0, len(playback.time) - 1):
        q = lift["human"].q[0 if k == 0 else -1]
        pin.forwardKinematics(person.model, data, q)
        grasp = pin.updateFramePlacement(person.model, data, frame)
        palm = _frame(playback, "human_right_palm", k)
        # The grasp frame has the palm's normal along z and the fingers along -x (holds.hand_on).
        wrist = grasp.translation + link_lengths(subject_in(lift, "human")).l6 * grasp.rotation[:, 0]
        np.testing.assert_allclose(palm[:3, 3], wrist, atol=1e-6)
        lean = np.arccos(np.clip(palm[:3, 2] @ grasp.rotation[:, 2], -1.0, 1.0))
        assert lean <= palm_tilt(subject_in(lift, "human")) + 1e-6
        np.testing.assert_allclose(palm[:3, 1], -grasp.rotation[:, 1], atol=1e-6)


def test_no_finger_is_in_the_object_and_a_held_one_is_touched(lift: Any, playback: Playback) -> None:
    hand = _bones("human_right", hand_digits(subject_in(lift, "human"), RIGHT))
    gripper = _bones("robot", gripper_digits(lift.scenario.agents["robot"].tool.length))
    wrench = lift.scenario.agents["human"].grasp == "wrench"
    for k in range(len(playback.time)):
        jaws = _apart(playback, lift, *gripper, k)
        assert jaws.min() > -DEEPEST - CLOSURE, (gripper[0][int(np.argmin(jaws))], k)
        if wrench:  # the palm faces the edge: fingers and thumb close on it
            apart = _apart(playback, lift, *hand, k)
            assert apart.min() > -DEEPEST - CLOSURE, (hand[0][int(np.argmin(apart))], k)
            if lift.scenario.object.height < 0.1:  # a box is held where a hand that turns under it meets it
                assert apart.reshape(5, -1).min(axis=1).max() < TOUCHES, (apart, k)
                assert jaws.min() < TOUCHES


def test_a_gripper_opens_across_the_plate_where_the_hold_is_level(lift: Any, playback: Playback) -> None:
    tool = np.stack([_frame(playback, "robot_gripper", k) for k in range(len(playback.time))])
    box = np.stack([_frame(playback, lift.object.name, k) for k in range(len(playback.time))])
    assert gripper_roll(tool, box) == pytest.approx(0.0, abs=1e-3)  # no other mount opens more across it
    if lift.scenario.agents["robot"].grasp == "wrench":
        assert np.abs(np.einsum("ki,ki->k", tool[:, :3, 1], box[:, :3, 2])).min() > np.cos(np.radians(35.0))
