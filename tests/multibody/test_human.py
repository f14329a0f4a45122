"""The human model. Oracles: anatomy (where the hand goes), closed forms, textbook DH matrices, Pinocchio."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from liftopt.multibody.dh import row_tail
from liftopt.multibody.person.anthropometry import landmarks, link_lengths
from liftopt.multibody.person.human import Subject, human_agent, human_chain, human_root
from liftopt.multibody.person.segments import SEGMENTS

SUBJECT = Subject(1.75, 75.0, "male")
WOMAN = Subject(1.63, 62.0, "female")
X, Y, Z = np.eye(3)
subjects = st.builds(
    Subject, stature=st.floats(1.45, 2.05), mass=st.floats(45.0, 130.0), sex=st.sampled_from(["male", "female"])
)


@pytest.fixture(scope="module")
def human():
    return human_agent(SUBJECT)


def test_joint_names_and_frames_are_those_of_table_2(human):
    names = [f"human_GT{i}" for i in (1, 2, 3)] + [f"human_Q{i}" for i in range(1, 11)]
    assert list(human.model.names)[1:] == names
    assert human.locked_joints == tuple(names[:3])
    assert human.model.existFrame("world") and human.model.existFrame(human.hands[0])
    assert human.reduced().nq == len(human.posture) == len(human.limits.q_lower) == 10


def test_urdf_kinematics_equal_textbook_dh_matrices(human, textbook_end, frame_pose):
    rng = np.random.default_rng(0)
    rows = human_chain(SUBJECT).rows
    for q in rng.uniform(-np.pi, np.pi, (100, 13)):
        expected = human_root() @ textbook_end(rows, q)
        np.testing.assert_allclose(frame_pose(human.model, "human_grasp", q), expected, rtol=0.0, atol=1e-12)


def test_urdf_bodies_are_the_chains_bodies(human):
    """Oracle: the DH-frame bodies, moved by the row's tail with Pinocchio's SE3 action."""
    chain = human_chain(SUBJECT)
    for row, body, loaded in zip(chain.rows, chain.inertias, list(human.model.inertias)[1:], strict=True):
        expected = pin.SE3(row_tail(row)).act(pin.Inertia(body.mass, body.com, body.inertia))
        assert loaded.mass == body.mass
        if body.mass:
            np.testing.assert_allclose(loaded.lever, expected.lever, rtol=0.0, atol=1e-14)
            np.testing.assert_allclose(loaded.inertia, expected.inertia, rtol=0.0, atol=1e-14)


def test_zero_pose_is_upright_with_the_arm_hanging_at_the_right(human, frame_pose):
    lengths = link_lengths(SUBJECT)
    hand = frame_pose(human.model, "human_grasp", np.zeros(13))[:3, 3]
    down = lengths.l4 + lengths.l5 + lengths.l6
    np.testing.assert_allclose(hand, [0.0, -lengths.l3, lengths.l1 + lengths.l2 - down], atol=1e-12)


def _turn(human, joint: str, angle: float, **rest: float) -> tuple[np.ndarray, np.ndarray]:
    """Return displacement of the grasp point and its rotation vector when one joint turns from a pose."""
    data, frame = human.model.createData(), human.model.getFrameId("human_grasp")
    poses = []
    for value in (0.0, angle):
        q = np.zeros(13)
        for name, other in rest.items():
            q[human.model.joints[human.model.getJointId(f"human_{name}")].idx_q] = other
        q[human.model.joints[human.model.getJointId(f"human_{joint}")].idx_q] += value
        pin.framesForwardKinematics(human.model, data, q)
        poses.append(data.oMf[frame].copy())
    return poses[1].translation - poses[0].translation, pin.log3(poses[1].rotation @ poses[0].rotation.T)


# Anatomy, the right arm hanging, palm forward: joint, sign of the motion, which way the hand moves (world axes).
MOTIONS = [
    ("Q1", +1, -Z, "bend to the right lowers the right hand"),
    ("Q3", +1, X, "turn to the left brings the right hand forward"),
    ("Q4", -1, -Y, "abduction takes the hand out to the right"),
    ("Q4", -1, Z, "and up"),
    ("Q5", +1, X, "shoulder flexion takes the hand forward"),
    ("Q5", +1, Z, "and up"),
    ("Q7", -1, X, "elbow flexion takes the hand forward"),
    ("Q7", -1, Z, "and up"),
    ("Q9", -1, X, "wrist flexion takes the hand to the palm's side, forward"),
    ("Q10", +1, Y, "ulnar deviation takes the hand to the little finger's side, towards the body"),
]


@pytest.mark.parametrize(("joint", "sign", "direction", "why"), MOTIONS, ids=[m[3] for m in MOTIONS])
def test_signs_by_where_the_hand_goes(human, joint, sign, direction, why):
    moved, _ = _turn(human, joint, 0.4 * sign)
    assert moved @ direction > 1e-3, why


def test_spine_flexion_takes_a_raised_hand_forward_and_down(human):
    moved, _ = _turn(human, "Q2", 0.4, Q5=np.pi)
    assert moved @ X > 0.1
    assert moved @ Z < 0.0


def test_internal_rotation_brings_the_bent_forearm_in_front_of_the_body(human):
    moved, _ = _turn(human, "Q6", 0.4, Q7=-np.pi / 2)
    assert moved @ Y > 0.1


def test_pronation_turns_the_forward_palm_inwards_and_then_back(human, frame_pose):
    palm = frame_pose(human.model, "human_grasp", np.zeros(13))[:3, :3].T @ X  # forward in the anatomical pose
    q = np.zeros(13)
    q[10] = -np.pi / 2
    np.testing.assert_allclose(frame_pose(human.model, "human_grasp", q)[:3, :3] @ palm, Y, atol=1e-12)
    assert human.limits.q_lower[7] < -np.pi / 2 < human.limits.q_upper[7] == 0.0


@pytest.mark.parametrize(
    ("joint", "lower", "upper", "weaker", "stronger"),
    [
        ("Q2", -25, 80, 143, -234),  # flexion +80; the extensors are the stronger
        ("Q4", -180, 30, 67, -71),  # abduction is negative
        ("Q5", -60, 180, -67, 92),  # flexion is positive
        ("Q6", -90, 70, -33, 52),  # internal rotation is positive
        ("Q7", -150, 0, 46, -77),  # flexion is negative
        ("Q8", -160, 0, -13, 13.5),  # zero is full supination
        ("Q9", -80, 70, 10, -20),  # flexion is negative
        ("Q10", -20, 30, -15, 15),  # ulnar is positive
    ],
)
def test_limits_carry_each_direction_apart(human, joint, lower, upper, weaker, stronger):
    """Oracle: AAOS ranges and Stobbe (1982), 50th percentile men, mapped by hand."""
    index = int(joint[1:]) - 1
    limits, joint_id = human.limits, human.model.getJointId(f"human_{joint}")
    np.testing.assert_allclose(np.degrees([limits.q_lower[index], limits.q_upper[index]]), [lower, upper])
    assert sorted([weaker, stronger]) == [limits.tau_lower[index], limits.tau_upper[index]]
    at = human.model.joints[joint_id].idx_v
    assert human.model.upperEffortLimit[at] == abs(stronger)
    assert human.model.upperVelocityLimit[at] == limits.velocity[index]
    assert human.model.lowerPositionLimit[at] == limits.q_lower[index]
    assert human.model.upperPositionLimit[at] == limits.q_upper[index]


def test_posture_is_comfortable_and_reaches_ahead(human, frame_pose):
    limits = human.limits
    assert np.all(limits.q_lower <= human.posture) and np.all(human.posture <= limits.q_upper)
    hand = frame_pose(human.model, "human_grasp", np.r_[np.zeros(3), human.posture])[:3, 3]
    assert 0.3 < hand[0] < 0.6 and 0.8 < hand[2] < 1.2
    assert human.workspace is not None
    assert human.workspace.normal @ hand > human.workspace.offset


@pytest.mark.parametrize("subject", [SUBJECT, WOMAN], ids=["man", "woman"])
def test_link_lengths_of_two_subjects(subject):
    """Oracle: L1 to L6 worked out by hand from the regressions and ratios of their sources [m]."""
    expected = {
        "male": (1.0577, 0.3554, 0.2045, 0.2832, 0.2703, 0.0866),
        "female": (0.9849, 0.3146, 0.1817, 0.2585, 0.2483, 0.0733),
    }[subject.sex]
    lengths = link_lengths(subject)
    got = (lengths.l1, lengths.l2, lengths.l3, lengths.l4, lengths.l5, lengths.l6)
    np.testing.assert_allclose(got, expected, rtol=0.0, atol=5.1e-5)


def test_upper_arm_is_de_levas(human):
    """Oracle: de Leva (1996), Table 4, male upper arm, by hand: anteroposterior axis X, mediolateral Y, long Z."""
    mass, length = 0.0271 * 75.0, 281.7 / 1741.0 * 1.75
    q = np.zeros(13)
    data = human.model.createData()
    pin.forwardKinematics(human.model, data, q)
    joint = human.model.getJointId("human_Q6")
    body = data.oMi[joint].act(human.model.inertias[joint])
    shoulder = data.oMi[joint].translation
    np.testing.assert_allclose(body.mass, mass, rtol=1e-12)
    np.testing.assert_allclose(body.lever, shoulder - [0.0, 0.0, 0.5772 * length], atol=1e-11)
    moments = mass * (length * np.array([0.285, 0.269, 0.158])) ** 2
    np.testing.assert_allclose(body.inertia, np.diag(moments), atol=1e-11)


def test_segments_sum_to_one_body():
    """Oracle: the printed mass fractions sum to 1 within their last digit."""
    for table in SEGMENTS.values():
        single = sum(table[name].mass for name in ("head", "upper_trunk", "middle_trunk", "lower_trunk"))
        paired = sum(table[name].mass for name in ("upper_arm", "forearm", "hand", "thigh", "shank", "foot"))
        assert single + 2.0 * paired == pytest.approx(1.0, abs=1.5e-4)


def test_whole_weight_stands_on_the_ground(human):
    """Oracle: body weight [N] on the vertical virtual joint at rest, nothing on the horizontal ones."""
    tau = pin.rnea(human.model, human.model.createData(), *np.zeros((3, 13)))
    np.testing.assert_allclose(tau[:3], [0.0, 0.0, 75.0 * 9.81], atol=1e-9)


def test_centre_of_mass_of_the_standing_subject(human):
    """Oracle: a standing man's centre of mass is at 54 to 58 % of stature, over the feet, in the median plane."""
    com = pin.centerOfMass(human.model, human.model.createData(), np.zeros(13))
    assert 0.54 < com[2] / SUBJECT.stature < 0.58
    assert -0.01 < com[0] < 0.10
    assert abs(com[1]) < 1e-9


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(subjects)
def test_any_subject_stacks_up_and_weighs_what_it_weighs(assert_bodies_are_physical, subject):
    lengths, at = link_lengths(subject), landmarks(subject)
    assert min(vars(lengths).values()) > 0.0
    heights = [at.vertex, at.suprasternale, at.xiphion, at.omphalion, at.hip, at.knee, at.ankle, 0.0]
    assert all(upper > lower for upper, lower in pairwise(heights))
    model = human_agent(subject).model
    assert pin.computeTotalMass(model) == pytest.approx(subject.mass, abs=1e-9)
    assert_bodies_are_physical(model)


@settings(max_examples=100, deadline=None)
@given(subjects, st.floats(0.005, 0.1))
def test_every_length_grows_with_stature(subject, more):
    taller = link_lengths(Subject(subject.stature + more, subject.mass, subject.sex))
    lengths = vars(link_lengths(subject))
    assert all(vars(taller)[name] > value for name, value in lengths.items())


@pytest.mark.parametrize("corner", [(1.2, 200.0), (1.2, 30.0), (2.2, 30.0), (2.2, 200.0)])
@pytest.mark.parametrize("sex", ["male", "female"])
def test_every_corner_of_what_is_allowed_builds(corner, sex, assert_bodies_are_physical):
    assert_bodies_are_physical(human_agent(Subject(*corner, sex)).model)
