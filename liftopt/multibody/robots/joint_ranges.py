"""Between which ends a joint moves: those of its URDF, of its safety controller, or those that stand for none."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite, nan, pi
from typing import Literal

from liftopt.multibody.robots.description import RobotJoint

ENDLESS = 2.0 * pi  # a continuous joint turns once each way [rad]
MOST_TURNS = 4.0 * ENDLESS  # a wider range of a continuous joint stands for none [rad]
From = Literal["limits", "soft limits", "endless", "nothing"]


@dataclass(frozen=True)
class JointRange:
    """The range of one joint.

    Attributes:
        joint: that it is of.
        lower, upper: its ends [rad, m]; NaN where nothing says them.
        source: where they come from.
    """

    joint: RobotJoint
    lower: float
    upper: float
    source: From


def range_of(joint: RobotJoint) -> JointRange:
    """Return the range of a joint that turns or slides.

    The limits of the URDF hold, of which a missing one is zero, as URDF has it; within them the soft limits, where
    there is a range between them. A continuous joint without limits turns once each way.
    """
    lower, upper = joint.lower, joint.upper
    source: From = "limits"
    if lower is None and upper is None:
        if joint.kind != "continuous":
            return JointRange(joint, nan, nan, "nothing")
        lower, upper, source = -ENDLESS, ENDLESS, "endless"
    lower, upper = lower or 0.0, upper or 0.0
    if joint.kind == "continuous" and not (isfinite(upper - lower) and 0.0 < upper - lower < MOST_TURNS):
        lower, upper, source = -ENDLESS, ENDLESS, "endless"
    soft_lower, soft_upper = joint.soft_lower, joint.soft_upper
    if soft_lower is not None and soft_upper is not None and soft_lower < soft_upper:
        inner = (max(lower, soft_lower), min(upper, soft_upper))
        if inner != (lower, upper) and inner[0] < inner[1]:
            return JointRange(joint, *inner, "soft limits")
    return JointRange(joint, lower, upper, source)
