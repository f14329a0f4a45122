"""Robots from outside as agents. Oracle: Pinocchio on the very file that was read, joints held where we hold them."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

pytest.importorskip("yourdfpy")

from liftopt.multibody.robots.chain import robot_chain
from liftopt.multibody.robots.example_robot_data import share_folder
from liftopt.multibody.robots.read_robot import read_robot
from liftopt.multibody.robots.robot_agent import robot_agent
from liftopt.multibody.solids import solids_of
from liftopt.storage.urdf_check import check_urdf

SHARE = share_folder()
TOLERANCE = 1e-9
# File, base, grasp frame, joints that are held.
ARMS = {
    "ur5": ("ur_description/urdf/ur5_robot.urdf", "world", "tool0", {}),
    "ur10": ("ur_description/urdf/ur10_robot.urdf", "base_link", "tool0", {}),
    "panda": ("panda_description/urdf/panda.urdf", "panda_link0", "panda_hand_tcp", {"panda_finger_joint1": 0.02}),
    "kinova": ("kinova_description/robots/kinova.urdf", "base", "j2s6s200_end_effector", {}),
    "baxter": ("baxter_description/urdf/baxter.urdf", "base", "right_gripper", {"left_s0": 0.5}),
    "tiago": ("tiago_description/robots/tiago.urdf", "base_footprint", "hand_tool_link", {}),
    "tiago_locked": ("tiago_description/robots/tiago.urdf", "base_link", "hand_tool_link", {"torso_lift_joint": 0.2}),
    "icub": ("icub_description/robots/icub.urdf", "base_link", "r_gripper", {"torso_pitch": 0.1, "torso_yaw": -0.2}),
    "talos": ("talos_data/robots/talos_full_v2.urdf", "torso_2_link", "gripper_left_base_link", {}),
    "pr2": ("pr2_description/urdf/pr2.urdf", "base_footprint", "l_gripper_tool_frame", {}),
}
needs_robots = pytest.mark.skipif(SHARE is None, reason="example-robot-data is not installed (it is in 'test')")


def _original(path, chain):
    """Return the file's model without the joints that are held, and which of its velocities are the chain's."""
    full = pin.buildModelFromUrdf(str(path))
    q = pin.neutral(full)
    for name, position in chain.held.items():
        _put(full, q, name, position)
    moving = {joint.name for joint in chain.joints}
    reduced = pin.buildReducedModel(full, [i for i, n in enumerate(full.names) if i and n not in moving], q)
    return reduced, [reduced.joints[reduced.getJointId(joint.name)].idx_v for joint in chain.joints]


def _put(model, q, name, position):
    joint = model.joints[model.getJointId(name)]
    if joint.nq == 2:  # without end: cosine and sine
        q[joint.idx_q : joint.idx_q + 2] = np.cos(position), np.sin(position)
    else:
        q[joint.idx_q] = position


def _mass_matrix(model, data, q):
    upper = np.triu(pin.crba(model, data, q))
    return upper + np.triu(upper, 1).T


@needs_robots
@pytest.mark.parametrize("name", ARMS)
def test_motion_mass_and_gravity_are_those_of_the_file(name):
    file, base, grasp_frame, locked = ARMS[name]
    path = SHARE / "robots" / file
    description, place = read_robot(path), np.asarray(pin.SE3(pin.rpy.rpyToMatrix(0.3, -2.0, 0.7), np.ones(3)))
    agent = robot_agent(description, name="ann", T_world_base=place, base=base, grasp_frame=grasp_frame, locked=locked)
    check_urdf(agent.urdf)
    chain = robot_chain(description, grasp_frame, base=base, locked=locked)
    assert agent.moving_joints == tuple(f"ann_{joint.name}" for joint in chain.joints)
    model, columns = _original(path, chain)
    theirs, ours, rng = model.createData(), agent.model.createData(), np.random.default_rng(4)
    for angles in rng.uniform(agent.limits.q_lower, agent.limits.q_upper, (8, agent.model.nq)):
        q = pin.neutral(model)
        for joint, angle in zip(chain.joints, angles, strict=True):
            _put(model, q, joint.name, angle)
        pin.framesForwardKinematics(model, theirs, q)
        pin.framesForwardKinematics(agent.model, ours, angles)
        seen = theirs.oMf[model.getFrameId(base)].inverse() * theirs.oMf[model.getFrameId(grasp_frame)]
        hand = ours.oMf[agent.model.getFrameId("ann_grasp")]
        np.testing.assert_allclose(hand.homogeneous, place @ seen.homogeneous, rtol=0.0, atol=TOLERANCE)
        expected = _mass_matrix(model, theirs, q)[np.ix_(columns, columns)]
        np.testing.assert_allclose(_mass_matrix(agent.model, ours, angles), expected, rtol=0.0, atol=TOLERANCE)
        # Their base stands otherwise in the world than ours: gravity is turned along.
        model.gravity.linear = theirs.oMf[model.getFrameId(base)].rotation @ place[:3, :3].T @ [0.0, 0.0, -9.81]
        weight = pin.computeGeneralizedGravity(model, theirs, q)[columns]
        np.testing.assert_allclose(
            pin.computeGeneralizedGravity(agent.model, ours, angles), weight, rtol=0.0, atol=TOLERANCE
        )


def test_a_tool_extends_the_grasp_frame_along_its_z_axis(arm):
    bare, tooled = (
        robot_agent(read_robot(arm()), name="robot", T_world_base=np.eye(4), tool_length=length, tool_mass=mass)
        for length, mass in ((0.0, 0.0), (0.2, 1.5))
    )
    hands = []
    for agent in (bare, tooled):
        data = agent.model.createData()
        pin.framesForwardKinematics(agent.model, data, np.full(4, 0.3))
        hands.append(data.oMf[agent.model.getFrameId("robot_grasp")].copy())
    np.testing.assert_allclose((hands[0].inverse() * hands[1]).translation, [0.0, 0.0, 0.2], rtol=0.0, atol=1e-12)
    total = [sum(inertia.mass for inertia in list(agent.model.inertias)[1:]) for agent in (bare, tooled)]
    assert total[1] - total[0] == pytest.approx(1.5, abs=1e-12)
    check_urdf(tooled.urdf)


def test_shapes_become_solids_whose_names_can_be_read(arm):
    agent = robot_agent(read_robot(arm()), name="ann", T_world_base=np.eye(4), tool_length=0.2)
    told = [solid.told for solid in solids_of(agent)]
    assert told == ["l1 of ann", "l2 of ann", "l3 of ann", "l4 of ann", "base of ann", "gripper of ann"]


def test_names_never_clash_between_two_robots_or_a_link_and_a_joint(arm):
    text = arm(('joint name="j2"', 'joint name="l3"'), ('"l4"', '"grasp"'), ('"tool0"', '"tool"'))
    agents = [
        robot_agent(read_robot(text), name=name, T_world_base=np.eye(4), tool_length=0.1) for name in ("left", "right")
    ]
    frames = [[frame.name for frame in agent.model.frames] for agent in agents]
    assert set(frames[0]) & set(frames[1]) == {"universe", "world"}
    for agent, names in zip(agents, frames, strict=True):
        check_urdf(agent.urdf)
        assert names.count(f"{agent.name}_grasp") == 1
        assert agent.T_world_base.shape == (4, 4)
    assert agents[0].moving_joints == ("left_j1", "left_l3", "left_j3", "left_j4")
