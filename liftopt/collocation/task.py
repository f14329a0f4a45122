"""The task as the optimal-control problem knows it: poses of the object, time, weights and limits."""

from __future__ import annotations

from dataclasses import dataclass
from math import radians

from liftopt.types import Array

OBJECT_COORDINATES = ("x", "y", "z", "roll", "pitch", "yaw")
TILT = radians(10.0)  # of the object, that counts as one [rad]


@dataclass(frozen=True)
class LiftTask:
    """What is to be done with the object.

    Poses are (6,): centre of mass in the world X, Y, Z [m], then roll, pitch, yaw [rad] with R = Rx Ry Rz; NaN where
    the task leaves a coordinate free.

    Attributes:
        duration: T [s].
        start, end: poses at t = 0 and t = T.
        pose_lower, pose_upper: range of motion of the object at all times (eq. 15).
        pose_velocity: speed limit of each coordinate [m/s, rad/s].
        agent_weights: weight of each agent's squared torques in the objective (eq. 10).
        acceleration_weight, force_weight: weights of the squared accelerations and grasp forces.
        pace: factor on the squared accelerations, a part of their term.
        range_weight: weight of what the joint angles of agents cost, see ``Comfort``.
        tilt_weight: weight of the object's squared roll and pitch, in units of ``TILT``.
        spine_weight: weight of the squared shares in the load on agents' spines, see ``Agent.spine``.
        shares: whether torques count as shares of the joint's limit in their direction, not in Nm.
        max_grasp_force: largest norm of a grasp force [N].
        balance_tolerance: tolerance of the object's balance (eq. 17) [N, Nm]; 0 asks for equality on five rows.
    """

    duration: float
    start: Array
    end: Array
    pose_lower: Array
    pose_upper: Array
    pose_velocity: Array
    agent_weights: tuple[float, ...]
    acceleration_weight: float
    force_weight: float
    max_grasp_force: float
    balance_tolerance: float = 0.0
    range_weight: float = 0.0
    tilt_weight: float = 0.0
    spine_weight: float = 0.0
    shares: bool = False
    pace: float = 1.0
