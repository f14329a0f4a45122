"""The whole person. Oracles: the arm's model of the same subject, mirror images, anatomy, MuJoCo, closed forms."""

from __future__ import annotations

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from liftopt.multibody.mujoco_model import spec_of
from liftopt.multibody.person.anthropometry import dimension, landmarks
from liftopt.multibody.person.human import human_agent
from liftopt.multibody.person.leg_strength import LEG_STRENGTHS, IsometricCurve
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.person.whole_body import whole_human_agent
from liftopt.multibody.person.whole_joints import ARM, JOINTS, LEGS, TRUNK
from liftopt.multibody.placement import Placement
from liftopt.types import Array

MAN, WOMAN = Subject(1.75, 75.0, "male"), Subject(1.6, 55.0, "female")
MIRROR_WORLD, MIRROR_AXIS = np.diag([1.0, -1.0, 1.0]), np.diag([1.0, 1.0, -1.0])
RIGHT = [JOINTS.index(joint) for joint in (*TRUNK, *(f"right_{joint}" for joint in ARM))]
X, Y, Z = np.eye(3)


@pytest.fixture(scope="module")
def person():
    return whole_human_agent(MAN)


def _motion(seed: int) -> tuple[Array, Array, Array]:
    q, v, a = np.random.default_rng(seed).uniform(-1.0, 1.0, (3, 20))
    return q, 4.0 * v, 20.0 * a


def _mirrored(values: Array) -> Array:
    """Return joint values, or torques, of the mirrored posture: trunk aside and turned the other way, arms swapped."""
    found = values.copy()
    found[[JOINTS.index("Q1"), JOINTS.index("Q3")]] *= -1.0
    found[6:13], found[13:] = values[13:], values[6:13]
    return found


def _ground(model: pin.Model, *states: Array) -> Array:
    """Return force and moment about the world's origin (6,) that the floor gives: joint 1, and what rests there."""
    data = model.createData()
    pin.forwardKinematics(model, data, states[0])
    pin.rnea(model, data, *states)
    resting, first = model.inertias[0], data.oMi[1].act(data.f[1])
    weight = -resting.mass * model.gravity.linear
    return np.r_[first.linear + weight, first.angular + np.cross(resting.lever, weight)]


def _at(model: pin.Model, name: str, q: Array) -> pin.SE3:
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    return data.oMf[model.getFrameId(name)]


def test_joints_are_in_the_order_of_the_names_that_users_rely_on(person):
    expected = ["ankle", "knee", "hip", "Q1", "Q2", "Q3"]
    expected += [f"right_Q{i}" for i in range(4, 11)] + [f"left_Q{i}" for i in range(4, 11)]
    assert list(person.model.names)[1:] == [f"human_{joint}" for joint in expected]
    assert person.moving_joints == tuple(person.model.names)[1:]
    assert person.hands == ("human_right_grasp", "human_left_grasp")
    assert [(grasp.name, grasp.frame) for grasp in person.grasps] == [
        ("human_right", "human_right_grasp"), ("human_left", "human_left_grasp"),
    ]  # fmt: skip
    left = whole_human_agent(MAN, hands=("left",))
    assert left.urdf == person.urdf and left.hands == person.hands
    assert [grasp.name for grasp in left.grasps] == ["human_left"]


@pytest.mark.parametrize("subject", [MAN, WOMAN])
def test_with_straight_legs_and_a_hanging_left_arm_it_is_the_arms_model(subject):
    """Oracle: Pinocchio on the URDF of body = "arm", whose numbers are Table 2's."""
    whole, arm = whole_human_agent(subject).model, human_agent(subject).model
    for seed in range(20):
        states = _motion(seed)
        straight = [np.zeros(20) for _ in states]
        for full, values in zip(straight, states, strict=True):
            full[RIGHT] = values[RIGHT]
        arm_states = [np.r_[np.zeros(3), values[RIGHT]] for values in states]
        tau = pin.rnea(whole, whole.createData(), *straight)
        arm_tau = pin.rnea(arm, arm.createData(), *arm_states)
        np.testing.assert_allclose(tau[RIGHT], arm_tau[3:], rtol=1e-12, atol=1e-9)
        hand, arm_hand = (
            _at(whole, "human_right_grasp", straight[0]),
            _at(arm, "human_grasp", np.r_[np.zeros(3), states[0][RIGHT]]),
        )
        np.testing.assert_allclose(hand.homogeneous, arm_hand.homogeneous, atol=1e-12)
        np.testing.assert_allclose(_ground(whole, *straight), _ground(arm, *arm_states), rtol=1e-12, atol=1e-9)


