"""Where a person's joints are at ease: neutral angles and comfortable rooms, in the signs of Table 2's joints."""

from __future__ import annotations

from dataclasses import dataclass
from math import radians

import numpy as np

from liftopt.multibody.agent import Comfort
from liftopt.multibody.person.range_of_motion import RANGES
from liftopt.multibody.sources import MODEL_CHOICE, Source


@dataclass(frozen=True)
class JointComfort:
    """Where one joint of Table 2 is at ease.

    Attributes:
        joint: ``"Q1"`` to ``"Q10"``.
        neutral: angle that costs nothing [deg].
        lower, upper: comfortable angles on either side [deg]; None is the end of the range of motion.
        weight: how much the end of the room counts beside that of other joints.
        source: of all of it.
    """

    joint: str
    neutral: float = 0.0
    lower: float | None = None
    upper: float | None = None
    weight: float = 1.0
    source: Source = MODEL_CHOICE


# The rest stand upright with the arm hanging. The upper arm a little away from the trunk, the elbow bent and the
# forearm half pronated is how hands hold an edge; a turn of the trunk under load is what guides to lifting advise
# against first.
COMFORTS: tuple[JointComfort, ...] = (
    JointComfort("Q1"),
    JointComfort("Q2"),
    JointComfort("Q3", weight=4.0),
    JointComfort("Q4", neutral=-30.0, lower=-90.0, upper=-10.0),
    JointComfort("Q5"),
    JointComfort("Q6"),
    JointComfort("Q7", neutral=-80.0),
    JointComfort("Q8", neutral=-80.0),
    JointComfort("Q9"),
    JointComfort("Q10"),
)


def human_comfort() -> Comfort:
    """Return where Q1 to Q10 are at ease, arrays (10,)."""
    rows = list(zip(COMFORTS, RANGES, strict=True))
    lower = [item.lower if at.lower is None else at.lower for at, item in rows]
    upper = [item.upper if at.upper is None else at.upper for at, item in rows]
    return Comfort(
        neutral=np.array([radians(at.neutral) for at in COMFORTS]),
        room_lower=np.array([radians(at.neutral - end) for at, end in zip(COMFORTS, lower, strict=True)]),
        room_upper=np.array([radians(end - at.neutral) for at, end in zip(COMFORTS, upper, strict=True)]),
        weight=np.array([at.weight for at in COMFORTS]),
        square_weight=np.zeros(len(COMFORTS)),
    )
