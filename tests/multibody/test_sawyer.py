"""Sawyer. Oracles: the manufacturer's chain built in Pinocchio, its listed gravity torques, textbook DH matrices."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from liftopt.errors import InputError
from liftopt.multibody.placement import facing
from liftopt.multibody.robots import sawyer_description as described
from liftopt.multibody.robots.sawyer import sawyer_agent, sawyer_chain, sawyer_root

BARE = {"place": facing(1.9), "base_height": 0.915, "tool_length": 0.0, "tool_mass": 0.0}
GRIPPER = BARE | {"tool_length": 0.15, "tool_mass": 0.4}
TO_TABLE_3 = np.array([1.0, 1.0, 1.0, -1.0, 1.0, 1.0, 1.0])
RNG = np.random.default_rng(1)


@pytest.fixture(scope="module")
def bare():
    return sawyer_agent(**BARE).reduced()


@pytest.fixture(scope="module")
def manufacturers():
    """Return the manufacturer's arm in its own frames, standing where the agent stands; the head fixed."""
    model, parent = pin.Model(), 0
    placement = pin.SE3(pin.rpy.rpyToMatrix(0.0, 0.0, np.pi), np.array([1.9, 0.0, 0.915]))
    for index, (joint, link) in enumerate(zip(described.JOINTS, described.LINKS, strict=True)):
        placement = placement * pin.SE3(pin.rpy.rpyToMatrix(*joint.rpy), np.array(joint.xyz))
        parent = model.addJoint(parent, pin.JointModelRZ(), placement, f"right_j{index}")
        _add(model, parent, link, np.zeros(3))
        placement = pin.SE3.Identity()
    _add(model, 1, described.HEAD, np.array(described.HEAD_IN_FIRST_LINK))
    flange = pin.SE3(np.eye(3), np.array(described.FLANGE_IN_LAST_LINK))
    model.addFrame(pin.Frame("right_hand", parent, 0, flange, pin.FrameType.OP_FRAME))
    return model


def _add(model: pin.Model, joint: int, link, offset: np.ndarray) -> None:
    body = link.body()
    model.appendBodyToJoint(joint, pin.Inertia(body.mass, body.com, body.inertia), pin.SE3(np.eye(3), offset))


def test_flange_follows_the_manufacturers_kinematics_within_a_micrometre(bare, manufacturers, frame_pose):
    """The requirement is 0.1 mm; measured 0.2 um, which is the rounding of the manufacturer's angles."""
    worst = 0.0
    for q in RNG.uniform(-np.pi, np.pi, (500, 7)):
        ours = frame_pose(bare, "robot_grasp", TO_TABLE_3 * q)[:3, 3]
        worst = max(worst, np.abs(ours - frame_pose(manufacturers, "right_hand", q)[:3, 3]).max())
    assert worst < 1e-6


def test_dynamics_are_the_manufacturers(bare, manufacturers):
    """Oracle: RNEA of the manufacturer's chain; measured 7e-7 Nm, which is the rounding of its joint angles."""
    ours, theirs = bare.createData(), manufacturers.createData()
    for q, v, a in RNG.uniform(-1.0, 1.0, (100, 3, 7)) * np.array([[3.0], [2.0], [5.0]]):
        tau = TO_TABLE_3 * pin.rnea(bare, ours, TO_TABLE_3 * q, TO_TABLE_3 * v, TO_TABLE_3 * a)
        np.testing.assert_allclose(tau, pin.rnea(manufacturers, theirs, q, v, a), rtol=0.0, atol=2e-6)


@pytest.mark.parametrize(
    ("payload", "listed"),
    [
        (0.0, [0, -16.3, -2.34, -5.94, 1.18, 0.09, 0]),
        (1.0, [0, -19.92, -2.46, -8.06, 1.91, 0.09, 0]),
        (2.0, [0, -23.53, -2.58, -10.18, 2.63, 0.09, 0]),
        (4.0, [0, -30.77, -2.82, -14.42, 4.07, 0.09, 0]),
    ],
)
def test_listed_gravity_torques(bare, payload, listed):
    """Oracle: torques [Nm] of the manufacturer's URDF in its neutral pose, to the digits listed.

    The payload is a point mass at the flange, right_hand.
    """
    q = TO_TABLE_3 * np.array([0, -1.18, 0, 2.18, 0, 0.57, 3.3161])
    data = bare.createData()
    frame = bare.getFrameId("robot_grasp")
    jacobian = pin.computeFrameJacobian(bare, data, q, frame, pin.LOCAL_WORLD_ALIGNED)[:3]
    tau = pin.computeGeneralizedGravity(bare, data, q) + jacobian.T @ [0.0, 0.0, 9.81 * payload]
    np.testing.assert_allclose(TO_TABLE_3 * tau, listed, rtol=0.0, atol=0.005)


