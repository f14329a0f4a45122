"""What the robot and its trajectory action server demand of a motion, checked before it is sent.

Joint limits are those of the manufacturer's description (``sawyer_limits``). The server's demands are read from the
manufacturer's intera_sdk, commit 6614dec, intera_joint_trajectory_action/joint_trajectory_action.py (Apache-2.0).
"""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.meant import the_robot
from liftopt.lab.robot.action_server import PATH_TOLERANCE, Mode, server_curve
from liftopt.lab.robot.joint_trajectory import JOINTS, JointTrajectory, joint_trajectory, robot_motion
from liftopt.multibody.robots.sawyer import JOINT_SIGNS, sawyer_limits
from liftopt.solution.interpolation import between_knots
from liftopt.solution.solution import Solution
from liftopt.types import Array

ROUNDING = 1e-6  # [rad, rad/s, Nm]: as far as the solver may leave a limit
# The server refuses a first point farther from the arm than its path tolerance, a negative one without the sign: in
# velocity mode it is -1 [rad]. In both position modes it gives up at once where the arm is as far off as allowed.
START = {mode: min(tolerance, 1.0) for mode, tolerance in PATH_TOLERANCE.items()}
NEAR = 0.05  # [rad]: a first point farther off than this makes a jerk worth a note; our estimate
STANDSTILL = 1e-9  # [rad/s]: the server sets the last velocity to zero, whatever it is
# sawyer_simulator, commit 156bf12, sawyer_gazebo/config/acceleration_limits.yaml (Apache-2.0); the server checks none.
ACCELERATION = np.array([10.0, 8.0, 10.0, 10.0, 12.0, 12.0, 12.0])  # [rad/s^2]
# Through points 10 ms apart the server's curve is up to 0.04 % faster than a plan at its limit, and 0.0001 rad off it.
FASTER = 5e-3  # as a share of the limit
OFF_LIMIT = 1e-3  # [rad] beyond a joint's end, likewise
OFF_PLAN = 1e-3  # [rad]: at an arm's length about the 1 mm that closure may be off between knots
BETWEEN = 50  # parts of the time between two points, where the server's curve is looked at
RATES = (20.0, 25.0, 30.0, 40.0, 50.0, 100.0, 200.0, 500.0, 1000.0)  # [Hz] to advise
STEP = 1e-2  # [rad/s^2]: less is none
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
    time, arm = dense.time, the_robot(dense, robot)
    q, v, tau = (JOINT_SIGNS * rows[:, arm.moving] for rows in (arm.q, arm.v, arm.tau))
    for found in (
        _excess("is at", q, _ends(), time, "rad"),
        _excess("turns at", v, _speeds(), time, "rad/s"),
        _excess("needs", tau, sawyer_limits().tau_upper * [[-1.0], [1.0]], time, "Nm"),
    ):
        if found:
            raise InputError("RESULT", NO_VALUE, f"{found}: {FIX}")


def check_server(solution: Solution, trajectory: JointTrajectory, rate: float, robot: str | None = None) -> float:
    """Check what the server commands between the points, and return how far it leaves the plan, the most [rad].

    Args:
        solution: a solved lift.
        trajectory: its motion at ``rate``.
        rate: points a second [Hz].
        robot: its name; None where there is only one.

    Raises:
        InputError: it passes a limit of position or speed; it names the joint, the time, by how much, and a rate at
            which it does not.
    """
    found = _server_excess(trajectory)
    if found:
        enough = (one for one in RATES if one > rate and not _server_excess(joint_trajectory(solution, one, robot)))
        better = next(enough, None)
        fix = FIX if better is None else f"take --rate {better:g}"
        raise InputError("--rate", rate, f"on the action server's curve through these points {found}: {fix}")
    time, value, _ = server_curve(trajectory).sampled(BETWEEN)
    return float(np.abs(value[:, : len(JOINTS)] - robot_motion(solution, time, robot)[0]).max())


def check_motion(trajectory: JointTrajectory) -> None:
    """Check what the server makes of the points: times that increase, and standstill at the end.

    Raises:
        InputError: they do not; it names the joint, the time and the amount.
    """
    steps = np.diff(trajectory.nanoseconds)
    if len(steps) == 0 or steps.min() <= 0:
        raise InputError("time", float(trajectory.time[-1]), "times of the points must increase")
    last = np.abs(trajectory.velocity[-1])
    worst = int(np.argmax(last))
    if last[worst] > STANDSTILL:
        where = f"{trajectory.names[worst]} turns at {trajectory.velocity[-1, worst]:.3g} rad/s at its end"
        raise InputError("RESULT", NO_VALUE, f"{where}, {trajectory.time[-1]:.3f} s; a trajectory must end at rest")


