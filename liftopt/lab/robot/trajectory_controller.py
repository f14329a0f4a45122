"""The trajectory controller of ROS (joint_trajectory_controller), which most robots' drivers offer.

Its documentation (control.ros.org, joint_trajectory_controller, "Trajectory representation") says what it makes of
points with positions, velocities and accelerations: quintics that meet all three. It demands every joint that it
controls by name, whatever the order, and no other, unless it is told to allow_partial_joints_goal. Without tolerances
of its own it follows to the end, however far off the arm is.
"""

from __future__ import annotations

import numpy as np

from liftopt.lab.robot.command import PERIOD, Command
from liftopt.lab.robot.joint_trajectory import JointTrajectory
from liftopt.lab.robot.quintics import Quintics
from liftopt.types import Array


def controller_curve(trajectory: JointTrajectory) -> Quintics:
    """Return what the controller makes of a trajectory, positions (n,)."""
    return Quintics.meeting(trajectory.time, trajectory.position, trajectory.velocity, trajectory.acceleration)


class TrajectoryController:
    """The controller following one trajectory with positions, in the robot's own signs."""

    outcome = "followed to the end"
    gave_up = False

    def __init__(self, trajectory: JointTrajectory) -> None:
        """Take a trajectory."""
        self._plan = controller_curve(trajectory)
        self._top = trajectory.joints.speed

    def command(self, time: float, position: Array, velocity: Array, reference: Array) -> Command:
        """Return the command of one period: the servo's reference is to be where the plan is, no faster than it may.

        Args:
            time: since the trajectory's start, 0 or later [s].
            position: (n,) measured; the controller does not look at it.
            velocity: (n,) measured, likewise.
            reference: (n,) of the arm's servo.
        """
        none = np.zeros(len(reference))
        return Command(np.clip((self._plan.at(time) - reference) / PERIOD, -self._top, self._top), none, none)
