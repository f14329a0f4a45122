"""What the robot did in one trial, from a bag with sensor_msgs/JointState: angles and torques, and when it was told to.

Bags of ROS 1 and ROS 2 (SQLite and MCAP), read by the package ``rosbags``.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.extra import check_extra
from liftopt.lab.robot.export_formats import GOAL
from liftopt.lab.robot.joint_map import JointMap
from liftopt.lab.robot.ros_messages import FEEDBACK, JOINT_STATE, LOG, ROS1_GOAL, ROS2_GOAL, SECOND, TRAJECTORY
from liftopt.lab.robot.trajectory_files import TRAJECTORY_TOPIC
from liftopt.solution.interpolation import linear
from liftopt.types import Array

COMMANDS = (TRAJECTORY, ROS1_GOAL, ROS2_GOAL)
LARGEST = 1e4  # rad and Nm; no joint turns so far nor pushes so hard
SHORT = 0.02  # s that may be missing at either end: two messages
SUBSCRIBED = re.compile(r"Subscribing to (\S+)")  # rosbag record says so on /rosout, which record -a records


@dataclass(frozen=True)
class RobotRecord:
    """One trial in the n joints and signs that solutions have, Sawyer's those of Table 3; metres where a joint slides.

    Attributes:
        source: the bag.
        time: (K,) since its first joint state, on the recorder's clock [s].
        q: (K, n) angles [rad].
        tau: (K, n) efforts, as they were recorded but for the joints' signs [Nm]; None if the bag has none.
        sent: when trajectories or goals were sent, in order [s]; empty where the bag does not say.
        told_by: how that is known, in words.
        missed: when the recorder subscribed to the goal's topic, where it then caught no goal [s]; else None.
    """

    source: str
    time: Array
    q: Array
    tau: Array | None
    sent: tuple[float, ...] = ()
    told_by: str = ""
    missed: float | None = None

    def over_share(self, values: Array, share: Array, start: float, duration: float) -> Array:
        """Return ``values`` (K, n) at ``share`` (S,) of a lift from ``start`` that lasts ``duration`` [s]: (S, n).

        Raises:
            InputError: the bag begins after the lift does, or ends before.
        """
        lasts, late = float(self.time[-1]) - start, float(self.time[0]) - start
        if lasts < duration - SHORT:
            raise InputError(self.source, f"{lasts:.2f} s", f"must last the lift's {duration:g} s from its beginning")
        if late > SHORT:
            raise InputError(self.source, NO_VALUE, f"begins {late:.2f} s after the lift does")
        return linear(self.time, values, start + share * duration)


def read_robot_record(path: Path, joints: JointMap) -> RobotRecord:
    """Return one trial.

    Messages without the arm's joints (those of the gripper) are left aside.

    Args:
        path: a ROS 1 bag, or the folder of a ROS 2 bag.
        joints: of the arm.

    Raises:
        InputError: the bag cannot be read, or does not hold the arm's joint states; it names bag, topic and joint.
    """
    heard, names = _messages(path, joints.names), joints.names
    states = heard.states
    if not states:
        raise InputError(str(path), NO_VALUE, f"holds no {JOINT_STATE} with the joints {names[0]} to {names[-1]}")
    topic = max(states, key=lambda name: len(states[name]))
    where = f"{path}, topic {topic}"
    rows = [_row(where, number, message, names) for number, (_, message) in enumerate(states[topic], start=1)]
    arrived = np.array([arrival for arrival, _ in states[topic]])
    stamp = np.array([row[0] for row in rows])
    # Stamps are evener than arrivals, but they are of the robot's clock, and the goal's arrival is of the recorder's.
    stamp = stamp + round(float(np.median(arrived - stamp))) if stamp.all() else arrived
    stamp, order = np.unique(stamp, return_index=True)
    if len(stamp) < 2:
        raise InputError(where, f"{len(stamp)} messages", "must be at least two, at different times")
    q = joints.signs * np.stack([rows[k][1] for k in order])
    efforts = [rows[k][2] for k in order]
    tau = None if any(len(effort) == 0 for effort in efforts) else joints.signs * np.stack(efforts)

    def since(moments: list[int]) -> tuple[float, ...]:
        return tuple((moment - int(stamp[0])) / SECOND for moment in sorted(moments))

    sent, told_by = heard.sent
    if sent and min(sent) > stamp[-1]:
        raise InputError(where, NO_VALUE, "ends before the trajectory was sent")
    missed = next(iter(since(heard.subscribed)), None)
    return RobotRecord(str(path), (stamp - stamp[0]) / SECOND, q, tau, since(sent), told_by, missed)


@dataclass
class _Heard:
    """What a bag holds of a trial; times are arrivals [ns].

    Attributes:
        joints: of the arm.
        states: the arm's states by topic.
        commands: trajectories and goals.
        followed: by goal, when the action server began with it, as each of its feedbacks says.
        subscribed: when the recorder subscribed to the topics of goal and trajectory, as it said itself.
    """

    joints: frozenset[str]
    states: dict[str, list[tuple[int, Any]]] = field(default_factory=lambda: defaultdict(list))
    commands: list[int] = field(default_factory=list)
    followed: dict[str, list[int]] = field(default_factory=lambda: defaultdict(list))
    subscribed: list[int] = field(default_factory=list)

    @property
    def sent(self) -> tuple[list[int], str]:
        """When trajectories were sent, and how that is known."""
        if self.commands:
            return self.commands, "when the trajectory was sent"
        begun = [round(float(np.median(moments))) for moments in self.followed.values()]
        return begun, "when the action server began, as its feedback says"

    def hear(self, topic: str, kind: str, arrived: int, message: Any) -> None:
        """Take in one message of the kinds in ``HEARD``."""
        if kind in COMMANDS:
            self.commands.append(arrived)
        elif kind == FEEDBACK and self.joints <= set(message.feedback.joint_names):
            self.followed[message.status.goal_id.id].append(arrived - _moment(message.feedback.desired.time_from_start))
        elif kind == LOG and (found := SUBSCRIBED.match(message.msg)) and _is_told_on(found[1]):
            self.subscribed.append(_moment(message.header.stamp) or arrived)
        elif kind == JOINT_STATE and self.joints <= set(message.name):
            self.states[topic].append((arrived, message))


def _is_told_on(topic: str) -> bool:
    """Whether a robot is told on a topic what to do."""
    return topic == TRAJECTORY_TOPIC or topic.endswith(f"/{GOAL}")


HEARD = (JOINT_STATE, FEEDBACK, LOG, *COMMANDS)


def _messages(path: Path, joints: Sequence[str]) -> _Heard:
    check_extra("rosbags", "read ROS bags")
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    if not path.exists():
        raise InputError(str(path), NO_VALUE, "no such bag")
    heard = _Heard(frozenset(joints))
    try:
        with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
            wanted = [one for one in reader.connections if one.msgtype in HEARD]
            for one, arrived, raw in reader.messages(wanted) if wanted else ():
                # That a command arrived is all that counts, and a type store may not know its type.
                message = None if one.msgtype in COMMANDS else reader.deserialize(raw, one.msgtype)
                heard.hear(one.topic, one.msgtype, arrived, message)
    except Exception as error:  # a damaged bag fails in any layer of the package
        raise InputError(str(path), NO_VALUE, f"cannot be read as a bag: {type(error).__name__} {error}") from error
    return heard


def _row(where: str, number: int, message: Any, joints: Sequence[str]) -> tuple[int, Array, Array]:
    """Return stamp [ns], angles and efforts (n,) of the arm; no efforts where the message has none."""
    columns = [message.name.index(joint) for joint in joints]
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
        for joint, column in zip(joints, columns, strict=True):
            if not abs(values[column]) < LARGEST:  # NaN fails too
                raise InputError(
                    f"{where}, message {number}", f"{kind} of {joint} {values[column]:g}", f"must be within {LARGEST:g}"
                )
        found.append(values[columns])
    return _moment(message.header.stamp), found[0], found[1]


def _moment(stamp: Any) -> int:
    """Return a time or a duration of ROS [ns]."""
    return int(stamp.sec) * SECOND + int(stamp.nanosec)
