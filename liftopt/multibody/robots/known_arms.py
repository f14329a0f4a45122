"""The arms of example-robot-data 6.0.0, with published payloads and where those come from.

Both arms of a robot with two are entries of their own; trunks and lifting columns are held at zero unless the name says
that they move. Payloads are of the arm without a gripper unless their source says otherwise.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from liftopt.multibody.robots.known_robot import KnownRobot
from liftopt.multibody.sources import Source

UR, PAL, RETHINK, IIT = "Universal Robots", "PAL Robotics", "Rethink Robotics", "Istituto Italiano di Tecnologia"
SIDES = (("left", "l"), ("right", "r"))
# Masses of the hands beyond the flange, as the URDFs have them [kg].
PANDA_HAND, TIAGO_HAND = 0.76, 0.933


def _published(maker: str) -> Source:
    return Source(f"{maker}, published specification", "unverified")


STASSE_2017 = Source(
    "Stasse et al. (2017), TALOS: a new humanoid research platform targeted for industrial applications, Humanoids: "
    "6 kg with an out-stretched arm",
    "verified",
)
WILLOW_GARAGE = Source("Willow Garage, PR2 hardware systems: the arms have a payload of 1.8 kg", "verified")
UNITREE = Source("Unitree, Z1 specification: payload at least 3 kg", "verified")
BAXTER = Source("Machine Design, 16 October 2012: its hands pick up 5 lb payloads", "secondary")
# Both are general knowledge about these robots; their URDFs do not say it.
PR2_SPRINGS = "springs bear the weight of shoulder and elbow"
BAXTER_SPRINGS = "springs bear part of the weight at the second joint of the shoulder"


def _universal() -> Iterator[KnownRobot]:
    folder = "ur_description/urdf"
    for model, payload, file in (
        ("UR3", 3.0, "ur3_robot"),
        ("UR5", 5.0, "ur5_robot"),
        ("UR10", 10.0, "ur10_robot"),
        ("UR3, joints within half a turn", 3.0, "ur3_joint_limited_robot"),
        ("UR5, joints within half a turn", 5.0, "ur5_joint_limited_robot"),
        ("UR10, joints within half a turn", 10.0, "ur10_joint_limited_robot"),
        ("UR3 with gripper", 3.0, "ur3_gripper"),
        ("UR5 with gripper", 5.0, "ur5_gripper"),
    ):
        name = file.replace("_joint_limited_robot", "_limited").removesuffix("_robot")
        yield KnownRobot(name, model, UR, f"{folder}/{file}.urdf", "world", "tool0", payload=payload,
                         payload_source=_published(UR))  # fmt: skip


def _two_arms(name: str, title: str, maker: str, file: str, base: str, frame: str, **more: Any) -> Iterator[KnownRobot]:
    """Give both arms of a robot; ``{side}`` and ``{s}`` in the frame stand for left and l, or right and r."""
    for side, short in SIDES:
        grasp_frame = frame.format(side=side, s=short, S=short.upper())
        yield KnownRobot(f"{name}_{side}", f"{title}, {side} arm", maker, file, base, grasp_frame, **more)


def known_arms() -> Iterator[KnownRobot]:
    """Give all of them, installed or not."""
    yield from _universal()
    yield KnownRobot("panda", "Panda with hand", "Franka Emika", "panda_description/urdf/panda.urdf", "panda_link0",
                     "panda_hand_tcp", payload=3.0, payload_source=_published("Franka Emika"),
                     hand=PANDA_HAND)  # fmt: skip
    yield KnownRobot("kinova", "Jaco 2, six joints, two fingers", "Kinova", "kinova_description/robots/kinova.urdf",
                     "base", "j2s6s200_end_effector")  # fmt: skip
    yield KnownRobot("xarm7", "xArm 7", "UFACTORY", "xarm_description/urdf/xarm7.urdf", "world", "link_eef",
                     payload=3.5, payload_source=_published("UFACTORY"))  # fmt: skip
    yield KnownRobot("z1", "Z1 with gripper", "Unitree", "z1_description/urdf/z1.urdf", "world", "gripperStator",
                     payload=3.0, payload_source=UNITREE)  # fmt: skip
    yield KnownRobot("so100", "SO-ARM100", "The Robot Studio", "so_arm_description/urdf/so100.urdf", "base", "gripper",
                     direction="-y", front_deg=-90.0)  # fmt: skip
    yield KnownRobot("so101", "SO-ARM101", "The Robot Studio", "so_arm_description/urdf/so101.urdf", "base_link",
                     "gripper_frame_link")  # fmt: skip
    yield from _two_arms("baxter", "Baxter", RETHINK, "baxter_description/urdf/baxter.urdf", "base", "{side}_gripper",
                         payload=2.27, payload_source=BAXTER, springs=BAXTER_SPRINGS)  # fmt: skip
    tiago = "tiago_description/robots/tiago.urdf"
    payload: dict[str, Any] = {"payload": 3.0, "payload_source": _published(PAL)}
    column = {"torso_lift_joint": 0.0}
    yield KnownRobot("tiago", "TIAGo", PAL, tiago, "base_footprint", "hand_tool_link", column, **payload,
                     hand=TIAGO_HAND)  # fmt: skip
    yield KnownRobot("tiago_lifting", "TIAGo, its column moves", PAL, tiago, "base_footprint", "hand_tool_link",
                     **payload, hand=TIAGO_HAND)  # fmt: skip
    yield KnownRobot("tiago_no_hand", "TIAGo without hand", PAL, "tiago_description/robots/tiago_no_hand.urdf",
                     "base_footprint", "wrist_ft_tool_link", column, **payload)  # fmt: skip
    yield from _two_arms("tiago_dual", "TIAGo with two arms", PAL, "tiago_description/robots/tiago_dual.urdf",
                         "base_footprint", "hand_{side}_tool_link", locked=column, **payload,
                         hand=TIAGO_HAND)  # fmt: skip
    yield from _two_arms("tiago_pro", "TIAGo Pro", PAL, "tiago_pro_description/robots/tiago_pro.urdf",
                         "base_footprint", "gripper_{side}_base_link", locked=column)  # fmt: skip
    yield from _two_arms("talos", "TALOS", PAL, "talos_data/robots/talos_full_v2.urdf", "base_link",
                         "gripper_{side}_base_link", locked={"torso_1_joint": 0.0, "torso_2_joint": 0.0}, payload=6.0,
                         payload_source=STASSE_2017)  # fmt: skip
    trunk = {"torso_pitch": 0.0, "torso_roll": 0.0, "torso_yaw": 0.0}
    yield from _two_arms("icub", "iCub", IIT, "icub_description/robots/icub.urdf", "base_link", "{s}_gripper",
                         locked=trunk, front_deg=180.0, y_up=True)  # fmt: skip
    yield from _two_arms("pr2", "PR2", "Willow Garage", "pr2_description/urdf/pr2.urdf", "base_footprint",
                         "{s}_gripper_tool_frame", locked={"torso_lift_joint": 0.0115}, payload=1.8,
                         payload_source=WILLOW_GARAGE, springs=PR2_SPRINGS)  # fmt: skip
    yield from _two_arms("romeo", "Romeo", "Aldebaran", "romeo_description/urdf/romeo.urdf", "base_link",
                         "{s}_gripper", locked={"TrunkYaw": 0.0})  # fmt: skip
    for side, number in (("left", 1), ("right", 2)):
        yield KnownRobot(f"centauro_{side}", f"Centauro, {side} arm", IIT, "centauro_description/urdf/centauro.urdf",
                         "pelvis", f"arm{number}_8", {"torso_yaw": 0.0})  # fmt: skip
    waist = {f"waist_{axis}_joint": 0.0 for axis in ("yaw", "roll", "pitch")}
    yield from _two_arms("g1", "G1", "Unitree", "g1_description/urdf/g1_29dof_rev_1_0.urdf", "pelvis",
                         "{side}_rubber_hand", locked=waist)  # fmt: skip
    spine = {f"Spine{axis}": 0.0 for axis in ("Yaw", "Roll", "Pitch")}
    yield from _two_arms("alex", "Alex", "IHMC and Boardwalk Robotics", "alex_description/urdf/alex_nub_hands.urdf",
                         "Pelvis", "{side}Nub", locked=spine)  # fmt: skip
