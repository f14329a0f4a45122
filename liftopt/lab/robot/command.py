"""What an arm is told for one period, whoever tells it."""

from __future__ import annotations

from dataclasses import dataclass

from liftopt.types import Array

PERIOD = 0.01  # [s]: controllers of trajectories tell the arm's servo at 100 Hz


@dataclass(frozen=True)
class Command:
    """What the arm is told for one period; all (n,).

    Attributes:
        rate: velocity of the servo's reference [rad/s].
        acceleration: fed forward by the arm through its own model [rad/s^2].
        torque: on top of the arm's gravity compensation [Nm].
    """

    rate: Array
    acceleration: Array
    torque: Array