@pytest.mark.parametrize("given", [BARE, GRIPPER], ids=["bare", "gripper"])
def test_urdf_kinematics_equal_textbook_dh_matrices(given, textbook_end, frame_pose):
    model = sawyer_agent(**given).model
    chain = sawyer_chain(**{key: given[key] for key in ("base_height", "tool_length", "tool_mass")})
    for q in RNG.uniform(-np.pi, np.pi, (100, 10)):
        expected = sawyer_root(facing(1.9)) @ textbook_end(chain.rows, q)
        np.testing.assert_allclose(frame_pose(model, "robot_grasp", q), expected, rtol=0.0, atol=1e-12)


def test_chain_and_urdf_weigh_the_same():
    """Oracle: the lumped tool of the DH chain against the URDF's own tool link, by mass, moment and second moment."""
    agent = sawyer_agent(**GRIPPER)
    chain = sawyer_chain(base_height=0.915, tool_length=0.15, tool_mass=0.4)
    last = agent.model.inertias[agent.model.getJointId("robot_Q7")]
    tip_in_link = pin.SE3(np.eye(3), np.array([0.0, 0.0, 0.1345 + 0.15]))
    body = chain.inertias[-1]
    expected = tip_in_link.act(pin.Inertia(body.mass, body.com, body.inertia))
    np.testing.assert_allclose(last.toDynamicParameters(), expected.toDynamicParameters(), rtol=0.0, atol=1e-11)
    assert sum(inertia.mass for inertia in chain.inertias) == pytest.approx(17.0863 + 1.5795 + 0.4, abs=1e-9)


def test_stands_facing_the_human(frame_pose):
    """Oracle: geometry by hand. At zero Sawyer's arm points forward, which is to -X."""
    agent = sawyer_agent(**BARE)
    elbow = frame_pose(agent.model, "robot_Q4_link", np.zeros(10))[:3, 3]
    assert elbow[0] < 1.9 - 0.081
    shoulder = frame_pose(agent.model, "robot_Q2_link", np.zeros(10))[:3, 3]
    np.testing.assert_allclose(shoulder, [1.9 - 0.081, 0.0, 0.915 + 0.317], atol=1e-12)


def test_limits_are_the_manufacturers_with_the_fourth_joint_turned_round():
    """Oracle: the manufacturer's limits [rad, rad/s, Nm]."""
    agent = sawyer_agent(**GRIPPER)
    limits, model = agent.limits, agent.reduced()
    np.testing.assert_allclose(limits.q_lower, [-3.0503, -3.8095, -3.0426, -3.0439, -2.9761, -2.9761, -4.7124])
    np.testing.assert_allclose(limits.q_upper, [3.0503, 2.2736, 3.0426, 3.0439, 2.9761, 2.9761, 4.7124])
    np.testing.assert_allclose(limits.velocity, [1.74, 1.328, 1.957, 1.957, 3.485, 3.485, 4.545])
    np.testing.assert_allclose(limits.tau_upper, [80, 80, 40, 40, 9, 9, 9])
    np.testing.assert_array_equal(limits.tau_lower, -limits.tau_upper)
    np.testing.assert_array_equal(model.upperEffortLimit, limits.tau_upper)
    np.testing.assert_array_equal(model.upperVelocityLimit, limits.velocity)
    np.testing.assert_array_equal(model.lowerPositionLimit, limits.q_lower)
    np.testing.assert_array_equal(model.upperPositionLimit, limits.q_upper)


def test_posture_reaches_the_middle_of_the_default_lift_elbow_up(frame_pose):
    agent = sawyer_agent(**GRIPPER)
    assert np.all(agent.limits.q_lower < agent.posture) and np.all(agent.posture < agent.limits.q_upper)
    q = np.r_[np.zeros(3), agent.posture]
    grasp = frame_pose(agent.model, "robot_grasp", q)[:3, 3]
    np.testing.assert_allclose(grasp, [0.85, 0.0, 1.15], atol=0.02)
    assert frame_pose(agent.model, "robot_Q4_link", q)[2, 3] > grasp[2] + 0.1


@pytest.mark.parametrize("tool", [(0.0, 0.0), (0.15, 0.4), (0.15, 0.0), (0.0, 0.4)])
def test_bodies_are_physical_with_any_tool(tool, assert_bodies_are_physical):
    agent = sawyer_agent(place=facing(1.7), base_height=0.5, tool_length=tool[0], tool_mass=tool[1])
    assert_bodies_are_physical(agent.model)
    assert agent.model.existFrame("robot_tool") == (tool != (0.0, 0.0))


@pytest.mark.parametrize(
    ("key", "change"),
    [
        ("robot.base_height", {"base_height": float("nan")}),
        ("robot.tool.length", {"tool_length": -0.01}),
        ("robot.tool.mass", {"tool_mass": "heavy"}),
    ],
)
def test_refuses_by_name(key, change):
    with pytest.raises(InputError, match="must be a number from") as error:
        sawyer_agent(**(GRIPPER | change))
    assert error.value.key == key
