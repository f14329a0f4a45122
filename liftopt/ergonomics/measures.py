"""All ergonomic measures of a lift, each with its scope and its source."""

from __future__ import annotations

from dataclasses import dataclass

from liftopt.ergonomics.coupling import coupling_of
from liftopt.ergonomics.lift import Lift
from liftopt.ergonomics.lifting_guides import acgih_measure, iso_measure, niosh_measure
from liftopt.ergonomics.lifting_style import LiftingStyle, lifting_style
from liftopt.ergonomics.limbs import has_legs
from liftopt.ergonomics.measure import Measure
from liftopt.ergonomics.niosh import Niosh, niosh
from liftopt.ergonomics.posture import Posture, posture_of
from liftopt.ergonomics.posture_measures import reba_measure, rula_measure
from liftopt.ergonomics.reba import Reba, reba
from liftopt.ergonomics.rula import Rula, rula
from liftopt.ergonomics.scores import worse_side
from liftopt.ergonomics.spine import SpineLoad, spine_load
from liftopt.ergonomics.spine_measures import spine_measures
from liftopt.ergonomics.strength import StrengthUse, strength_use
from liftopt.multibody.trajectory import AgentTrajectory


@dataclass(frozen=True)
class Ergonomics:
    """The ergonomics of a person in a lift.

    Attributes:
        strength: use of strength by joint.
        posture: over time.
        rula: its scores, of the worse side.
        reba: its scores, of the worse side; None where the legs do not move.
        styles: how the person stands at the start and at the end; None where the legs do not move.
        spine: the load on the lumbar spine.
        niosh: the lifting equation.
        measures: all of them in words.
    """

    strength: tuple[StrengthUse, ...]
    posture: Posture
    rula: Rula
    reba: Reba | None
    styles: tuple[LiftingStyle, LiftingStyle] | None
    spine: SpineLoad
    niosh: Niosh
    measures: tuple[Measure, ...]


def ergonomics_of(lift: Lift, person: AgentTrajectory) -> Ergonomics:
    """Return the ergonomic measures of a person in a lift at its times; a finer grid sees what is between the knots."""
    strength, posture, equation = strength_use(lift, person), posture_of(lift, person), niosh(lift, person)
    legs, spine = has_legs(person), spine_load(lift, person)
    upper = worse_side(rula(posture))
    entire = worse_side(reba(posture, coupling_of(lift, person))) if legs else None
    measures = [rula_measure(upper, lift.time, len(posture.arms))]
    if entire is not None:
        measures.append(reba_measure(entire, lift.time))
    measures += [*spine_measures(spine, lift.time), niosh_measure(equation), iso_measure(lift)]
    measures.append(acgih_measure(lift, person, equation))
    styles = (lifting_style(posture, 0), lifting_style(posture, -1)) if legs else None
    return Ergonomics(strength, posture, upper, entire, styles, spine, equation, tuple(measures))
