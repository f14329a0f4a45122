"""What the robot and its trajectory action server demand of a motion, checked before it is sent.

Joint limits are those of the manufacturer's description (``sawyer_limits``). The server's demands are read from the
manufacturer's intera_sdk, commit 6614dec, intera_joint_trajectory_action/joint_trajectory_action.py (Apache-2.0).
"""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from liftopt.errors import NO_VALUE, InputError
from liftopt.interpolation import refined
from liftopt.lab.joint_trajectory import JOINTS, JointTrajectory
from liftopt.multibody.sawyer import JOINT_SIGNS, sawyer_limits
from liftopt.solution import Solution

Array = npt.NDArray[np.float64]
FINER = 10  # points an interval of the solution, as its own verification takes
ROUNDING = 1e-6  # [rad, rad/s, Nm]: as far as the solver may leave a limit
# The server refuses a first point farther from the arm than its path tolerance, a negative one without the sign [rad].
START = 1.0  # velocity mode, -1
NEAREST = 0.2  # both position modes
NEAR = 0.05  # [rad]: a first point farther off than this makes a jerk worth a note; our estimate
STANDSTILL = 1e-9  # [rad/s]: the server sets the last velocity to zero, whatever it is
# sawyer_simulator, commit 156bf12, sawyer_gazebo/config/acceleration_limits.yaml (Apache-2.0); the server checks none.
ACCELERATION = np.array([10.0, 8.0, 10.0, 10.0, 12.0, 12.0, 12.0])  # [rad/s^2]
FIX = "solve again with a longer duration or more solver.intervals"


def check_limits(solution: Solution) -> None:
    """Check position, velocity and torque of the robot on ``FINER`` points an interval against its own limits.

    Raises:
        InputError: a limit is passed; it names the joint, the time and by how much.
    """
    limits, dense = sawyer_limits(), refined(solution, FINER)
    time, robot = dense.time, dense.agents[1]
    q, v, tau = (JOINT_SIGNS * rows[:, robot.moving] for rows in (robot.q, robot.v, robot.tau))
    ends = np.sort(JOINT_SIGNS * np.stack([limits.q_lower, limits.q_upper]), axis=0)
    _within("is at", q, ends, time, "rad")
    _within("turns at", v, limits.velocity * [[-1.0], [1.0]], time, "rad/s")
    _within("needs", tau, limits.tau_upper * [[-1.0], [1.0]], time, "Nm")


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


def check_start(trajectory: JointTrajectory, pose: Array) -> float:
    """Return how far the first point is from the arm's pose, the largest over joints [rad].

    Args:
        trajectory: in the robot's joints.
        pose: (7,) where the arm is, right_j0 to right_j6 [rad].

    Raises:
        InputError: it is more than the server accepts; it names the joint and the amount.
    """
    away = np.abs(trajectory.position[0] - pose)
    worst = int(np.argmax(away))
    if away[worst] > START:
        first = trajectory.position[0, worst]
        raise InputError(
            "--current-pose",
            float(pose[worst]),
            f"{trajectory.names[worst]} is {away[worst]:.3f} rad from the motion's start at {first:.3f} rad (0 s); the "
            f"action server accepts {START:g} rad: move the arm to the start first",
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
    share = np.abs(trajectory.acceleration) / ACCELERATION
    over = [j for j in range(len(trajectory.names)) if share[:, j].max() > 1.0]
    for j in over:
        k = int(np.argmax(share[:, j]))
        yield (
            f"{trajectory.names[j]} accelerates at {trajectory.acceleration[k, j]:.1f} rad/s^2 at "
            f"{trajectory.time[k]:.2f} s; Sawyer's simulator allows {ACCELERATION[j]:g}, the action server does not "
            "check it (objective.acceleration_weight lowers it)"
        )


def _within(what: str, values: Array, ends: Array, time: Array, unit: str) -> None:
    excess = np.maximum(ends[0] - values, values - ends[1])
    k, j = np.unravel_index(int(np.argmax(excess)), excess.shape)
    if excess[k, j] <= ROUNDING:
        return
    low, high = ends[:, j]
    raise InputError(
        "RESULT",
        NO_VALUE,
        f"{JOINTS[j]} {what} {values[k, j]:.4f} {unit} at {time[k]:.3f} s, {excess[k, j]:.2g} {unit} beyond its limits "
        f"{low:g} to {high:g}: {FIX}",
    )
