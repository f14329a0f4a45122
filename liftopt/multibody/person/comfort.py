"""Where a person's joints are at ease: neutral angles and comfortable rooms, in the signs of Table 2's joints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import radians

import numpy as np

from liftopt.multibody.agent import Comfort, Lean
from liftopt.multibody.person.range_of_motion import RANGES, TRUNK_JOINTS, JointRange
from liftopt.multibody.person.whole_joints import HANDS, WHOLE_RANGES
from liftopt.multibody.sources import Source

# The open-packed position, in which a shoulder's capsule is at its loosest, is at 30 to 60 deg of abduction.
SHOULDER_AT_REST = Source(
    "Lin et al. (2007), Physical Therapy 87:1669-1682: the glenohumeral joint rests at 49.8 deg of abduction",
    "secondary",
)
ACGIH_TURN = Source("ACGIH TLV for lifting: for lifts that begin within 30 deg of the sagittal plane", "secondary")
# RULA's best lower arm is flexed by 60 to 100 deg; ISO 11064-4 has 70 to 135 deg at a workstation.
ELBOW_AT_EASE = Source(
    "McAtamney & Corlett (1993), Applied Ergonomics 24:91-99 (RULA), and ISO 11064-4:2004", "secondary"
)
MIDDLE = Source("McAtamney & Corlett (1993), Applied Ergonomics 24:91-99 (RULA): forearm in mid-range", "secondary")
TRUNK_BANDS = Source(
    "RULA (McAtamney & Corlett, 1993) and REBA (Hignett & McAtamney, 2000): their last trunk band begins at 60 deg",
    "secondary",
)
UPRIGHT = Source("RULA's best posture; the room is the range of motion", "secondary")


@dataclass(frozen=True)
class JointComfort:
    """Where one joint is at ease.

    Attributes:
        joint: as in ``JointRange``.
        neutral: angle that costs nothing [deg].
        lower, upper: ends of the comfortable angles on either side [deg]; None is the end of the range of motion.
        source: of all of it.
    """

    joint: str
    neutral: float = 0.0
    lower: float | None = None
    upper: float | None = None
    source: Source = UPRIGHT


# The upper arm's room is between hanging and horizontal, which is where RULA's last band begins.
COMFORTS: tuple[JointComfort, ...] = (
    JointComfort("Q1"),
    JointComfort("Q2"),
    JointComfort("Q3", lower=-30.0, upper=30.0, source=ACGIH_TURN),
    JointComfort("Q4", neutral=-50.0, lower=-90.0, upper=0.0, source=SHOULDER_AT_REST),
    JointComfort("Q5"),
    JointComfort("Q6"),
    JointComfort("Q7", neutral=-80.0, lower=-135.0, upper=-60.0, source=ELBOW_AT_EASE),
    JointComfort("Q8", neutral=-80.0, source=MIDDLE),
    JointComfort("Q9"),
    JointComfort("Q10"),
)


# Standing upright with straight legs is the best posture of RULA and of REBA. A knee does not bend backwards: its room
# on that side only has to be some.
LEG_COMFORTS: tuple[JointComfort, ...] = (
    JointComfort("ankle"),
    JointComfort("knee", lower=-135.0),
    JointComfort("hip"),
)
# With legs that bend, the trunk's own flexion has the room that RULA and REBA give the trunk.
BENDING_TRUNK = JointComfort("Q2", upper=60.0, source=TRUNK_BANDS)
WHOLE_COMFORTS: tuple[JointComfort, ...] = (
    *LEG_COMFORTS,
    *(BENDING_TRUNK if item.joint == BENDING_TRUNK.joint else item for item in COMFORTS[:TRUNK_JOINTS]),
    *(replace(item, joint=f"{side}_{item.joint}") for side in HANDS for item in COMFORTS[TRUNK_JOINTS:]),
)


LEAN_ROOM, LEAN_MOST = 60.0, 135.0  # angles of the trunk from the vertical [deg]
LEAN_MOST_SOURCE = Source("beyond what a lift asks for; chosen for this model", "estimate")


def human_lean(joint: str) -> Lean:
    """Return how far a person's trunk may lean who bends at hips, knees and ankles too; ``joint`` carries the trunk."""
    return Lean(joint, radians(LEAN_ROOM), radians(LEAN_MOST))


def human_comfort() -> Comfort:
    """Return where Q1 to Q10 are at ease, arrays (10,)."""
    return _comfort(list(zip(COMFORTS, RANGES, strict=True)))


def whole_comfort() -> Comfort:
    """Return where the joints of the whole body are at ease, arrays (20,): legs, trunk, right arm, left arm."""
    return _comfort(list(zip(WHOLE_COMFORTS, WHOLE_RANGES, strict=True)))


def _comfort(rows: Sequence[tuple[JointComfort, JointRange]]) -> Comfort:
    lower = [item.lower if at.lower is None else at.lower for at, item in rows]
    upper = [item.upper if at.upper is None else at.upper for at, item in rows]
    return Comfort(
        neutral=np.array([radians(at.neutral) for at, _ in rows]),
        room_lower=np.array([radians(at.neutral - end) for (at, _), end in zip(rows, lower, strict=True)]),
        room_upper=np.array([radians(end - at.neutral) for (at, _), end in zip(rows, upper, strict=True)]),
        weight=np.ones(len(rows)),
        square_weight=np.zeros(len(rows)),
    )
