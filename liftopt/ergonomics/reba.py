"""REBA, the rapid entire body assessment, of a posture over time.

Source: Hignett & McAtamney (2000), Applied Ergonomics 31:201-205. What the method leaves to the observer's eye, or the
model does not have, is decided here and listed in ``ASSUMPTIONS``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftopt.ergonomics.coupling import Coupling
from liftopt.ergonomics.posture import ArmPosture, Posture
from liftopt.ergonomics.reba_tables import TABLE_A, TABLE_B, TABLE_C
from liftopt.ergonomics.rula import ABDUCTED, NEUTRAL, TURNED
from liftopt.ergonomics.scores import PostureScores, Scores, bands

COUPLING: dict[Coupling, int] = {"good": 0, "fair": 1, "poor": 2}

ASSUMPTIONS = (
    f'"Upright" trunk and a wrist that is not "bent from the midline" mean within {NEUTRAL:g}°; a turn or side bend of '
    f"the trunk counts from {TURNED:g}°, an upper arm as abducted from {ABDUCTED:g}°. Arms and trunk are measured as "
    "for RULA.",
    "Legs: standing on both feet (1), 1 more from 30° and 2 more from 60° of knee flexion. Neck: neutral (1), for the "
    "model has none. No support of the arm, no raised shoulder, no rotated upper arm.",
    "Load: magnitude of the force on both hands together as a mass, without shock: 0 below 5 kg, 1 up to 10 kg, 2 "
    "above. Activity: one lift (0); one that is repeated over four times a minute adds 1.",
)
ACTIONS = (
    (1, "negligible risk, no action needed"),
    (3, "low risk, change may be needed"),
    (7, "medium risk, investigate and change"),
    (10, "high risk, change soon"),
    (15, "very high risk, change now"),
)


@dataclass(frozen=True)
class Reba(PostureScores):
    """Scores (K,) of every step of REBA; ``grand`` runs from 1 (negligible) to 12, and to 15 with activity.

    Attributes:
        trunk, neck, legs, load: of the body.
        upper_arm, lower_arm, wrist, coupling: of the arm.
        body_with_load, arm_with_coupling: scores A and B, the rows and columns of the last table.
    """

    trunk: Scores
    neck: Scores
    legs: Scores
    load: Scores
    upper_arm: Scores
    lower_arm: Scores
    wrist: Scores
    coupling: Scores
    body_with_load: Scores
    arm_with_coupling: Scores


def reba(posture: Posture, coupling: Coupling) -> tuple[Reba, ...]:
    """Return the scores of ``posture`` at every time, one for each of its arms.

    Args:
        posture: over time.
        coupling: how well the object can be held.
    """
    return tuple(_side(posture, arm, coupling) for arm in posture.arms)


def reba_action(score: int) -> str:
    """Return what a grand score asks for."""
    return next(action for most, action in ACTIONS if score <= most)


def _side(posture: Posture, arm: ArmPosture, coupling: Coupling) -> Reba:
    one = np.ones(len(posture.load), dtype=np.int64)
    inclined = np.abs(posture.trunk_inclination)
    trunk = np.where(posture.trunk_inclination < -20.0, 3, bands(inclined, (NEUTRAL, 20.0, 60.0)))
    trunk = trunk + ((np.abs(posture.trunk_turn) > TURNED) | (np.abs(posture.trunk_bend) > TURNED))
    legs = np.where(posture.knee > 60.0, 3, np.where(posture.knee >= 30.0, 2, 1))
    load = np.where(posture.load < 5.0, 0, np.where(posture.load <= 10.0, 1, 2))
    flexion = arm.upper_arm_flexion
    upper_arm = np.where(flexion < -20.0, 2, bands(flexion, (20.0, 45.0, 90.0))) + (arm.upper_arm_out > ABDUCTED)
    lower_arm = np.where((arm.elbow_flexion >= 60.0) & (arm.elbow_flexion <= 100.0), 1, 2)
    wrist = bands(np.abs(arm.wrist_flexion), (15.0,)) + (np.abs(arm.wrist_deviation) > NEUTRAL)
    held = one * COUPLING[coupling]
    of_body = TABLE_A[one - 1, trunk - 1, legs - 1] + load
    of_arm = TABLE_B[upper_arm - 1, lower_arm - 1, wrist - 1] + held
    grand = TABLE_C[np.minimum(of_body, 12) - 1, np.minimum(of_arm, 12) - 1]
    return Reba(arm.side, grand, trunk, one, legs, load, upper_arm, lower_arm, wrist, held, of_body, of_arm)
