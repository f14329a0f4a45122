"""Every number of a subject's model with its source, flat, for a report to print."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftopt.multibody.person.anthropometry import LINK_SOURCES, link_lengths
from liftopt.multibody.person.bodies import BODY_SOURCE, human_bodies
from liftopt.multibody.person.comfort import COMFORTS, human_comfort
from liftopt.multibody.person.range_of_motion import RANGES, VELOCITY_SOURCE
from liftopt.multibody.person.strength import STRENGTHS
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.sources import Source


@dataclass(frozen=True)
class Quantity:
    """One number of a model: its group (``"length"``, ``"strength"``...), name, value, unit and source."""

    group: str
    name: str
    value: float
    unit: str
    source: Source


def subject_quantities(subject: Subject) -> tuple[Quantity, ...]:
    """Return all numbers of the subject's model.

    Bodies are stated about their own centre of mass in the upright zero pose (X forward, Y to the left, Z up, from
    the feet); angles are in deg.
    """
    return (*_lengths(subject), *_bodies(subject), *_ranges(), *_comforts(), *_strengths(subject))


def _lengths(subject: Subject) -> list[Quantity]:
    lengths = vars(link_lengths(subject))
    return [Quantity("length", name, lengths[name.lower()], "m", source) for name, source in LINK_SOURCES.items()]


def _bodies(subject: Subject) -> list[Quantity]:
    rows = []
    for joint, body in human_bodies(subject).items():
        inertia = {
            f"I{axes}": float(body.inertia["xyz".index(axes[0]), "xyz".index(axes[1])])
            for axes in ("xx", "yy", "zz", "xy", "xz", "yz")
        }
        rows.append(Quantity("body", f"{joint} mass", body.mass, "kg", BODY_SOURCE))
        rows += [
            Quantity("body", f"{joint} centre of mass {axis}", float(value), "m", BODY_SOURCE)
            for axis, value in zip("xyz", body.com, strict=True)
        ]
        rows += [Quantity("body", f"{joint} {name}", value, "kg m^2", BODY_SOURCE) for name, value in inertia.items()]
    return rows


def _ranges() -> list[Quantity]:
    rows = []
    for item in RANGES:
        rows += [
            Quantity("range of motion", f"{item.joint} {item.negative}", item.lower, "deg", item.lower_source),
            Quantity("range of motion", f"{item.joint} {item.positive}", item.upper, "deg", item.upper_source),
            Quantity("speed", f"{item.joint} either way", item.velocity, "rad/s", VELOCITY_SOURCE),
        ]
    return rows


def _comforts() -> list[Quantity]:
    rows, comfort = [], human_comfort()
    neutral = np.degrees(comfort.neutral)
    lower, upper = neutral - np.degrees(comfort.room_lower), neutral + np.degrees(comfort.room_upper)
    for j, item in enumerate(COMFORTS):
        values = {"neutral": (neutral[j], "deg"), "from": (lower[j], "deg"), "to": (upper[j], "deg")}
        values["weight"] = (comfort.weight[j], "")
        for name, (value, unit) in values.items():
            rows.append(Quantity("ease", f"{item.joint} {name}", float(value), unit, item.source))
    return rows


def _strengths(subject: Subject) -> list[Quantity]:
    return [
        Quantity("strength", f"{item.joint} {item.motion}", item.sign * item.torque[subject.sex], "Nm", item.source)
        for item in STRENGTHS
    ]
