"""A robot's part of a solved lift in the robot's own terms: joint names, signs, order, and a fixed rate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftopt.errors import InputError
from liftopt.lab.meant import the_robot
from liftopt.lab.robot.joint_map import JointMap
from liftopt.multibody.bounds import checked_number
from liftopt.solution.interpolation import motion_between
from liftopt.solution.solution import Solution
from liftopt.types import Array

RATE = 100.0  # of trajectory controllers, Sawyer's action server among them [Hz]
SHORTEST = 0.01  # of the last interval, as a share of the others


@dataclass(frozen=True)
class JointTrajectory:
    """A motion at K times in the robot's joint names, signs and order.

    Attributes:
        joints: the robot's n.
        time: (K,) from the start [s].
        position, velocity, acceleration: (K, n) [rad, rad/s, rad/s^2; m, m/s, m/s^2 where a joint slides].
    """

    joints: JointMap
    time: Array
    position: Array
    velocity: Array
    acceleration: Array

    @property
    def names(self) -> tuple[str, ...]:
        """(n,) of the joints."""
        return self.joints.names

    @property
    def nanoseconds(self) -> tuple[int, ...]:
        """(K,) times as the integers that messages hold [ns]."""
        return tuple(round(1e9 * float(t)) for t in self.time)

    def with_held(self) -> JointTrajectory:
        """Return it with the joints that are held, at rest where they are held, after those that move."""
        still = np.tile([value for _, value in self.joints.held], (len(self.time), 1))
        velocity, acceleration = (np.hstack([rows, 0.0 * still]) for rows in (self.velocity, self.acceleration))
        position = np.hstack([self.position, still])
        return JointTrajectory(self.joints.with_held(), self.time, position, velocity, acceleration)


def joint_trajectory(solution: Solution, rate: float = RATE, robot: str | None = None) -> JointTrajectory:
    """Return a robot's motion of a solution from its spline, at ``rate`` and at its end.

    Args:
        solution: a solved lift.
        rate: points a second [Hz]; the last interval is shorter where the duration is no multiple.
        robot: its name; None where there is only one.

    Raises:
        InputError: the solution is not solved, the rate is out of range, or no robot is the one that is meant.
    """
    if not solution.solved:
        raise InputError("RESULT", solution.status, "must be a solved and verified lift to move a robot")
    rate = checked_number("--rate", rate, 10.0, 1000.0, "Hz")
    duration = float(solution.time[-1])
    time = np.append(np.arange(int(np.ceil(duration * rate - SHORTEST))) / rate, duration)
    return trajectory_at(solution, time, robot)


def trajectory_at(solution: Solution, time: Array, robot: str | None = None) -> JointTrajectory:
    """Return a robot's motion at ``time`` (K,), the solution solved or not."""
    return JointTrajectory(JointMap.of(solution, robot), time, *robot_motion(solution, time, robot))


def robot_motion(solution: Solution, time: Array, robot: str | None = None) -> tuple[Array, Array, Array]:
    """Return position, velocity and acceleration (T, n) of a robot's joints, in its own signs, at ``time`` (T,)."""
    arm, signs = the_robot(solution, robot), JointMap.of(solution, robot).signs
    q, v, a = (signs * rows[:, arm.moving] for rows in (arm.q, arm.v, arm.a))
    return motion_between(solution.time, q, v, a, time)
