"""A robot's part of a solved lift in the robot's own terms: joint names, signs, order, and a fixed rate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftopt.errors import InputError
from liftopt.lab.meant import the_robot
from liftopt.multibody.bounds import checked_number
from liftopt.multibody.robots.sawyer import JOINT_SIGNS
from liftopt.solution.interpolation import motion_between
from liftopt.solution.solution import Solution
from liftopt.types import Array

# Sawyer's own, base to flange; Q1 to Q7 of Table 3 in this order, the fourth with the other sign (JOINT_SIGNS).
JOINTS = tuple(f"right_j{i}" for i in range(7))
RATE = 100.0  # of the action server [Hz]
SHORTEST = 0.01  # of the last interval, as a share of the others


@dataclass(frozen=True)
class JointTrajectory:
    """A motion at K times in the robot's joint names, signs and order.

    Attributes:
        names: (7,) of the joints.
        time: (K,) from the start [s].
        position, velocity, acceleration: (K, 7) [rad, rad/s, rad/s^2].
    """

    names: tuple[str, ...]
    time: Array
    position: Array
    velocity: Array
    acceleration: Array

    @property
    def nanoseconds(self) -> tuple[int, ...]:
        """(K,) times as the integers that messages hold [ns]."""
        return tuple(round(1e9 * float(t)) for t in self.time)


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
    return JointTrajectory(JOINTS, time, *robot_motion(solution, time, robot))


def robot_motion(solution: Solution, time: Array, robot: str | None = None) -> tuple[Array, Array, Array]:
    """Return position, velocity and acceleration (T, 7) of a robot's joints, in its own signs, at ``time`` (T,)."""
    arm = the_robot(solution, robot)
    q, v, a = (JOINT_SIGNS * rows[:, arm.moving] for rows in (arm.q, arm.v, arm.a))
    return motion_between(solution.time, q, v, a, time)
