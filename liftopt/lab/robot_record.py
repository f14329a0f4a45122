"""What the robot did in one trial, from a bag with sensor_msgs/JointState: angles and torques over the lift.

Bags of ROS 1 and ROS 2 (SQLite and MCAP), read by the package ``rosbags``.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from liftopt.errors import NO_VALUE, InputError
from liftopt.interpolation import linear
from liftopt.lab.extra import check_extra
from liftopt.lab.joint_trajectory import JOINTS
from liftopt.lab.ros_messages import JOINT_STATE, ROS1_GOAL, ROS2_GOAL, SECOND, TRAJECTORY
from liftopt.multibody.sawyer import JOINT_SIGNS

Array = npt.NDArray[np.float64]

COMMANDS = (TRAJECTORY, ROS1_GOAL, ROS2_GOAL)
MOVED = 0.005  # rad: farther than this from its first pose, the arm has begun to move
LARGEST = 1e4  # rad and Nm; no joint turns so far nor pushes so hard
SHORT = 0.02  # s that may be missing at the end: two messages


@dataclass(frozen=True)
class RobotRecord:
    """One trial in the joints and signs of Table 3, as solutions have them.

    Attributes:
        source: the bag.
        time: (K,) since the lift began [s].
        q: (K, 7) angles [rad].
        tau: (K, 7) efforts, as they were recorded but for the joints' signs [Nm]; None if the bag has none.
        began: how the lift's beginning was found, in words.
    """

    source: str
    time: Array
    q: Array
    tau: Array | None
    began: str

    def over_share(self, values: Array, share: Array, duration: float) -> Array:
        """Return ``values`` (K, 7) at ``share`` (S,) of a lift that lasts ``duration`` [s]: (S, 7).

        Raises:
            InputError: the bag ends before the lift does.
        """
        if self.time[-1] < duration - SHORT:
            raise InputError(
                self.source, f"{self.time[-1]:.2f} s", f"must last the lift's {duration:g} s from its beginning"
            )
        return linear(self.time, values, share * duration)


def read_robot_record(path: Path) -> RobotRecord:
    """Return one trial.

    The lift begins when the last trajectory or goal arrived, where the bag holds one, else when the arm begins to move.
    Messages without the arm's joints (those of the gripper) are left aside.

    Args:
        path: a ROS 1 bag, or the folder of a ROS 2 bag.

    Raises:
        InputError: the bag cannot be read, or does not hold the arm's joint states; it names bag, topic and joint.
    """
    states, commands = _messages(path)
    if not states:
        raise InputError(str(path), NO_VALUE, f"holds no {JOINT_STATE} with the joints {JOINTS[0]} to {JOINTS[-1]}")
    topic = max(states, key=lambda name: len(states[name]))
    where = f"{path}, topic {topic}"
    rows = [_row(where, number, *entry) for number, entry in enumerate(states[topic], start=1)]
    stamp = np.array([row[0] for row in rows])
    if not stamp.all():  # a publisher without a clock: the recorder's must do
        stamp = np.array([arrived for arrived, _ in states[topic]])
    stamp, order = np.unique(stamp, return_index=True)
    if len(stamp) < 2:
        raise InputError(where, f"{len(stamp)} messages", "must be at least two, at different times")
    q = JOINT_SIGNS * np.stack([rows[k][1] for k in order])
    efforts = [rows[k][2] for k in order]
    tau = None if any(len(effort) == 0 for effort in efforts) else JOINT_SIGNS * np.stack(efforts)
    if commands:
        start, began = max(commands), "when the trajectory was sent"
    else:
        away = np.abs(q - q[0]).max(axis=1) > MOVED
        if not away.any():
            raise InputError(where, NO_VALUE, f"the arm does not move by {MOVED:g} rad")
        start, began = int(stamp[max(int(np.argmax(away)) - 1, 0)]), f"when the arm had moved {MOVED:g} rad"
    if start > stamp[-1]:
        raise InputError(where, NO_VALUE, "ends before the trajectory was sent")
    return RobotRecord(str(path), (stamp - start) / SECOND, q, tau, began)


def _messages(path: Path) -> tuple[dict[str, list[tuple[int, Any]]], list[int]]:
    """Return the arm's states with their arrival [ns] by topic, and when trajectories or goals arrived [ns]."""
    check_extra("rosbags", "read ROS bags")
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    if not path.exists():
        raise InputError(str(path), NO_VALUE, "no such bag")
    states: dict[str, list[tuple[int, Any]]] = defaultdict(list)
    commands: list[int] = []
    try:
        with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
            wanted = [one for one in reader.connections if one.msgtype in (JOINT_STATE, *COMMANDS)]
            for one, arrived, raw in reader.messages(wanted) if wanted else ():
                if one.msgtype != JOINT_STATE:
                    commands.append(arrived)
                    continue
                message: Any = reader.deserialize(raw, one.msgtype)
                if set(JOINTS) <= set(message.name):
                    states[one.topic].append((arrived, message))
    except Exception as error:  # a damaged bag fails in any layer of the package
        raise InputError(str(path), NO_VALUE, f"cannot be read as a bag: {type(error).__name__} {error}") from error
    return states, commands


def _row(where: str, number: int, arrived: int, message: Any) -> tuple[int, Array, Array]:
    """Return stamp [ns], angles and efforts (7,) of the arm; no efforts where the message has none."""
    columns = [message.name.index(joint) for joint in JOINTS]
    found = []
    fields: tuple[tuple[str, Callable[[], Any]], ...] = (
        ("position", lambda: message.position),
        ("effort", lambda: message.effort),
    )
    for kind, get in fields:
        values = np.asarray(get(), float)
        if kind == "effort" and len(values) == 0:
            found.append(values)
            continue
        if len(values) != len(message.name):
            raise InputError(
                f"{where}, message {number}", f"{len(values)} of {kind}", f"names {len(message.name)} joints"
            )
        for joint, column in zip(JOINTS, columns, strict=True):
            if not abs(values[column]) < LARGEST:  # NaN fails too
                raise InputError(
                    f"{where}, message {number}", f"{kind} of {joint} {values[column]:g}", f"must be within {LARGEST:g}"
                )
        found.append(values[columns])
    stamp = message.header.stamp
    return int(stamp.sec) * SECOND + int(stamp.nanosec), found[0], found[1]
