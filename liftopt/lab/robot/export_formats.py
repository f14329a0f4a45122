"""In which formats a robot's motion is written, and where its controller listens."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, get_args

from liftopt.errors import InputError
from liftopt.lab.robot.joint_map import JointMap
from liftopt.lab.robot.urscript import is_universal

Format = Literal["ros1", "ros2", "mcap", "csv", "json", "urscript"]
BAGS: tuple[Format, ...] = ("ros1", "ros2", "mcap")
ALL: tuple[Format, ...] = get_args(Format)
CONTROLLER = "/joint_trajectory_controller"  # as ROS's own is usually called
STATES = "/joint_states"
SAWYER_STATES = "/robot/joint_states"
SAWYER_LIMB = "/robot/limb/right"
GOAL = "follow_joint_trajectory/goal"
LONGEST = 200  # characters of a controller's name


def formats_of(joints: JointMap) -> tuple[Format, ...]:
    """Return what a robot's motion can be written as."""
    return ALL if is_universal(joints) else tuple(one for one in ALL if one != "urscript")


def asked_formats(asked: Sequence[str], joints: JointMap) -> tuple[Format, ...]:
    """Return the formats that are asked for, each once; nothing, or ``"all"``, asks for all.

    Raises:
        InputError: one is not for this robot.
    """
    allowed = formats_of(joints)
    if not asked or "all" in asked:
        return allowed
    if "urscript" in asked and "urscript" not in allowed:
        only = "urscript is for the arms of Universal Robots"
        raise InputError("--format", "urscript", f"must be one of {', '.join(allowed)} for this robot ({only})")
    return tuple(sorted((one for one in allowed if one in asked), key=list(asked).index))


def goal_topic(joints: JointMap, controller: str | None = None) -> str:
    """Return the topic on which a robot's controller hears goals.

    Args:
        joints: of the robot.
        controller: its name, with the namespace; None takes Sawyer's, or what ROS's own is usually called.

    Raises:
        InputError: it is no name of ROS.
    """
    name = controller if controller is not None else SAWYER_LIMB if joints.is_sawyer else CONTROLLER
    parts = name.strip("/").split("/")
    sound = all(part.isascii() and part.replace("_", "a").isalnum() and not part[0].isdigit() for part in parts if part)
    if not sound or not all(parts) or len(name) > LONGEST:
        raise InputError("--controller", name, "must be a name of ROS, such as /arm_controller")
    return f"/{'/'.join(parts)}/{GOAL}"


def state_topic(joints: JointMap) -> str:
    """Return the topic on which a robot says where its joints are."""
    return SAWYER_STATES if joints.is_sawyer else STATES


def state_and_goal(joints: JointMap) -> str:
    """Return both topics, as ``rosbag record`` takes them."""
    return f"{state_topic(joints)} {goal_topic(joints)}"
