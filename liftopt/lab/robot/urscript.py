"""A robot's motion as a URScript program, which the controllers of Universal Robots' arms run.

``servoj`` takes a target every period and follows it for that long. Its parameters and their ranges are the maker's
(universal-robots.com, articles, "ServoJ command": t 0.008 s for CB3 and 0.002 s for e-Series, lookahead_time 0.03 to
0.2 s, gain 100 to 2000). All else that is called here, and how, is what the maker's driver itself runs on the arm
(Universal_Robots_Client_Library, resources/external_control.urscript). A program of ``movej`` with blends would keep
the path and lose the time law, which the person follows. Positions are the URDF's: the maker's ROS drivers hand the
controller's own over unchanged.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from liftopt.errors import InputError
from liftopt.lab.robot.joint_map import JointMap
from liftopt.lab.robot.joint_trajectory import JointTrajectory
from liftopt.types import Array

JOINTS = (
    "shoulder_pan_joint",
    "shoulder_lift_joint",
    "elbow_joint",
    "wrist_1_joint",
    "wrist_2_joint",
    "wrist_3_joint",
)
PERIODS = {"125": 0.008, "500": 0.002}  # [s] by targets a second: CB3 (an e-Series takes it too), e-Series
LOOKAHEAD, GAIN = 0.1, 300  # [s], -: the maker's defaults
HOLD = 0.5  # [s] at the last target: the arm is late by about the look-ahead
BRAKE = 2.0  # [rad/s^2] of stopj
SPEED, RISE = 0.15, 0.3  # [rad/s, rad/s^2] of the way to the start; ours, slow
NEAR = 0.5  # [rad]: an arm farther from the start than this is not moved there; ours
MOST = 20_000  # targets: 160 s at 125 Hz, 40 s at 500 Hz, a text of 2 MB; ours
WIDEST = 2.0 * np.pi  # [rad]: where the joints of Universal Robots end


def is_universal(joints: JointMap) -> bool:
    """Whether a robot's joints are those of Universal Robots' arms, a prefix before the names or not."""
    first = joints.names[0]
    prefix = first.removesuffix(JOINTS[0])
    return first != prefix and joints.names == tuple(prefix + name for name in JOINTS)


def servo_times(duration: float, period: float) -> Array:
    """Return the times (K,) of the targets, the start first [s]: the last is the end, at most one period after it.

    Raises:
        InputError: they are more than a program may have.
    """
    count = int(np.ceil(duration / period - 1e-9))
    if count > MOST:
        raise InputError(
            "--servo-rate", f"{1.0 / period:.0f}", f"makes {count} targets in {duration:g} s; a program may have {MOST}"
        )
    return np.asarray(np.minimum(period * np.arange(count + 1), duration))


def urscript(trajectory: JointTrajectory, period: float, title: str) -> str:
    """Return the program: it asks, moves the arm slowly to the start, asks again, follows the motion and stops.

    Args:
        trajectory: its points are ``period`` apart, see ``servo_times``.
        period: between targets [s].
        title: of the lift, for the comment and the questions.

    Raises:
        InputError: a position is beyond what the joints can do.
    """
    far = np.abs(trajectory.position).max(axis=0)
    if far.max() > WIDEST:
        j = int(np.argmax(far))
        raise InputError("--format", "urscript", f"{trajectory.names[j]} goes to {far[j]:.3f} rad; it ends at 2 pi")
    return "\n".join(_lines(trajectory, period, _plain(title))) + "\n"


def _lines(trajectory: JointTrajectory, period: float, title: str) -> Iterator[str]:
    ends = _list(trajectory.position[0]), _list(trajectory.position[-1])
    yield "def liftopt_lift():"
    yield f"  # {title}: {len(trajectory.time) - 1} targets in {trajectory.time[-1]:.3f} s"
    yield f"  # joints: {', '.join(trajectory.names)} [rad]"
    yield f"  period = {period:g}"
    yield f"  lookahead = {LOOKAHEAD:g}"
    yield f"  gain = {GAIN:g}"
    yield f"  start = {ends[0]}"
    yield "  here = get_actual_joint_positions()"
    yield "  far = 0"
    yield "  i = 0"
    yield f"  while i < {len(JOINTS)}:"
    yield f"    if norm(here[i] - start[i]) > {NEAR:g}:"
    yield "      far = far + 1"
    yield "    end"
    yield "    i = i + 1"
    yield "  end"
    yield "  if far > 0:"
    yield f'    popup("A joint is more than {NEAR:g} rad from the start", title="{title}", error=True, blocking=True)'
    yield "    halt"
    yield "  end"
    yield f'  popup("Continue: the arm moves slowly to the start", title="{title}", warning=True, blocking=True)'
    yield f"  movej(start, a={RISE:g}, v={SPEED:g})"
    yield f'  popup("Continue: THE LIFT BEGINS AT ONCE", title="{title}", warning=True, blocking=True)'
    for position in trajectory.position[1:]:
        yield f"  servoj({_list(position)}, t=period, lookahead_time=lookahead, gain=gain)"
    yield "  held = 0.0"
    yield f"  while held < {HOLD:g}:"
    yield f"    servoj({ends[1]}, t=period, lookahead_time=lookahead, gain=gain)"
    yield "    held = held + period"
    yield "  end"
    yield f"  stopj({BRAKE:g})"
    yield "end"


def _list(position: Array) -> str:
    """Return joint positions (6,) as URScript writes a list, to a nanoradian."""
    return f"[{', '.join(f'{float(q) + 0.0:.9f}' for q in position)}]"


def _plain(title: str) -> str:
    """Return a text without what would end a string or a comment."""
    kept = "".join(one for one in title if one.isascii() and (one.isalnum() or one in " _-.,"))
    return kept[:60] or "lift"
