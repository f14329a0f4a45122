"""Messages of ROS 1 and ROS 2 for a robot's motion, without ROS: made by the package ``rosbags``.

control_msgs is in none of its type stores, so its definitions stand here: interfaces of public packages, whose fields
and constants make up their checksum.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from liftopt.lab.extra import check_extra
from liftopt.lab.robot.joint_trajectory import JointTrajectory
from liftopt.types import Array

SECOND = 1_000_000_000  # [ns]

TRAJECTORY = "trajectory_msgs/msg/JointTrajectory"
JOINT_STATE = "sensor_msgs/msg/JointState"
LOG = "rosgraph_msgs/msg/Log"
FEEDBACK = "control_msgs/msg/FollowJointTrajectoryActionFeedback"
ROS1_GOAL = "control_msgs/msg/FollowJointTrajectoryActionGoal"
ROS2_GOAL = "control_msgs/action/FollowJointTrajectory_Goal"

TOLERANCE = "string name\nfloat64 position\nfloat64 velocity\nfloat64 acceleration\n"
COMPONENT_TOLERANCE = (
    "uint16 X_AXIS=1\nuint16 Y_AXIS=2\nuint16 Z_AXIS=3\nuint16 TRANSLATION=4\nuint16 ROTATION=5\n"
    "string joint_name\nuint16 component\nfloat64 position\nfloat64 velocity\nfloat64 acceleration\n"
)
ROS1_DEFINITIONS = {
    "control_msgs/msg/JointTolerance": TOLERANCE,
    "control_msgs/msg/FollowJointTrajectoryGoal": (
        "trajectory_msgs/JointTrajectory trajectory\nJointTolerance[] path_tolerance\n"
        "JointTolerance[] goal_tolerance\nduration goal_time_tolerance\n"
    ),
    ROS1_GOAL: "Header header\nactionlib_msgs/GoalID goal_id\nFollowJointTrajectoryGoal goal\n",
}
ROS2_DEFINITIONS = {
    "control_msgs/msg/JointTolerance": TOLERANCE,
    "control_msgs/msg/JointComponentTolerance": COMPONENT_TOLERANCE,
    ROS2_GOAL: (
        "trajectory_msgs/msg/JointTrajectory trajectory\n"
        "trajectory_msgs/msg/MultiDOFJointTrajectory multi_dof_trajectory\n"
        "control_msgs/msg/JointTolerance[] path_tolerance\n"
        "control_msgs/msg/JointComponentTolerance[] component_path_tolerance\n"
        "control_msgs/msg/JointTolerance[] goal_tolerance\n"
        "control_msgs/msg/JointComponentTolerance[] component_goal_tolerance\n"
        "builtin_interfaces/msg/Duration goal_time_tolerance\n"
    ),
}


@dataclass(frozen=True)
class RosMessages:
    """Makes the messages of one generation of ROS.

    Attributes:
        ros1: whether it is ROS 1 (Noetic); else ROS 2 (Humble).
        store: the type store of ``rosbags`` with control_msgs added.
    """

    ros1: bool
    store: Any

    @classmethod
    def of(cls, ros1: bool) -> RosMessages:
        """Return the messages of ROS 1 or ROS 2; raises InputError where ``rosbags`` is not installed."""
        check_extra("rosbags", "write ROS bags")
        from rosbags import typesys

        store = typesys.get_typestore(typesys.Stores.ROS1_NOETIC if ros1 else typesys.Stores.ROS2_HUMBLE)
        types: dict[str, Any] = {}
        for name, text in (ROS1_DEFINITIONS if ros1 else ROS2_DEFINITIONS).items():
            types |= typesys.get_types_from_msg(text, name)
        store.register(types)
        return cls(ros1, store)

    def trajectory(self, trajectory: JointTrajectory, stamp: int = 0) -> Any:
        """Return a trajectory_msgs/JointTrajectory; ``stamp`` [ns] 0 means "start when it arrives"."""
        points = [
            self._make(
                "trajectory_msgs/msg/JointTrajectoryPoint",
                positions=trajectory.position[k],
                velocities=trajectory.velocity[k],
                accelerations=trajectory.acceleration[k],
                effort=np.empty(0),
                time_from_start=self._duration(at),
            )
            for k, at in enumerate(trajectory.nanoseconds)
        ]
        return self._make(TRAJECTORY, header=self._header(stamp), joint_names=list(trajectory.names), points=points)

    def goal(self, trajectory: JointTrajectory, goal_time: float, stamp: int = 0) -> tuple[str, Any]:
        """Return type and message that ask the action server to follow a trajectory.

        Tolerances are left to the server.

        Args:
            trajectory: to follow.
            goal_time: how long after its end the server may go on [s].
            stamp: when it is sent [ns].
        """
        common = dict(
            trajectory=self.trajectory(trajectory),
            path_tolerance=[],
            goal_tolerance=[],
            goal_time_tolerance=self._duration(round(goal_time * SECOND)),
        )
        if self.ros1:
            goal = self._make("control_msgs/msg/FollowJointTrajectoryGoal", **common)
            identity = self._make("actionlib_msgs/msg/GoalID", stamp=self._time(stamp), id="")
            return ROS1_GOAL, self._make(ROS1_GOAL, header=self._header(stamp), goal_id=identity, goal=goal)
        none = self._make(
            "trajectory_msgs/msg/MultiDOFJointTrajectory", header=self._header(0), joint_names=[], points=[]
        )
        more = dict(multi_dof_trajectory=none, component_path_tolerance=[], component_goal_tolerance=[])
        return ROS2_GOAL, self._make(ROS2_GOAL, **common, **more)

    def joint_state(self, stamp: int, names: Sequence[str], position: Array, velocity: Array, effort: Array) -> Any:
        """Return a sensor_msgs/JointState taken at ``stamp`` [ns]; arrays (n,) [rad, rad/s, Nm]."""
        return self._make(
            JOINT_STATE,
            header=self._header(stamp),
            name=list(names),
            position=np.array(position, float),
            velocity=np.array(velocity, float),
            effort=np.array(effort, float),
        )

    def serialized(self, message: Any, kind: str) -> bytes:
        """Return a message of type ``kind`` as its generation of ROS stores it."""
        return bytes(self.store.serialize_ros1(message, kind) if self.ros1 else self.store.serialize_cdr(message, kind))

    def _make(self, kind: str, **fields: Any) -> Any:
        return self.store.types[kind](**fields)

    def _header(self, stamp: int) -> Any:
        sequence = {"seq": 0} if self.ros1 else {}
        return self._make("std_msgs/msg/Header", **sequence, stamp=self._time(stamp), frame_id="")

    def _time(self, stamp: int) -> Any:
        return self._make("builtin_interfaces/msg/Time", sec=stamp // SECOND, nanosec=stamp % SECOND)

    def _duration(self, span: int) -> Any:
        return self._make("builtin_interfaces/msg/Duration", sec=span // SECOND, nanosec=span % SECOND)
