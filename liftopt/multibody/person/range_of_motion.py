"""Ranges of motion and speed limits of the human joints, mapped to the signs of Table 2's joints."""

from __future__ import annotations

from dataclasses import dataclass

from liftopt.multibody.sources import (
    AAOS,
    AAOS_LEGS,
    AAOS_SPINE,
    MODEL_CHOICE,
    SHOULDER_ADDUCTION,
    STANDING_ANKLE,
    Source,
)

VELOCITY_SOURCE: Source = MODEL_CHOICE


@dataclass(frozen=True)
class JointRange:
    """Range of one joint and the motions that its signs stand for.

    Attributes:
        joint: ``"Q1"`` to ``"Q10"`` of Table 2; of the legs ``"ankle"``, ``"knee"``, ``"hip"``.
        negative, positive: anatomical motion of a joint angle below and above zero.
        lower, upper: end of the range in either direction [deg].
        lower_source, upper_source: of each.
        velocity: speed limit, both directions [rad/s]; its source is ``VELOCITY_SOURCE``.
    """

    joint: str
    negative: str
    positive: str
    lower: float
    upper: float
    lower_source: Source
    upper_source: Source
    velocity: float


# Zero is upright, the arm hanging, the palm forward. AAOS counts forearm rotation from its middle position, 80 deg
# each way; the zero pose is full supination, hence 160 deg of pronation.
RANGES: tuple[JointRange, ...] = (
    JointRange("Q1", "bend to the left", "bend to the right", -35.0, 35.0, AAOS_SPINE, AAOS_SPINE, 1.5),
    JointRange("Q2", "spine extension", "spine flexion", -25.0, 80.0, AAOS_SPINE, AAOS_SPINE, 1.5),
    JointRange("Q3", "turn to the right", "turn to the left", -45.0, 45.0, AAOS_SPINE, AAOS_SPINE, 1.5),
    JointRange("Q4", "shoulder abduction", "shoulder adduction", -180.0, 30.0, AAOS, SHOULDER_ADDUCTION, 4.0),
    JointRange("Q5", "shoulder extension", "shoulder flexion", -60.0, 180.0, AAOS, AAOS, 4.0),
    JointRange("Q6", "external rotation", "internal rotation", -90.0, 70.0, AAOS, AAOS, 4.0),
    JointRange("Q7", "elbow flexion", "elbow extension", -150.0, 0.0, AAOS, AAOS, 5.0),
    JointRange("Q8", "pronation", "supination", -160.0, 0.0, AAOS, AAOS, 5.0),
    JointRange("Q9", "wrist flexion", "wrist extension", -80.0, 70.0, AAOS, AAOS, 5.0),
    JointRange("Q10", "radial deviation", "ulnar deviation", -20.0, 30.0, AAOS, AAOS, 5.0),
)
TRUNK_JOINTS = 3  # the first of the table, which both arms share

# Both legs as one, on feet that stay. Standing on it, an ankle bends further than the 20 deg that AAOS gives it in the
# air, and that decides how deep a squat is. Muscles that cross two joints are left out: with the knee straight an ankle
# bends by 25 deg only (Baumbach et al.), and the hip by less than here (the hamstrings).
LEG_RANGES: tuple[JointRange, ...] = (
    JointRange("ankle", "plantar flexion", "dorsiflexion", -50.0, 39.0, AAOS_LEGS, STANDING_ANKLE, 4.0),
    JointRange("knee", "knee extension", "knee flexion", 0.0, 135.0, AAOS_LEGS, AAOS_LEGS, 6.0),
    JointRange("hip", "hip extension", "hip flexion", -30.0, 120.0, AAOS_LEGS, AAOS_LEGS, 5.0),
)
