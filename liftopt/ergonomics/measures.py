"""All ergonomic measures of a lift, each with its scope and its source."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from liftopt.ergonomics.acgih import SOURCE as ACGIH_SOURCE
from liftopt.ergonomics.acgih import acgih_limit
from liftopt.ergonomics.lift import Lift, subject_in
from liftopt.ergonomics.niosh import COUPLING_MULTIPLIER, Niosh, niosh
from liftopt.ergonomics.niosh import SOURCE as NIOSH_SOURCE
from liftopt.ergonomics.posture import Posture, posture_of
from liftopt.ergonomics.rula import ACTION, Rula, rula
from liftopt.ergonomics.rula_tables import SOURCE as RULA_SOURCE
from liftopt.ergonomics.strength import StrengthUse, strength_use
from liftopt.multibody.sources import Source
from liftopt.multibody.trajectory import AgentTrajectory

Scope = Literal["applies", "indicative", "out of scope"]

ISO_11228_1 = Source(
    "ISO 11228-1:2021, Ergonomics - Manual handling - Part 1: Lifting, lowering and carrying", "secondary"
)
ISO_SMALLEST = 3.0  # kg, the mass of object from which the standard applies


@dataclass(frozen=True)
class Measure:
    """One measure as a reader should take it.

    Attributes:
        code: a word for it.
        name: of the method.
        scope: whether it applies to this lift.
        result: in one line.
        reading: what the result says, or why there is none.
        source: of the method and its tables.
        value: the result as a number, if there is one.
        limit: the method's own limit on it; None where it has none for this lift.
        unit: of both.
        time: of the value [s]; None where it is not of one moment.
    """

    code: str
    name: str
    scope: Scope
    result: str
    reading: str
    source: Source
    value: float | None = None
    limit: float | None = None
    unit: str = ""
    time: float | None = None


@dataclass(frozen=True)
class Ergonomics:
    """The ergonomics of a person in a lift.

    Attributes:
        strength: use of strength by joint.
        posture: over time.
        rula: its scores.
        niosh: the lifting equation.
        measures: all of them in words.
    """

    strength: tuple[StrengthUse, ...]
    posture: Posture
    rula: Rula
    niosh: Niosh
    measures: tuple[Measure, ...]


def ergonomics_of(lift: Lift, person: AgentTrajectory) -> Ergonomics:
    """Return the ergonomic measures of a person in a lift at its times; a finer grid sees what is between the knots."""
    strength, posture, equation = strength_use(lift, person), posture_of(lift, person), niosh(lift, person)
    scores = rula(posture)
    measures = (_rula(scores, lift), _niosh(equation), _iso(lift), _acgih(lift, person, equation))
    return Ergonomics(strength, posture, scores, equation, measures)


def _rula(scores: Rula, lift: Lift) -> Measure:
    worst = int(scores.grand.max())
    best, at = int(scores.grand.min()), float(lift.time[scores.worst])
    span = f"{worst}" if best == worst else f"{best} to {worst}"
    part = 100.0 * float((scores.grand == worst).mean())
    return Measure(
        "posture",
        "RULA",
        "applies",
        f"grand score {span} of 7",
        f"At its worst ({at:.2f} s, {part:.0f} % of the lift): {ACTION[worst]}. Made for seated and standing work of "
        "the arms; a lower bound here, for what the model lacks (the neck, a raised shoulder) is scored at its best.",
        RULA_SOURCE,
        value=float(worst),
        unit="of 7",
        time=at,
    )


def _niosh(equation: Niosh) -> Measure:
    origin, destination = equation.origin.recommended_weight, equation.destination.recommended_weight
    index = "none, for the hand is out of its range at one end"
    if min(origin, destination) > 0.0:
        index = f"{equation.lifting_index:.2f}"
    return Measure(
        "niosh",
        "Revised NIOSH lifting equation",
        "indicative",
        f"lifting index {index}; recommended weight {origin:.1f} kg at the start, {destination:.1f} kg at the end",
        f"Outside its scope: {'; '.join(equation.out_of_scope)}. Load {equation.load:.2f} kg (average vertical hand "
        f"force), at most {equation.largest_load:.2f} kg. Assumed: one lift now and then (FM = 1), poor coupling "
        f"(CM = {COUPLING_MULTIPLIER:g}), the object put down with control.",
        NIOSH_SOURCE,
        value=equation.load,
        limit=min(origin, destination) or None,
        unit="kg",
    )


def _iso(lift: Lift) -> Measure:
    mass, name = lift.scenario.object.mass, lift.object.name
    if mass < ISO_SMALLEST:
        reading = f"The standard starts at {ISO_SMALLEST:g} kg; the {name} has {mass:g} kg."
        return Measure("iso_11228_1", "ISO 11228-1", "out of scope", "not evaluated", reading, ISO_11228_1)
    shared = "shared with a robot" if lift.robots else "shared like this one"
    reading = (
        f"The {name}'s {mass:g} kg are in its range, but it does not treat a lift that is {shared}, and its "
        "reference masses and factors could not be checked at their source: evaluate it with the standard at hand."
    )
    return Measure("iso_11228_1", "ISO 11228-1", "indicative", "not evaluated", reading, ISO_11228_1)


def _acgih(lift: Lift, person: AgentTrajectory, equation: Niosh) -> Measure:
    subject = subject_in(lift, person.name)
    ends = [acgih_limit(subject, end.horizontal, end.vertical) for end in (equation.origin, equation.destination)]
    found = [limit for limit in ends if limit is not None]
    words = " and ".join("none known to be safe" if limit is None else f"{limit:g} kg" for limit in ends)
    used = f"{100 * equation.largest_load / min(found):.0f} % of it used" if len(found) == 2 else "no limit at one end"
    return Measure(
        "acgih",
        "ACGIH TLV for lifting",
        "indicative",
        f"limits {words} (start and end); {used}",
        "For two-handed lifts within 30° of the middle, at most 2 hours a day and 60 lifts an hour (its Table 1); "
        "compared with the largest vertical hand force.",
        ACGIH_SOURCE,
        value=equation.largest_load,
        limit=min(found) if len(found) == 2 else None,
        unit="kg",
        time=equation.largest_load_at,
    )
