"""A robot's trajectory as files: bags for ROS 1, ROS 2 and MCAP, CSV, JSON and URScript."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from pathlib import Path

from liftopt.lab.robot.bags import Kind, Record, write_bag
from liftopt.lab.robot.joint_trajectory import JointTrajectory
from liftopt.lab.robot.ros_messages import SECOND, TRAJECTORY, RosMessages

NAME = "trajectory"
TRAJECTORY_TOPIC = "/liftopt/joint_trajectory"  # nobody listens here
KINDS: dict[str, Kind] = {"ros1": "ros1", "ros2": "ros2", "mcap": "mcap"}


def write_trajectory(
    trajectory: JointTrajectory, folder: Path, formats: Iterable[str], goal_time: float, topic: str
) -> list[Path]:
    """Write a trajectory in each of ``formats`` and return the files, and folders of ROS 2.

    Args:
        trajectory: to write.
        folder: to write into; it exists and is empty.
        formats: bags, ``"csv"`` or ``"json"``.
        goal_time: of the goal, see ``RosMessages.goal`` [s].
        topic: on which the controller hears goals.

    Raises:
        InputError: ``rosbags`` is needed and not installed.
        OSError: a file cannot be written.
    """
    return [_write(trajectory, folder, kind, goal_time, topic) for kind in dict.fromkeys(formats)]


def write_text(text: str, folder: Path, suffix: str) -> Path:
    """Write a text as the trajectory's file of that suffix and return it.

    Raises:
        OSError: it cannot be written.
    """
    path = folder / f"{NAME}.{suffix}"
    path.write_text(text, encoding="utf-8", newline="\n")
    return path


def csv_text(trajectory: JointTrajectory) -> str:
    """Return one line a point: time [s], positions [rad], velocities [rad/s], accelerations [rad/s^2].

    The time and the positions by joint come first: of Sawyer, its manufacturer's joint_trajectory_file_playback.py
    takes those by name and leaves the others. Metres where a joint slides. Numbers are written so that they are read
    back without loss.
    """
    kinds = ("", "velocity_", "acceleration_")
    lines = [",".join(["time", *(kind + name for kind in kinds for name in trajectory.names)])]
    for k, time in enumerate(trajectory.time):
        rows = (trajectory.position[k], trajectory.velocity[k], trajectory.acceleration[k])
        lines.append(",".join(repr(float(x)) for x in (time, *(x for row in rows for x in row))))
    return "\n".join(lines) + "\n"


def json_text(trajectory: JointTrajectory, goal_time: float) -> str:
    """Return a control_msgs/FollowJointTrajectoryGoal of ROS 1 as rosbridge writes messages."""
    points = [
        {
            "positions": trajectory.position[k].tolist(),
            "velocities": trajectory.velocity[k].tolist(),
            "accelerations": trajectory.acceleration[k].tolist(),
            "effort": [],
            "time_from_start": _span(at),
        }
        for k, at in enumerate(trajectory.nanoseconds)
    ]
    header = {"seq": 0, "stamp": _span(0), "frame_id": ""}
    goal = {
        "trajectory": {"header": header, "joint_names": list(trajectory.names), "points": points},
        "path_tolerance": [],
        "goal_tolerance": [],
        "goal_time_tolerance": _span(round(goal_time * SECOND)),
    }
    return json.dumps(goal, indent=1, allow_nan=False) + "\n"


def goal_records(
    messages: RosMessages, trajectory: JointTrajectory, goal_time: float, stamp: int, topic: str
) -> Iterator[Record]:
    """Yield the trajectory and, on ``topic``, the goal that asks for it as they arrive at ``stamp`` [ns]."""
    kind, goal = messages.goal(trajectory, goal_time)
    yield Record(TRAJECTORY_TOPIC, TRAJECTORY, stamp, messages.trajectory(trajectory))
    yield Record(topic, kind, stamp, goal)


def _write(trajectory: JointTrajectory, folder: Path, kind: str, goal_time: float, topic: str) -> Path:
    if kind not in KINDS:
        return write_text(csv_text(trajectory) if kind == "csv" else json_text(trajectory, goal_time), folder, kind)
    messages = RosMessages.of(ros1=kind == "ros1")
    # A bag must not begin at time 0, which ROS takes for "no time".
    records = goal_records(messages, trajectory, goal_time, SECOND, topic)
    return write_bag(folder / NAME, KINDS[kind], messages, records)


def _span(nanoseconds: int) -> dict[str, int]:
    return {"secs": nanoseconds // SECOND, "nsecs": nanoseconds % SECOND}
