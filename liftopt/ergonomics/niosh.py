"""The revised NIOSH lifting equation at the start and the end of the lift; indicative only for a shared lift."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftopt.ergonomics.lift import Lift, R_world_person, p_world_feet
from liftopt.multibody.sources import Source
from liftopt.multibody.trajectory import GRAVITY, AgentTrajectory
from liftopt.types import Array

SOURCE = Source(
    "Waters, Putz-Anderson, Garg & Fine (1993), Ergonomics 36:749-776; Applications Manual for the Revised NIOSH "
    "Lifting Equation, DHHS (NIOSH) Publication 94-110",
    "secondary",
)
LOAD_CONSTANT = 23.0  # kg
FREQUENCY_MULTIPLIER = 1.0  # one lift in five minutes or fewer, for an hour or less
COUPLING_MULTIPLIER = 0.90  # poor: a thin edge without a handle
FASTEST = 0.76  # m/s, 30 in/s; the manual excludes faster lifts


@dataclass(frozen=True)
class NioshTerms:
    """The equation at one end of the lift.

    Attributes:
        horizontal, vertical, travel: H, V, D [cm].
        asymmetry: A [deg].
        hm, vm, dm, am, fm, cm: multipliers.
    """

    horizontal: float
    vertical: float
    travel: float
    asymmetry: float
    hm: float
    vm: float
    dm: float
    am: float
    fm: float = FREQUENCY_MULTIPLIER
    cm: float = COUPLING_MULTIPLIER

    @property
    def recommended_weight(self) -> float:
        """RWL = LC HM VM DM AM FM CM [kg]."""
        return LOAD_CONSTANT * self.hm * self.vm * self.dm * self.am * self.fm * self.cm


@dataclass(frozen=True)
class Niosh:
    """Load and equation of a lift.

    Attributes:
        load: what the person carries on average over the lift: vertical hand force / g [kg].
        largest_load: the same at its largest [kg].
        largest_load_at: when that is [s].
        origin, destination: the equation at either end.
        hand_speed: fastest speed of the hand [m/s].
    """

    load: float
    largest_load: float
    largest_load_at: float
    origin: NioshTerms
    destination: NioshTerms
    hand_speed: float

    @property
    def lifting_index(self) -> float:
        """Average load over the smaller recommended weight; infinite where nothing may be lifted."""
        weight = min(self.origin.recommended_weight, self.destination.recommended_weight)
        return self.load / weight if weight > 0.0 else np.inf

    @property
    def out_of_scope(self) -> tuple[str, ...]:
        """Why the equation does not apply; it is shown as an indication only."""
        why = (
            "it is not for one-handed lifts",
            "it is not for a load that is shared: the person's part of it stands for the load here",
        )
        fast = f"the hand moves at up to {self.hand_speed:.2f} m/s, above {FASTEST:g} m/s"
        return (*why, fast) if self.hand_speed > FASTEST else why


def niosh(lift: Lift, person: AgentTrajectory) -> Niosh:
    """Return the equation for a person's part of the lift."""
    load, ends = person.load[:, 2] / GRAVITY, person.p_world_hold[[0, -1]]
    travel = abs(float(ends[1, 2] - ends[0, 2])) * 100.0
    speed = np.linalg.norm(np.gradient(person.p_world_hold, lift.time, axis=0), axis=1)
    mean = float(np.trapezoid(load, lift.time) / (lift.time[-1] - lift.time[0]))
    k = int(np.argmax(load))
    hands = (ends - p_world_feet(lift, person.name)) @ R_world_person(lift, person.name)
    origin, destination = (_at(hand, travel) for hand in hands)
    return Niosh(mean, float(load[k]), float(lift.time[k]), origin, destination, float(speed.max()))


def niosh_terms(horizontal: float, vertical: float, travel: float, asymmetry: float) -> NioshTerms:
    """Return the multipliers for H, V, D [cm] and A [deg]; out of the range of a variable its multiplier is 0."""
    return NioshTerms(
        horizontal,
        vertical,
        travel,
        asymmetry,
        hm=0.0 if horizontal > 63.0 else 25.0 / max(horizontal, 25.0),
        vm=1.0 - 0.003 * abs(vertical - 75.0) if 0.0 <= vertical <= 175.0 else 0.0,
        dm=0.0 if travel > 175.0 else 0.82 + 4.5 / max(travel, 25.0),
        am=0.0 if asymmetry > 135.0 else 1.0 - 0.0032 * asymmetry,
    )


def _at(hand: Array, travel: float) -> NioshTerms:
    """Return the equation for a hand (3,) from between the ankles: ahead, to the left, up [m]."""
    x, y, z = hand
    return niosh_terms(
        horizontal=100.0 * float(np.hypot(x, y)),
        vertical=100.0 * float(z),
        travel=travel,
        asymmetry=abs(float(np.degrees(np.arctan2(y, x)))),
    )