def check_start(trajectory: JointTrajectory, pose: Array, mode: Mode) -> float:
    """Return how far the first point is from the arm's pose, the largest over joints [rad].

    Args:
        trajectory: in the robot's joints.
        pose: (7,) where the arm is, right_j0 to right_j6 [rad].
        mode: of the server.

    Raises:
        InputError: it is more than the server accepts; it names the joint, the amount and what is accepted.
    """
    away = np.abs(trajectory.position[0] - pose)
    worst = int(np.argmax(away))
    if away[worst] >= START[mode]:
        first = trajectory.position[0, worst]
        wider = f", in velocity mode {START['velocity']:g} rad (--mode velocity)" if mode != "velocity" else ""
        raise InputError(
            "--current-pose",
            float(pose[worst]),
            f"{trajectory.names[worst]} is {away[worst]:.3f} rad from the motion's start at {first:.3f} rad (0 s); in "
            f"{mode} mode the action server accepts less than {START[mode]:g} rad{wider}: move the arm there first",
        )
    return float(away[worst])


def read_pose(text: str) -> Array:
    """Return the seven angles in ``text``, as ``rostopic echo`` or a CSV line shows them.

    Raises:
        InputError: there are not seven finite numbers.
    """
    try:
        pose = np.array([float(word) for word in re.split(r"[\s,\[\]()]+", text) if word])
    except ValueError:
        pose = np.empty(0)
    if pose.shape != (len(JOINTS),) or not np.isfinite(pose).all():
        raise InputError("--current-pose", text, "must be seven angles in radians, right_j0 to right_j6")
    return pose


def remarks(trajectory: JointTrajectory) -> Iterator[str]:
    """Yield what the server lets pass and an operator should know."""
    steps = []
    for k, where in ((0, "starts"), (-1, "ends")):
        j = int(np.argmax(np.abs(trajectory.acceleration[k])))
        if abs(size := float(trajectory.acceleration[k, j])) > STEP:
            steps.append(f"{where} with a step of acceleration ({size:.1f} rad/s^2 in {trajectory.names[j]})")
    if steps:
        yield f"the motion {' and '.join(steps)}: solve with --set task.rest=acceleration to have none"
    share = np.abs(trajectory.acceleration) / ACCELERATION
    over = [j for j in range(len(trajectory.names)) if share[:, j].max() > 1.0]
    for j in over:
        k = int(np.argmax(share[:, j]))
        yield (
            f"{trajectory.names[j]} accelerates at {trajectory.acceleration[k, j]:.1f} rad/s^2 at "
            f"{trajectory.time[k]:.2f} s; Sawyer's simulator allows {ACCELERATION[j]:g}, the action server does not "
            "check it (objective.acceleration_weight lowers it)"
        )


def _ends() -> Array:
    """Return the joints' ends (2, 7) in the robot's signs [rad]."""
    limits = sawyer_limits()
    return np.sort(JOINT_SIGNS * np.stack([limits.q_lower, limits.q_upper]), axis=0)


def _speeds() -> Array:
    """Return the joints' speed limits (2, 7) [rad/s]."""
    return np.asarray(sawyer_limits().velocity * [[-1.0], [1.0]])


def _server_excess(trajectory: JointTrajectory) -> str:
    """Return which limit the server's curve through the points passes; empty if none."""
    time, value, slope = server_curve(trajectory).sampled(BETWEEN)
    n = len(JOINTS)
    # The position modes send the positions, whose slope the arm turns at; position_w_id the velocities as well.
    position, velocity, turning = value[:, :n], value[:, n : 2 * n], slope[:, :n]
    velocity = np.where(np.abs(turning) > np.abs(velocity), turning, velocity)
    return _excess("is at", position, _ends(), time, "rad", OFF_LIMIT) or _excess(
        "turns at", velocity, _speeds(), time, "rad/s", FASTER * sawyer_limits().velocity
    )


def _excess(what: str, values: Array, ends: Array, time: Array, unit: str, allowed: Array | float = ROUNDING) -> str:
    """Return where values (K, 7) pass their ends (2, 7) by the most and by more than allowed; empty if they do not."""
    excess = np.maximum(ends[0] - values, values - ends[1])
    k, j = np.unravel_index(int(np.argmax(excess - allowed)), excess.shape)
    if excess[k, j] <= np.broadcast_to(allowed, excess.shape)[k, j]:
        return ""
    low, high = ends[:, j]
    return (
        f"{JOINTS[j]} {what} {values[k, j]:.4f} {unit} at {time[k]:.3f} s, {excess[k, j]:.2g} {unit} beyond its limits "
        f"{low:g} to {high:g}"
    )
