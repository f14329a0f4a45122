"""The guides on how much may be lifted, each with what it says of a lift and how far it applies."""

from __future__ import annotations

from liftopt.ergonomics.acgih import SOURCE as ACGIH_SOURCE
from liftopt.ergonomics.acgih import acgih_limit
from liftopt.ergonomics.lift import Lift, subject_in
from liftopt.ergonomics.measure import Measure
from liftopt.ergonomics.niosh import SOURCE as NIOSH_SOURCE
from liftopt.ergonomics.niosh import Niosh
from liftopt.multibody.sources import Source
from liftopt.multibody.trajectory import AgentTrajectory

ISO_11228_1 = Source(
    "ISO 11228-1:2021, Ergonomics - Manual handling - Part 1: Lifting, lowering and carrying", "secondary"
)
ISO_SMALLEST = 3.0  # kg, the mass of object from which the standard applies
ASIDE = 30.0  # [deg] from the middle up to which the threshold limit values hold
SHARED = "A partner who gives way leaves the person more than this part."


def niosh_measure(equation: Niosh) -> Measure:
    """Return what the revised NIOSH lifting equation says."""
    origin, destination = equation.origin.recommended_weight, equation.destination.recommended_weight
    hand = "hand is" if equation.hands == 1 else "hands are"
    index = f"none, for the {hand} out of its range at one end"
    if min(origin, destination) > 0.0:
        index = f"{equation.lifting_index:.2f}"
    outside = equation.out_of_scope
    scope = f"Outside its scope: {'; '.join(outside)}. " if outside else ""
    multipliers = sorted({equation.origin.cm, equation.destination.cm})
    cm = " and ".join(f"{value:g}" for value in multipliers)
    return Measure(
        "niosh",
        "Revised NIOSH lifting equation",
        "indicative" if outside else "applies",
        f"lifting index {index}; recommended weight {origin:.1f} kg at the start, {destination:.1f} kg at the end",
        f"{scope}Load {equation.load:.2f} kg (average vertical {_force(equation)}), at most "
        f"{equation.largest_load:.2f} kg. {f'{SHARED} ' if equation.is_shared and equation.hands > 1 else ''}Assumed: "
        f"one lift now and then (FM = 1), {equation.coupling} coupling (CM = {cm}), the object put down with control.",
        NIOSH_SOURCE,
        value=equation.load,
        limit=min(origin, destination) or None,
        unit="kg",
    )


def acgih_measure(lift: Lift, person: AgentTrajectory, equation: Niosh) -> Measure:
    """Return what the threshold limit values say."""
    subject, ends = subject_in(lift, person.name), (equation.origin, equation.destination)
    limits = [acgih_limit(subject, end.horizontal, end.vertical) for end in ends]
    found = [limit for limit in limits if limit is not None]
    words = " and ".join("none known to be safe" if limit is None else f"{limit:g} kg" for limit in limits)
    used = f"{100 * equation.largest_load / min(found):.0f} % of it used" if len(found) == 2 else "no limit at one end"
    applies = equation.hands > 1 and not equation.is_shared and all(end.asymmetry <= ASIDE for end in ends)
    return Measure(
        "acgih",
        "ACGIH TLV for lifting",
        "applies" if applies else "indicative",
        f"limits {words} (start and end); {used}",
        f"For two-handed lifts within {ASIDE:g}° of the middle, at most 2 hours a day and 60 lifts an hour (its Table "
        f"1); compared with the largest vertical {_force(equation)}.",
        ACGIH_SOURCE,
        value=equation.largest_load,
        limit=min(found) if len(found) == 2 else None,
        unit="kg",
        time=equation.largest_load_at,
    )


def iso_measure(lift: Lift) -> Measure:
    """Return how ISO 11228-1 stands to a lift; its values are not evaluated."""
    mass, name = lift.scenario.object.mass, lift.object.name
    if mass < ISO_SMALLEST:
        reading = f"The standard starts at {ISO_SMALLEST:g} kg; the {name} has {mass:g} kg."
        return Measure("iso_11228_1", "ISO 11228-1", "out of scope", "not evaluated", reading, ISO_11228_1)
    shared = "shared with a robot" if lift.robots else "shared like this one"
    why = f"it does not treat a lift that is {shared}, and " if len(lift.agents) > 1 else ""
    reading = (
        f"The {name}'s {mass:g} kg are in its range, but {why}its "
        "reference masses and factors could not be checked at their source: evaluate it with the standard at hand."
    )
    return Measure("iso_11228_1", "ISO 11228-1", "indicative", "not evaluated", reading, ISO_11228_1)


def _force(equation: Niosh) -> str:
    return "hand force" if equation.hands == 1 else "force of both hands"
