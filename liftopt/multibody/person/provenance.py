"""Every number of a subject's model with its source, flat, for a report to print."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from liftopt.multibody.agent import Comfort
from liftopt.multibody.dh import BodyInertia
from liftopt.multibody.person.anthropometry import JOINT_SOURCES, LINK_SOURCES, landmarks, link_lengths
from liftopt.multibody.person.bodies import BODY_SOURCE, human_bodies, whole_bodies
from liftopt.multibody.person.comfort import (
    COMFORTS,
    LEAN_MOST,
    LEAN_MOST_SOURCE,
    LEAN_ROOM,
    TRUNK_BANDS,
    WHOLE_COMFORTS,
    JointComfort,
    human_comfort,
    whole_comfort,
)
from liftopt.multibody.person.leg_strength import LegStrength
from liftopt.multibody.person.range_of_motion import RANGES, VELOCITY_SOURCE, JointRange
from liftopt.multibody.person.stance import (
    ASIDE_SOURCE,
    BACK_SOURCE,
    FRICTION_SOURCE,
    FRONT_SOURCE,
    SWAY,
    SWAY_SOURCE,
    human_stance,
)
from liftopt.multibody.person.strength import STRENGTHS, Strength
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.person.whole_joints import WHOLE_RANGES, WHOLE_STRENGTHS
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
    return (
        *_lengths(subject),
        *_bodies(human_bodies(subject)),
        *_ranges(RANGES),
        *_comforts(COMFORTS, human_comfort()),
        *_strengths(STRENGTHS, subject),
    )


def whole_quantities(subject: Subject) -> tuple[Quantity, ...]:
    """Return all numbers of the subject's model with legs and two arms; the bodies of the legs are both legs'."""
    return (
        *_lengths(subject),
        *_heights(subject),
        *_stance(subject),
        *_bodies(whole_bodies(subject)),
        *_ranges(WHOLE_RANGES),
        *_comforts(WHOLE_COMFORTS, whole_comfort()),
        *_strengths(WHOLE_STRENGTHS, subject),
        Quantity("lean", "trunk from the vertical, at ease to", LEAN_ROOM, "deg", TRUNK_BANDS),
        Quantity("lean", "trunk from the vertical, at most", LEAN_MOST, "deg", LEAN_MOST_SOURCE),
    )


def _lengths(subject: Subject) -> list[Quantity]:
    lengths = vars(link_lengths(subject))
    return [Quantity("length", name, lengths[name.lower()], "m", source) for name, source in LINK_SOURCES.items()]


def _heights(subject: Subject) -> list[Quantity]:
    heights = vars(landmarks(subject))
    return [Quantity("height", joint, heights[joint], "m", source) for joint, source in JOINT_SOURCES.items()]


def _stance(subject: Subject) -> list[Quantity]:
    stance = human_stance(subject)
    (back, front, aside), *_ = stance.soles
    return [
        Quantity("stance", "soles from", back, "m", BACK_SOURCE),
        Quantity("stance", "soles to", front, "m", FRONT_SOURCE),
        Quantity("stance", "soles to either side", aside, "m", ASIDE_SOURCE),
        Quantity("stance", "room left for sway", SWAY, "m", SWAY_SOURCE),
        Quantity("stance", "friction", stance.friction, "", FRICTION_SOURCE),
    ]


def _bodies(bodies: Mapping[str, BodyInertia]) -> list[Quantity]:
    rows = []
    for joint, body in bodies.items():
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


def _ranges(ranges: Iterable[JointRange]) -> list[Quantity]:
    rows = []
    for item in ranges:
        rows += [
            Quantity("range of motion", f"{item.joint} {item.negative}", item.lower, "deg", item.lower_source),
            Quantity("range of motion", f"{item.joint} {item.positive}", item.upper, "deg", item.upper_source),
            Quantity("speed", f"{item.joint} either way", item.velocity, "rad/s", VELOCITY_SOURCE),
        ]
    return rows


def _comforts(items: Sequence[JointComfort], comfort: Comfort) -> list[Quantity]:
    rows, neutral = [], np.degrees(comfort.neutral)
    lower, upper = neutral - np.degrees(comfort.room_lower), neutral + np.degrees(comfort.room_upper)
    for j, item in enumerate(items):
        values = {"neutral": (neutral[j], "deg"), "from": (lower[j], "deg"), "to": (upper[j], "deg")}
        values["weight"] = (comfort.weight[j], "")
        for name, (value, unit) in values.items():
            rows.append(Quantity("ease", f"{item.joint} {name}", float(value), unit, item.source))
    return rows


def _strengths(strengths: Iterable[Strength | LegStrength], subject: Subject) -> list[Quantity]:
    return [
        Quantity("strength", f"{item.joint} {item.motion}", item.sign * item.of(subject), "Nm", item.source)
        for item in strengths
    ]
