"""RULA, the rapid upper limb assessment, of a posture over time.

Source: McAtamney & Corlett (1993), Applied Ergonomics 24:91-99. What the method leaves to the observer's eye, or the
model does not have, is decided here and listed in ``ASSUMPTIONS``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftopt.ergonomics.posture import ArmPosture, Posture
from liftopt.ergonomics.rula_tables import TABLE_A, TABLE_B, TABLE_C
from liftopt.ergonomics.scores import PostureScores, Scores, bands

NEUTRAL = 5.0  # deg; less is taken for "neutral", "erect", "not bent from the midline"
TURNED = 10.0  # deg; a trunk turned or bent sideways by more counts as such
ABDUCTED = 20.0  # deg out of the sagittal plane
TWISTED = 45.0  # deg from the middle of forearm rotation; more is "near the end of the range"
UNEVEN = 2.0 / 3.0  # share of the weight on one foot; more is not "evenly balanced"
OUT_TO_THE_SIDE = 0.05  # m from the shoulder joint to the side of the body

ASSUMPTIONS = (
    f'"Neutral" wrist, "erect" trunk and "not bent from the midline" mean within {NEUTRAL:g}°; a turn or side bend of '
    f"the trunk counts from {TURNED:g}°. Leaning back counts like leaning forward. An erect trunk scores 1, as on the "
    "worksheets in use; the 1993 paper gives 1 to a supported seat only.",
    "Flexion of the upper arm is measured against the trunk in the trunk's sagittal plane; it counts as abducted from "
    f"{ABDUCTED:g}° out of that plane. A raised shoulder is not in the model and is not scored; no support of the arm.",
    f"The lower arm works across the midline where the wrist is past it, out to the side where the wrist is more than "
    f"{100 * OUT_TO_THE_SIDE:g} cm outside the shoulder joint.",
    f"The forearm is near the end of its range beyond {TWISTED:g}° from the middle of pronation and supination.",
    "The model has no neck: the head is scored as neutral (1), though a person watching the object bends it. Legs: "
    f"standing evenly on both feet (1), or one foot bears more than {100 * UNEVEN:.0f} % of the weight (2). How far "
    "the trunk is bent counts against the vertical, whatever bends it.",
    "Force: magnitude of the hand force as a mass, intermittent: 0 below 2 kg, 1 up to 10 kg, 2 above. Muscle use: one "
    "lift, neither held over a minute nor repeated over four times a minute (0); a repeated lift adds 1 to both parts, "
    "and 1 more for a force of 2 kg or more.",
    "Every arm that the model moves is scored with the load of its own hand; the worse side counts.",
)
ACTION = {
    1: "acceptable if not maintained or repeated for long",
    2: "acceptable if not maintained or repeated for long",
    3: "investigate further; changes may be needed",
    4: "investigate further; changes may be needed",
    5: "investigate and change soon",
    6: "investigate and change soon",
    7: "investigate and change immediately",
}


@dataclass(frozen=True)
class Rula(PostureScores):
    """Scores (K,) of every step of RULA; ``grand`` runs from 1 (acceptable) to 7 (change immediately).

    Attributes:
        upper_arm, lower_arm, wrist, wrist_twist: of the arm.
        neck, trunk, legs: of the body.
        force: of the hand force.
        arm_with_force, body_with_force: scores C and D, the rows and columns of the last table.
    """

    upper_arm: Scores
    lower_arm: Scores
    wrist: Scores
    wrist_twist: Scores
    neck: Scores
    trunk: Scores
    legs: Scores
    force: Scores
    arm_with_force: Scores
    body_with_force: Scores


def rula(posture: Posture) -> tuple[Rula, ...]:
    """Return the scores of ``posture`` at every time, one for each of its arms."""
    return tuple(_side(posture, arm) for arm in posture.arms)


def _side(posture: Posture, arm: ArmPosture) -> Rula:
    one = np.ones(len(arm.hand_load), dtype=np.int64)
    upper_arm = _upper_arm(arm)
    lower_arm = _lower_arm(arm)
    wrist = bands(np.abs(arm.wrist_flexion), (NEUTRAL, 15.0)) + (np.abs(arm.wrist_deviation) > NEUTRAL)
    twist = bands(np.abs(arm.pronation), (TWISTED,))
    trunk = bands(np.abs(posture.trunk_inclination), (NEUTRAL, 20.0, 60.0))
    trunk = trunk + (np.abs(posture.trunk_turn) > TURNED) + (np.abs(posture.trunk_bend) > TURNED)
    load = arm.hand_load
    force = np.where(load < 2.0, 0, np.where(load <= 10.0, 1, 2))
    legs = np.where(posture.heavier_foot > UNEVEN, 2, 1)
    of_arm = TABLE_A[upper_arm - 1, lower_arm - 1, wrist - 1, twist - 1] + force
    of_body = TABLE_B[one - 1, trunk - 1, legs - 1] + force
    grand = TABLE_C[np.minimum(of_arm, 8) - 1, np.minimum(of_body, 7) - 1]
    return Rula(arm.side, grand, upper_arm, lower_arm, wrist, twist, one, trunk, legs, force, of_arm, of_body)


def _upper_arm(arm: ArmPosture) -> Scores:
    flexion = arm.upper_arm_flexion
    score = np.where(flexion < -20.0, 2, bands(flexion, (20.0, 45.0, 90.0)))
    return score + (arm.upper_arm_out > ABDUCTED)


def _lower_arm(arm: ArmPosture) -> Scores:
    flexion = arm.elbow_flexion
    aside = (arm.wrist_across > 0.0) | (arm.wrist_outside > OUT_TO_THE_SIDE)
    return np.where((flexion >= 60.0) & (flexion <= 100.0), 1, 2) + aside