def test_a_grasp_loads_the_joints_as_in_the_arms_model(person):
    """Oracle: Pinocchio's Jacobians of the arm's model."""
    arm = human_agent(MAN).model
    q = np.zeros(20)
    q[RIGHT] = _motion(1)[0][RIGHT]
    jacobians = []
    for model, values, frame in (
        (person.model, q, "human_right_grasp"), (arm, np.r_[np.zeros(3), q[RIGHT]], "human_grasp"),
    ):  # fmt: skip
        data = model.createData()
        jacobians.append(
            pin.computeFrameJacobian(model, data, values, model.getFrameId(frame), pin.LOCAL_WORLD_ALIGNED)
        )
    np.testing.assert_allclose(jacobians[0][:, RIGHT], jacobians[1][:, 3:], atol=1e-12)
    assert not jacobians[0][:, 13:].any()


@pytest.mark.parametrize("seed", range(5))
def test_a_mirrored_motion_has_mirrored_hands_torques_and_ground_reaction(person, seed):
    """Oracle: the reflection in the median plane; equal angles of both arms are mirror images."""
    model, states = person.model, _motion(seed)
    other = [_mirrored(values) for values in states]
    tau, mirrored = (pin.rnea(model, model.createData(), *each) for each in (states, other))
    np.testing.assert_allclose(mirrored, _mirrored(tau), rtol=1e-12, atol=1e-9)
    right, left = _at(model, "human_right_grasp", states[0]), _at(model, "human_left_grasp", other[0])
    np.testing.assert_allclose(left.translation, MIRROR_WORLD @ right.translation, atol=1e-12)
    np.testing.assert_allclose(left.rotation, MIRROR_WORLD @ right.rotation @ MIRROR_AXIS, atol=1e-12)
    # A moment is an axial vector: its mirror image has the opposite sign.
    force, moment = np.split(_ground(model, *states), 2)
    np.testing.assert_allclose(
        _ground(model, *other), np.r_[MIRROR_WORLD @ force, -MIRROR_WORLD @ moment], rtol=1e-12, atol=1e-9
    )


@pytest.mark.parametrize(
    ("joint", "moves", "direction", "why"),
    [
        ("ankle", "knee", X, "dorsiflexion takes the knee ahead"),
        ("knee", "hip", -X, "knee flexion takes the hip back over the resting foot"),
        ("hip", "right_Q4", X, "hip flexion takes the shoulder ahead"),
        ("Q2", "right_Q4", X, "trunk flexion takes the shoulder ahead"),
    ],
)
def test_flexion_is_positive(person, joint, moves, direction, why):
    q = np.zeros(20)
    q[JOINTS.index(joint)] = 0.3
    data = person.model.createData()
    places = []
    for values in (np.zeros(20), q):
        pin.forwardKinematics(person.model, data, values)
        places.append(data.oMi[person.model.getJointId(f"human_{moves}")].translation.copy())
    moved = places[1] - places[0]
    assert moved @ direction > 0.05, why
    assert moved @ Z < 0.0 and abs(moved @ Y) < 1e-12


def test_squatting_lowers_the_hip_by_the_cosines_of_the_legs(person):
    """Oracle: the closed form of a planar chain; the pelvis leans by ankle - knee + hip."""
    at, (ankle, knee, hip) = landmarks(MAN), np.radians([30.0, 100.0, 90.0])
    q = np.zeros(20)
    q[:3] = ankle, knee, hip
    data = person.model.createData()
    pin.forwardKinematics(person.model, data, q)
    height = at.ankle + (at.knee - at.ankle) * np.cos(ankle) + (at.hip - at.knee) * np.cos(ankle - knee)
    assert data.oMi[3].translation[2] == pytest.approx(height, abs=1e-12)
    lean = pin.rpy.matrixToRpy(_at(person.model, "human_hip_link", q).rotation @ _at(
        person.model, "human_hip_link", np.zeros(20)).rotation.T)  # fmt: skip
    np.testing.assert_allclose(lean, [0.0, ankle - knee + hip, 0.0], atol=1e-12)


@pytest.mark.parametrize("subject", [MAN, WOMAN])
def test_the_bodies_are_the_whole_mass_and_physical(subject, assert_bodies_are_physical):
    model = whole_human_agent(subject).model
    assert sum(body.mass for body in model.inertias) == pytest.approx(subject.mass, abs=1e-9)
    assert_bodies_are_physical(model)


