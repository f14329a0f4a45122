"""How much of a person's strength each joint uses over the lift."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftopt.ergonomics.lift import Lift
from liftopt.multibody.trajectory import AgentTrajectory, limit_share
from liftopt.types import Array


@dataclass(frozen=True)
class StrengthUse:
    """Use of strength of one joint.

    Attributes:
        joint: name in Table 2.
        share: (K,) torque as a fraction of the strength in its direction.
        peak: largest share.
        peak_at: time of it [s].
        mean: over the lift.
    """

    joint: str
    share: Array
    peak: float
    peak_at: float
    mean: float


def strength_use(lift: Lift, person: AgentTrajectory) -> tuple[StrengthUse, ...]:
    """Return the use of strength of a person's joints, in the order of Table 2."""
    return tuple(
        _use(name.removeprefix(f"{person.name}_"), share, lift.time)
        for name, share in zip(person.moving_joints, limit_share(person).T, strict=True)
    )


def _use(joint: str, share: Array, time: Array) -> StrengthUse:
    at = int(np.argmax(share))
    mean = float(np.trapezoid(share, time) / (time[-1] - time[0]))
    return StrengthUse(joint, share, float(share[at]), float(time[at]), mean)
