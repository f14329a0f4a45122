"""Mass, centre of mass and radii of gyration of body segments: de Leva (1996), Table 4."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftopt.multibody.dh import BodyInertia
from liftopt.multibody.person.subject import Sex, Subject
from liftopt.multibody.sources import DE_LEVA_1996, Source
from liftopt.types import Array

SOURCE: Source = DE_LEVA_1996


@dataclass(frozen=True)
class Segment:
    """One segment of the table, its fractions; the upper end is the proximal one, for the head the vertex.

    Attributes:
        length: over stature (the table's length over the mean stature of its sample).
        mass: over body mass.
        com: distance of the centre of mass from the upper end, over segment length (for the foot from the heel).
        r_ap, r_ml, r_long: radii of gyration about the anteroposterior, mediolateral and longitudinal (vertical) axis
            through the centre of mass, over segment length. The table's "sagittal" column is taken as the
            anteroposterior axis and "transverse" as the mediolateral one; for the foot the longitudinal axis lies
            anteroposterior.
    """

    length: float
    mass: float
    com: float
    r_ap: float
    r_ml: float
    r_long: float


# Lengths in mm over the mean stature in mm of the sample.
_MALE, _FEMALE = 1741.0, 1735.0
SEGMENTS: dict[Sex, dict[str, Segment]] = {
    "male": {
        "head": Segment(203.3 / _MALE, 0.0694, 0.5976, 0.362, 0.376, 0.312),
        "upper_trunk": Segment(170.7 / _MALE, 0.1596, 0.2999, 0.716, 0.454, 0.659),
        "middle_trunk": Segment(215.5 / _MALE, 0.1633, 0.4502, 0.482, 0.383, 0.468),
        "lower_trunk": Segment(145.7 / _MALE, 0.1117, 0.6115, 0.615, 0.551, 0.587),
        "upper_arm": Segment(281.7 / _MALE, 0.0271, 0.5772, 0.285, 0.269, 0.158),
        "forearm": Segment(268.9 / _MALE, 0.0162, 0.4574, 0.276, 0.265, 0.121),
        "hand": Segment(86.2 / _MALE, 0.0061, 0.7900, 0.628, 0.513, 0.401),
        "thigh": Segment(422.2 / _MALE, 0.1416, 0.4095, 0.329, 0.329, 0.149),
        "shank": Segment(434.0 / _MALE, 0.0433, 0.4459, 0.255, 0.249, 0.103),
        "foot": Segment(258.1 / _MALE, 0.0137, 0.4415, 0.124, 0.257, 0.245),
    },
    "female": {
        "head": Segment(200.2 / _FEMALE, 0.0668, 0.5894, 0.330, 0.359, 0.318),
        "upper_trunk": Segment(142.5 / _FEMALE, 0.1545, 0.2077, 0.746, 0.502, 0.718),
        "middle_trunk": Segment(205.3 / _FEMALE, 0.1465, 0.4512, 0.433, 0.354, 0.415),
        "lower_trunk": Segment(181.5 / _FEMALE, 0.1247, 0.4920, 0.433, 0.402, 0.444),
        "upper_arm": Segment(275.1 / _FEMALE, 0.0255, 0.5754, 0.278, 0.260, 0.148),
        "forearm": Segment(264.3 / _FEMALE, 0.0138, 0.4559, 0.261, 0.257, 0.094),
        "hand": Segment(78.0 / _FEMALE, 0.0056, 0.7474, 0.531, 0.454, 0.335),
        "thigh": Segment(368.5 / _FEMALE, 0.1478, 0.3612, 0.369, 0.364, 0.162),
        "shank": Segment(432.3 / _FEMALE, 0.0481, 0.4416, 0.271, 0.267, 0.093),
        "foot": Segment(228.3 / _FEMALE, 0.0129, 0.4014, 0.139, 0.299, 0.279),
    },
}
PAIRED = ("upper_arm", "forearm", "hand", "thigh", "shank", "foot")


def segment_mass(subject: Subject, name: str) -> float:
    """Return the mass of one segment [kg]; the whole body's segments sum to the subject's mass.

    The fractions of the printed table sum to 1 within its last digit (female 0.9999) and are normalised.
    """
    table = SEGMENTS[subject.sex]
    total = sum(segment.mass * (2 if key in PAIRED else 1) for key, segment in table.items())
    return subject.mass * table[name].mass / total


def hanging_segment(subject: Subject, name: str, top: Array, length: float) -> BodyInertia:
    """Return a vertical segment whose upper end is at ``top`` (3,) [m] and that is ``length`` [m] long.

    Frame: the upright zero pose, X forward, Y to the left, Z up. The foot is placed by ``standing_foot``.
    """
    segment = SEGMENTS[subject.sex][name]
    com = top - np.array([0.0, 0.0, segment.com * length])
    return _body(subject, name, com, length)


def standing_foot(subject: Subject, heel: Array, length: float) -> BodyInertia:
    """Return a foot that points forward from its ``heel`` (3,) [m], ``length`` [m] long; frame as above."""
    segment = SEGMENTS[subject.sex]["foot"]
    return _body(subject, "foot", heel + np.array([segment.com * length, 0.0, 0.0]), length)


def _body(subject: Subject, name: str, com: Array, length: float) -> BodyInertia:
    segment, mass = SEGMENTS[subject.sex][name], segment_mass(subject, name)
    radii = length * np.array([segment.r_ap, segment.r_ml, segment.r_long])
    return BodyInertia(mass, com, np.diag(mass * radii**2))
