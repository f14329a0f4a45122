"""What a robot and its controller demand of a motion, checked before it is sent.

Joint limits are those of the model that was solved, Sawyer's those of the manufacturer's description. The demands of
Sawyer's action server are read from the manufacturer's intera_sdk, commit 6614dec,
intera_joint_trajectory_action/joint_trajectory_action.py (Apache-2.0).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.meant import the_robot
from liftopt.lab.robot.action_server import server_curve
from liftopt.lab.robot.joint_map import JointMap
from liftopt.lab.robot.joint_trajectory import JointTrajectory, joint_trajectory, robot_motion
from liftopt.lab.robot.trajectory_controller import controller_curve
from liftopt.solution.interpolation import between_knots
from liftopt.solution.solution import Solution
from liftopt.types import Array

ROUNDING = 1e-6  # [rad, rad/s, Nm]: as far as the solver may leave a limit
STANDSTILL = 1e-9  # [rad/s]: the server sets the last velocity to zero, whatever it is
# Through points 10 ms apart the server's curve is up to 0.04 % faster than a plan at its limit, and 0.0001 rad off it.
FASTER = 5e-3  # as a share of the limit
OFF_LIMIT = 1e-3  # [rad] beyond a joint's end, likewise
OFF_PLAN = 1e-3  # [rad]: at an arm's length about the 1 mm that closure may be off between knots
BETWEEN = 50  # parts of the time between two points, where the controller's curve is looked at
RATES = (20.0, 25.0, 30.0, 40.0, 50.0, 100.0, 200.0, 500.0, 1000.0)  # [Hz] to advise
FIX = "solve again with a longer duration or more solver.intervals"


def check_limits(solution: Solution, robot: str | None = None) -> None:
    """Check position, velocity and torque of a robot between the knots too, against its own limits.

    Args:
        solution: a solved lift.
        robot: its name; None where there is only one.

    Raises:
        InputError: a limit is passed; it names the joint, the time and by how much.
    """
    dense = between_knots(solution)
    time, arm, joints = dense.time, the_robot(dense, robot), JointMap.of(dense, robot)
    q, v, tau = (joints.signs * rows[:, arm.moving] for rows in (arm.q, arm.v, arm.tau))
    for found in (
        _position_excess(joints, q, time),
        _speed_excess(joints, v, time),
        _effort_excess(joints, tau, time),
    ):
        if found:
            raise InputError("RESULT", NO_VALUE, f"{found}: {FIX}")


def check_curve(solution: Solution, trajectory: JointTrajectory, rate: float, robot: str | None = None) -> float:
    """Check what the controller commands between the points, and return how far it leaves the plan, the most [rad].

    Args:
        solution: a solved lift.
        trajectory: its motion at ``rate``.
        rate: points a second [Hz].
        robot: its name; None where there is only one.

    Raises:
        InputError: it passes a limit of position or speed; it names the joint, the time, by how much, and a rate at
            which it does not.
    """
    found = _curve_excess(trajectory)
    if found:
        enough = (one for one in RATES if one > rate and not _curve_excess(joint_trajectory(solution, one, robot)))
        better = next(enough, None)
        fix = FIX if better is None else f"take --rate {better:g}"
        whose = "the action server's" if trajectory.joints.is_sawyer else "a trajectory controller's"
        raise InputError("--rate", rate, f"on {whose} curve through these points {found}: {fix}")
    time, position, _ = _followed(trajectory)
    return float(np.abs(position - robot_motion(solution, time, robot)[0]).max())


def check_motion(trajectory: JointTrajectory) -> None:
    """Check what the controller makes of the points: times that increase, and standstill at the end.

    Raises:
        InputError: they do not; it names the joint, the time and the amount.
    """
    steps = np.diff(trajectory.nanoseconds)
    if len(steps) == 0 or steps.min() <= 0:
        raise InputError("time", float(trajectory.time[-1]), "times of the points must increase")
    last = np.abs(trajectory.velocity[-1])
    worst = int(np.argmax(last))
    if last[worst] > STANDSTILL:
        joints = trajectory.joints
        speed = f"{joints.moves(worst)} at {trajectory.velocity[-1, worst]:.3g} {joints.units[worst].v}"
        where = f"{joints.names[worst]} {speed} at its end"
        raise InputError("RESULT", NO_VALUE, f"{where}, {trajectory.time[-1]:.3f} s; a trajectory must end at rest")


def _followed(trajectory: JointTrajectory) -> tuple[Array, Array, Array]:
    """Return times (M,), positions and velocities (M, n) that the controller makes of the points, faster of two."""
    if not trajectory.joints.is_sawyer:
        return controller_curve(trajectory).sampled(BETWEEN)
    time, value, slope = server_curve(trajectory).sampled(BETWEEN)
    n = len(trajectory.names)
    # The position modes send the positions, whose slope the arm turns at; position_w_id the velocities as well.
    position, velocity, turning = value[:, :n], value[:, n : 2 * n], slope[:, :n]
    return time, position, np.where(np.abs(turning) > np.abs(velocity), turning, velocity)


def _curve_excess(trajectory: JointTrajectory) -> str:
    """Return which limit the controller's curve through the points passes; empty if none."""
    joints, (time, position, velocity) = trajectory.joints, _followed(trajectory)
    return _position_excess(joints, position, time, OFF_LIMIT) or _speed_excess(
        joints, velocity, time, FASTER * joints.speed
    )


def _position_excess(joints: JointMap, q: Array, time: Array, allowed: float = ROUNDING) -> str:
    words = [("is at", unit.q) for unit in joints.units]
    return _excess(joints, words, q, joints.ends, time, allowed)


def _speed_excess(joints: JointMap, v: Array, time: Array, allowed: Array | float = ROUNDING) -> str:
    words = [(f"{joints.moves(j)} at", unit.v) for j, unit in enumerate(joints.units)]
    return _excess(joints, words, v, np.asarray(joints.speed * [[-1.0], [1.0]]), time, allowed)


def _effort_excess(joints: JointMap, tau: Array, time: Array) -> str:
    words = [("needs", unit.tau) for unit in joints.units]
    return _excess(joints, words, tau, joints.effort, time, ROUNDING)


def _excess(
    joints: JointMap, words: Sequence[tuple[str, str]], values: Array, ends: Array, time: Array, allowed: Array | float
) -> str:
    """Return where values (K, n) pass their ends (2, n) by the most and by more than allowed; empty if they do not.

    ``words`` are (n,) what a joint does, and the unit of its values.
    """
    excess = np.maximum(ends[0] - values, values - ends[1])
    k, j = map(int, np.unravel_index(int(np.argmax(excess - allowed)), excess.shape))
    if excess[k, j] <= np.broadcast_to(allowed, excess.shape)[k, j]:
        return ""
    (low, high), (what, unit) = ends[:, j], words[j]
    return (
        f"{joints.names[j]} {what} {values[k, j]:.4f} {unit} at {time[k]:.3f} s, {excess[k, j]:.2g} {unit} beyond "
        f"its limits {low:g} to {high:g}"
    )
