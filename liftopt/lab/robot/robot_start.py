"""Where an arm is before the motion, and how far from its start it may be."""

from __future__ import annotations

import re

import numpy as np

from liftopt.assessment.who import in_words
from liftopt.errors import InputError
from liftopt.lab.robot.action_server import PATH_TOLERANCE, Mode
from liftopt.lab.robot.joint_map import JointMap
from liftopt.lab.robot.joint_trajectory import JointTrajectory
from liftopt.types import Array

# Sawyer's server refuses a first point farther from the arm than its path tolerance, a negative one without the sign:
# in velocity mode it is -1 [rad]. In both position modes it gives up at once where the arm is as far off as allowed.
START = {mode: min(tolerance, 1.0) for mode, tolerance in PATH_TOLERANCE.items()}
# Of any other robot: a trajectory controller starts wherever the arm is and is at the first point at once. Ours.
ELSEWHERE = 0.2  # [rad] refused
NEAR = 0.05  # [rad]: a first point farther off than this makes a jerk worth a note; our estimate
ARM = 0.5  # [m]: a joint that slides by half of what a joint turns by leads a hand at half an arm's length as far off


def accepted_start(mode: Mode | None) -> float:
    """Return how far from the start an arm may be [rad]; ``mode`` is that of Sawyer's server, None of other robots."""
    return ELSEWHERE if mode is None else START[mode]


def check_start(trajectory: JointTrajectory, pose: Array, mode: Mode | None) -> float:
    """Return how far the first point is from the arm's pose, the largest over joints [rad].

    Args:
        trajectory: in the robot's joints.
        pose: (n,) where the arm is, in the trajectory's joints [rad, m].
        mode: of Sawyer's server; None for any other robot.

    Raises:
        InputError: it is more than is accepted; it names the joint, the amount and what is accepted.
    """
    joints = trajectory.joints
    away = np.abs(trajectory.position[0] - pose) / np.where(joints.sliding, ARM, 1.0)
    worst = int(np.argmax(away))
    if away[worst] >= (most := accepted_start(mode)):
        unit, scale = joints.units[worst].q, ARM if joints.sliding[worst] else 1.0
        first = trajectory.position[0, worst]
        if mode is None:
            accepts = f"less than {scale * most:g} {unit} is accepted"
        else:
            wider = f", in velocity mode {START['velocity']:g} rad (--mode velocity)" if mode != "velocity" else ""
            accepts = f"in {mode} mode the action server accepts less than {most:g} rad{wider}"
        raise InputError(
            "--current-pose",
            float(pose[worst]),
            f"{joints.names[worst]} is {scale * away[worst]:.3f} {unit} from the motion's start at {first:.3f} {unit} "
            f"(0 s); {accepts}: move the arm there first",
        )
    return float(away[worst])


def read_pose(text: str, joints: JointMap) -> Array:
    """Return the joint positions in ``text``, as ``rostopic echo`` or a CSV line shows them.

    Raises:
        InputError: there are not as many finite numbers as joints.
    """
    try:
        pose = np.array([float(word) for word in re.split(r"[\s,\[\]()]+", text) if word])
    except ValueError:
        pose = np.empty(0)
    names, n = joints.names, len(joints.names)
    if pose.shape != (n,) or not np.isfinite(pose).all():
        count = in_words(n)
        which = f"{names[0]} to {names[-1]}" if joints.is_sawyer else ", ".join(names)
        what = f"{count} angles in radians" if not joints.sliding.any() else f"{count} positions in radians or metres"
        raise InputError("--current-pose", text, f"must be {what}, {which}")
    return pose