def test_inverse_dynamics_of_the_same_urdf_by_mujoco(person):
    """Oracle: MuJoCo's own reading of the URDF."""
    model = spec_of([person.urdf]).compile()
    data = mujoco.MjData(model)
    dofs = [model.joint(name).dofadr[0] for name in person.moving_joints]
    for seed in range(20):
        states = _motion(seed)
        for full, values in zip((data.qpos, data.qvel, data.qacc), states, strict=True):
            full[dofs] = values
        mujoco.mj_inverse(model, data)
        tau = pin.rnea(person.model, person.model.createData(), *states)
        np.testing.assert_allclose(data.qfrc_inverse[dofs], tau, rtol=1e-9, atol=1e-8)


def test_it_stands_where_it_is_placed_and_faces_that_way(person):
    place = Placement(1.2, -0.4, 2.0)
    moved = whole_human_agent(MAN, name="ana", place=place)
    q = _motion(3)[0]
    here, there = _at(person.model, "human_left_grasp", q), _at(moved.model, "ana_left_grasp", q)
    np.testing.assert_allclose(there.homogeneous, place.T_world_base @ here.homogeneous, atol=1e-12)
    assert moved.workspace is not None
    assert moved.workspace.normal @ np.array([1.2, -0.4, 0.0]) == pytest.approx(moved.workspace.offset)


def test_limits_are_those_of_the_arms_model_on_both_sides(person):
    arm, own = human_agent(MAN).limits, person.limits
    for name in ("q_lower", "q_upper", "velocity", "tau_lower", "tau_upper"):
        values, expected = getattr(own, name), getattr(arm, name)
        np.testing.assert_array_equal(values[3:13], expected)
        np.testing.assert_array_equal(values[13:], expected[3:])
    np.testing.assert_allclose(np.degrees([own.q_lower[:3], own.q_upper[:3]]), [[-50, 0, -30], [39, 135, 120]])
    assert person.comfort is not None and len(person.comfort.neutral) == len(person.posture) == 20
    np.testing.assert_array_equal(person.comfort.room_upper[3:13], person.comfort.room_upper[[3, 4, 5, *range(13, 20)]])
    assert np.all(own.q_lower <= person.posture) and np.all(person.posture <= own.q_upper)
    model = person.model
    np.testing.assert_array_equal(model.lowerPositionLimit, own.q_lower)
    np.testing.assert_array_equal(model.upperEffortLimit, own.effort)


@pytest.mark.parametrize("strength", LEG_STRENGTHS, ids=lambda item: item.motion)
@pytest.mark.parametrize("subject", [MAN, WOMAN])
def test_both_legs_are_as_strong_as_the_mean_of_the_isometric_curve(subject, strength):
    """Oracle: the mean of c1 cos(c2 (q - c3)) times weight times stature, by the rule of trapezoids."""
    lower, upper = {"ankle": (0, 39), "knee": (0, 120), "hip": (0, 110)}[strength.joint]
    q = np.radians(np.linspace(lower, upper, 2001))
    curve: IsometricCurve = strength.curve[subject.sex]
    share = curve.peak * np.cos(curve.width * (q - curve.best))
    expected = 2.0 * subject.mass * 9.81 * subject.stature * np.trapezoid(share, q) / (q[-1] - q[0])
    limits = whole_human_agent(subject).limits
    found = (limits.tau_upper if strength.sign > 0 else -limits.tau_lower)[LEGS.index(strength.joint)]
    assert found == pytest.approx(expected, rel=1e-6)
    # Below the best angle's: a squat with bent knees is not as strong as the dynamometer's best.
    assert found < 2.0 * curve.peak * subject.mass * 9.81 * subject.stature


def test_the_soles_bear_from_the_heel_to_the_ball_of_the_foot(person):
    stance = person.stance
    assert stance is not None
    ((back, front, aside),) = stance.soles
    length = dimension(MAN, "footlength")
    assert back < 0.0 < front
    # The ball of the foot is at 0.74 of its length on average in the survey.
    assert (front - back) / length == pytest.approx(0.74, abs=0.01)
    assert dimension(MAN, "footbreadthhorizontal") < aside < dimension(MAN, "hipbreadth")
    resting = person.model.inertias[0]
    assert stance.mass == pytest.approx(resting.mass, abs=1e-12)
    np.testing.assert_allclose(stance.p_base_com, resting.lever, atol=1e-12)
    # Upright, a person's weight is over the soles.
    whole = person.model.createData()
    com = pin.centerOfMass(person.model, whole, np.zeros(20))
    assert back < com[0] < front
