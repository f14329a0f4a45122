"""What a controller lets pass in a motion and an operator should know."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from liftopt.lab.robot.joint_trajectory import JointTrajectory

STEP = 1e-2  # [rad/s^2]: less is none
# sawyer_simulator, commit 156bf12, sawyer_gazebo/config/acceleration_limits.yaml (Apache-2.0); the server checks none.
SAWYER = (10.0, 8.0, 10.0, 10.0, 12.0, 12.0, 12.0)  # [rad/s^2]
# libfranka, include/franka/rate_limiting.h (Apache-2.0), of the Panda; its controller stops at what passes them.
PANDA = (15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0)  # [rad/s^2]
PANDA_JERK = (7500.0, 3750.0, 5000.0, 6250.0, 7500.0, 10000.0, 10000.0)  # [rad/s^3]
PANDA_PERIOD = 1e-3  # [s]: a step of acceleration lasts one
PANDA_JOINTS = tuple(f"panda_joint{i}" for i in range(1, 8))


def remarks(trajectory: JointTrajectory) -> Iterator[str]:
    """Yield what an operator should know, one line each."""
    yield from _steps(trajectory)
    if trajectory.joints.is_sawyer:
        more = "Sawyer's simulator allows {most:g}, the action server does not check it"
        yield from _fast(trajectory, SAWYER, more)
    if trajectory.names == PANDA_JOINTS:
        yield from _fast(trajectory, PANDA, "a Panda stops beyond {most:g}")
        yield from _panda_steps(trajectory)


def _steps(trajectory: JointTrajectory) -> Iterator[str]:
    steps, joints = [], trajectory.joints
    for k, where in ((0, "starts"), (-1, "ends")):
        j = int(np.argmax(np.abs(trajectory.acceleration[k])))
        if abs(size := float(trajectory.acceleration[k, j])) > STEP:
            unit = joints.units[j].a
            steps.append(f"{where} with a step of acceleration ({size:.1f} {unit} in {joints.names[j]})")
    if steps:
        yield f"the motion {' and '.join(steps)}: solve with --set task.rest=acceleration to have none"


def _fast(trajectory: JointTrajectory, allowed: tuple[float, ...], more: str) -> Iterator[str]:
    share = np.abs(trajectory.acceleration) / np.array(allowed)
    over = [j for j in range(len(trajectory.names)) if share[:, j].max() > 1.0]
    for j in over:
        k = int(np.argmax(share[:, j]))
        yield (
            f"{trajectory.names[j]} accelerates at {trajectory.acceleration[k, j]:.1f} rad/s^2 at "
            f"{trajectory.time[k]:.2f} s; {more.format(most=allowed[j])} (objective.acceleration_weight lowers it)"
        )


def _panda_steps(trajectory: JointTrajectory) -> Iterator[str]:
    jerk = np.abs(trajectory.acceleration[[0, -1]]) / PANDA_PERIOD
    share = (jerk / np.array(PANDA_JERK)).max(axis=0)
    j = int(np.argmax(share))
    if share[j] > 1.0:
        yield (
            f"the step of acceleration of {trajectory.names[j]} is a jerk of {jerk[:, j].max():.0f} rad/s^3 over one "
            f"period of a Panda's controller, which stops beyond {PANDA_JERK[j]:g}"
        )
