"""Sawyer's joint trajectory action server, and what its modes ask of the arm at 100 Hz (-r 100).

Read from the manufacturer's intera_sdk, commit 6614dec (Apache-2.0): intera_joint_trajectory_action, its minjerk.py
and the defaults in intera_interface/cfg. The server knows three modes; ``torque`` is a client of the arm's torque
interface that streams the solved torques at 1 kHz, with the springs of joint_torque_springs.py at their stiffest.

- ``velocity``: velocity = kp (planned - measured position), kp = 2 /s, no integral, no feed-forward, no tolerance. In
  steady motion the arm is 1/kp = 0.5 s late. When the goal time is over the server commands zero velocity, wherever
  the arm is.
- ``position``: the planned position; the arm goes there at no more than 0.3 of each joint's top speed unless told
  otherwise (set_joint_position_speed). The server gives up where a joint is 0.2 rad off.
- ``position_w_id``, its default: position, velocity and acceleration, which the arm feeds forward; 0.2 rad as well.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from liftopt.lab.robot.command import PERIOD, Command
from liftopt.lab.robot.joint_trajectory import JointTrajectory
from liftopt.lab.robot.quintics import Quintics
from liftopt.multibody.robots.sawyer import sawyer_limits
from liftopt.types import Array

Mode = Literal["velocity", "position", "position_w_id", "torque"]

KP = 2.0  # [1/s]: SawyerVelocityJointTrajectoryActionServer.cfg; ki = kd = 0
PATH_TOLERANCE = {"velocity": np.inf, "position": 0.2, "position_w_id": 0.2, "torque": np.inf}  # [rad]; cfg, -1 is none
SPEED_RATIO = 0.3  # of the top speed: limb.py, set_joint_position_speed
TURNING = 1e-10  # [rad^2/s^2]: slopes whose product is less make the spline stop at a point (minjerk.py)
# The most that SawyerJointSpringsExample.cfg allows [Nm/rad, Nm s/rad]; its defaults are a third and a tenth of it.
SPRING = np.array([30.0, 30.0, 15.0, 15.0, 9.0, 4.0, 4.0])
SPRING_DAMPING = np.array([10.0, 7.5, 7.5, 5.0, 1.5, 1.5, 1.0])


class ActionServer:
    """The server following one trajectory, in the trajectory's joint signs."""

    def __init__(self, mode: Mode, trajectory: JointTrajectory, goal_time: float, torque: Array | None = None) -> None:
        """Take a goal.

        Args:
            mode: of the server.
            trajectory: to follow.
            goal_time: how long after its end the server goes on [s].
            torque: (K, 7) for ``torque``: what to stream, less gravity, at the points of the trajectory [Nm].
        """
        self.mode = mode
        self.outcome = "streamed to the end" if mode == "torque" else "followed to the end"
        self.gave_up = False
        self._end = float(trajectory.time[-1]) + goal_time
        self._tolerance = PATH_TOLERANCE[mode]
        self._names = trajectory.names
        self._top = sawyer_limits().velocity
        self._plan = server_curve(trajectory, np.zeros_like(trajectory.position) if torque is None else torque)
        self._running = True

    def command(self, time: float, position: Array, velocity: Array, reference: Array) -> Command:
        """Return the command of one period.

        Args:
            time: since the trajectory's start, 0 or later [s].
            position: (7,) measured [rad].
            velocity: (7,) measured [rad/s].
            reference: (7,) of the arm's servo [rad].
        """
        none = np.zeros(7)
        planned, rate, acceleration, torque = self._plan.at(time).reshape(4, 7)
        error = planned - position
        if self.mode == "torque":
            spring = SPRING * error + SPRING_DAMPING * (rate - velocity)
            return Command(none, none, torque + spring)
        if not self._running:
            return Command(none, none, none)
        worst = int(np.argmax(np.abs(error)))
        late = time >= self._end
        if late or abs(error[worst]) >= self._tolerance:
            self._running = False
            self.gave_up = not late
            if self.gave_up:
                self.outcome = f"gave up at {time:.2f} s: {self._names[worst]} {error[worst]:+.3f} rad off"
            # The server's last command is zero velocity, or the present position: the reference stays.
            return Command(none, none, none)
        if self.mode == "velocity":
            return Command(np.clip(KP * error, -self._top, self._top), none, none)
        if self.mode == "position":
            top = SPEED_RATIO * self._top
            return Command(np.clip((planned - reference) / PERIOD, -top, top), none, none)
        return Command(np.clip((planned - reference) / PERIOD, -self._top, self._top), acceleration, none)


class MinimumJerk(Quintics):
    """The server's curve through points: quintics with zero acceleration at each, whatever the points say.

    It takes positions, velocities and accelerations for three curves of their own, each with the mean of the slopes
    on both sides as its slope at a point, and zero where the slopes differ in sign, at the start and at the end.
    """

    @classmethod
    def through(cls, time: Array, points: Array) -> MinimumJerk:
        """Return the curve through ``points`` (K, n) at ``time`` (K,)."""
        span = np.diff(time)[:, None]
        step = np.diff(points, axis=0)
        slope = step / span
        velocity = np.zeros_like(points)
        same = slope[:-1] * slope[1:] >= TURNING
        velocity[1:-1] = np.where(same, (slope[:-1] + slope[1:]) / 2, 0.0)
        before, after = velocity[:-1], velocity[1:]
        miss, gain = (step - before * span) / span**3, (after - before) / span**2
        rows = [
            points[:-1], before, np.zeros_like(step),
            10 * miss - 4 * gain, (-15 * miss + 7 * gain) / span, (6 * miss - 3 * gain) / span**2,
        ]  # fmt: skip
        return cls(time, np.stack(rows, axis=1))


def server_curve(trajectory: JointTrajectory, *more: Array) -> MinimumJerk:
    """Return what the server makes of a trajectory: positions, velocities, accelerations (7 each), then ``more``.

    It takes the last point's velocity and acceleration for zero.
    """
    velocity, acceleration = trajectory.velocity.copy(), trajectory.acceleration.copy()
    velocity[-1] = acceleration[-1] = 0.0
    return MinimumJerk.through(trajectory.time, np.hstack([trajectory.position, velocity, acceleration, *more]))
