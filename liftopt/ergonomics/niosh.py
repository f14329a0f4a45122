"""The revised NIOSH lifting equation at the start and the end of the lift; it is made for one person's two hands."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftopt.ergonomics.coupling import COUPLED, Coupling, coupling_of
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
    cm: float
    fm: float = FREQUENCY_MULTIPLIER

    @property
    def recommended_weight(self) -> float:
        """RWL = LC HM VM DM AM FM CM [kg]."""
        return LOAD_CONSTANT * self.hm * self.vm * self.dm * self.am * self.fm * self.cm


@dataclass(frozen=True)
class Niosh:
    """Load and equation of a lift.

    Attributes:
        load: what the person carries on average over the lift: vertical force of all hands / g [kg].
        largest_load: the same at its largest [kg].
        largest_load_at: when that is [s].
        origin, destination: the equation at either end, for the point between the hands.
        hand_speed: fastest speed of that point [m/s].
        hands: how many hold the object.
        is_shared: whether others lift with the person.
        coupling: how well the object can be held.
    """

    load: float
    largest_load: float
    largest_load_at: float
    origin: NioshTerms
    destination: NioshTerms
    hand_speed: float
    hands: int
    is_shared: bool
    coupling: Coupling

    @property
    def lifting_index(self) -> float:
        """Average load over the smaller recommended weight; infinite where nothing may be lifted."""
        weight = min(self.origin.recommended_weight, self.destination.recommended_weight)
        return self.load / weight if weight > 0.0 else np.inf

    @property
    def out_of_scope(self) -> tuple[str, ...]:
        """Why the equation does not apply, so that it is an indication only; nothing where it does."""
        moves = "hand moves" if self.hands == 1 else "hands move"
        why = {
            "it is not for one-handed lifts": self.hands == 1,
            "it is not for a load that is shared: the person's part of it stands for the load here": self.is_shared,
            f"the {moves} at up to {self.hand_speed:.2f} m/s, above {FASTEST:g} m/s": self.hand_speed > FASTEST,
        }
        return tuple(words for words, holds in why.items() if holds)


def niosh(lift: Lift, person: AgentTrajectory) -> Niosh:
    """Return the equation for a person's part of the lift."""
    load, hand = person.load[:, 2] / GRAVITY, person.p_world_hold
    ends, coupling = hand[[0, -1]], coupling_of(lift, person)
    travel = abs(float(ends[1, 2] - ends[0, 2])) * 100.0
    speed = np.linalg.norm(np.gradient(hand, lift.time, axis=0), axis=1)
    mean = float(np.trapezoid(load, lift.time) / (lift.time[-1] - lift.time[0]))
    k = int(np.argmax(load))
    places = (ends - p_world_feet(lift, person.name)) @ R_world_person(lift, person.name)
    origin, destination = (_at(place, travel, coupling) for place in places)
    return Niosh(
        load=mean,
        largest_load=float(load[k]),
        largest_load_at=float(lift.time[k]),
        origin=origin,
        destination=destination,
        hand_speed=float(speed.max()),
        hands=len(person.grasps),
        is_shared=len(lift.agents) > 1,
        coupling=coupling,
    )


def niosh_terms(
    horizontal: float, vertical: float, travel: float, asymmetry: float, coupling: Coupling = "poor"
) -> NioshTerms:
    """Return the multipliers for H, V, D [cm] and A [deg]; out of the range of a variable its multiplier is 0."""
    low, high = COUPLED[coupling]
    return NioshTerms(
        horizontal,
        vertical,
        travel,
        asymmetry,
        hm=0.0 if horizontal > 63.0 else 25.0 / max(horizontal, 25.0),
        vm=1.0 - 0.003 * abs(vertical - 75.0) if 0.0 <= vertical <= 175.0 else 0.0,
        dm=0.0 if travel > 175.0 else 0.82 + 4.5 / max(travel, 25.0),
        am=0.0 if asymmetry > 135.0 else 1.0 - 0.0032 * asymmetry,
        cm=low if vertical < 75.0 else high,
    )


def _at(hand: Array, travel: float, coupling: Coupling) -> NioshTerms:
    """Return the equation for the point between the hands (3,), from between the ankles: ahead, to the left, up [m]."""
    x, y, z = hand
    return niosh_terms(
        horizontal=100.0 * float(np.hypot(x, y)),
        vertical=100.0 * float(z),
        travel=travel,
        asymmetry=abs(float(np.degrees(np.arctan2(y, x)))),
        coupling=coupling,
    )
