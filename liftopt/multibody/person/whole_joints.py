"""The 20 joints of the whole person: names, order, ranges of motion, speeds and strengths, with their sources."""

from __future__ import annotations

from dataclasses import replace
from math import radians

import numpy as np

from liftopt.multibody.agent import JointLimits
from liftopt.multibody.person.leg_strength import LEG_STRENGTHS, LegStrength
from liftopt.multibody.person.range_of_motion import LEG_RANGES, RANGES, TRUNK_JOINTS, JointRange
from liftopt.multibody.person.strength import STRENGTHS, Strength
from liftopt.multibody.person.subject import Subject

LEGS = tuple(item.joint for item in LEG_RANGES)
TRUNK, ARM = (tuple(item.joint for item in part) for part in (RANGES[:TRUNK_JOINTS], RANGES[TRUNK_JOINTS:]))
HANDS = ("right", "left")
JOINTS = (*LEGS, *TRUNK, *(f"{side}_{joint}" for side in HANDS for joint in ARM))
# Motions of the shoulder, elbow and wrist have the same names and signs on both sides.
WHOLE_RANGES: tuple[JointRange, ...] = (
    *LEG_RANGES,
    *RANGES[:TRUNK_JOINTS],
    *(replace(item, joint=f"{side}_{item.joint}") for side in HANDS for item in RANGES[TRUNK_JOINTS:]),
)
WHOLE_STRENGTHS: tuple[LegStrength | Strength, ...] = (
    *LEG_STRENGTHS,
    *(item for item in STRENGTHS if item.joint in TRUNK),
    *(replace(item, joint=f"{side}_{item.joint}") for side in HANDS for item in STRENGTHS if item.joint in ARM),
)


def table_joint(joint: str) -> str:
    """Return the joint of Table 2, or of the legs, that a joint of the whole body is: ``"left_Q4"`` is ``"Q4"``."""
    return joint.rpartition("_")[2]


def whole_limits(subject: Subject) -> JointLimits:
    """Return ranges of motion, speeds and strength, arrays (20,) in the order of ``JOINTS``."""
    torque = {(item.joint, item.sign): item.sign * item.of(subject) for item in WHOLE_STRENGTHS}
    return JointLimits(
        q_lower=np.array([radians(item.lower) for item in WHOLE_RANGES]),
        q_upper=np.array([radians(item.upper) for item in WHOLE_RANGES]),
        velocity=np.array([item.velocity for item in WHOLE_RANGES]),
        tau_lower=np.array([torque[joint, -1] for joint in JOINTS]),
        tau_upper=np.array([torque[joint, +1] for joint in JOINTS]),
    )
