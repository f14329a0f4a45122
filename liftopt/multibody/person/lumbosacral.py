"""Where the disc between the last lumbar vertebra and the sacrum (L5/S1) is, and what lies between it and the trunk."""

from __future__ import annotations

from math import cos, radians, sin

import numpy as np
import pinocchio as pin

from liftopt.multibody.disc import Disc, Lumbosacral
from liftopt.multibody.person.anthropometry import landmarks, link_lengths
from liftopt.multibody.person.lumbar_levers import COMPRESSION_LIMIT, EXTENSOR, FLANK, FLEXOR
from liftopt.multibody.person.segments import SEGMENTS, segment_mass
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.sources import Source
from liftopt.types import Array

HEIGHT = 0.20  # of L5/S1 above the hip joints, over the distance from hip to shoulder joints
HEIGHT_SOURCE = Source(
    "Chaffin, Andersson & Martin, Occupational Biomechanics: L5/S1 a fifth of the way from hip to shoulder",
    "unverified",
)
SACRAL_SLOPE = 40.0  # [deg] of the sacrum's upper face against the horizontal, its front edge down, where one stands
SLOPE_SOURCE = Source(
    "Mac-Thiong, Roussouly, Berthonnaud & Guigui (2011), Eur Spine J 20 Suppl 5:572-577: 24 to 55 deg hold 95 % of 709 "
    "asymptomatic adults",
    "secondary",
)
UP = np.array([0.0, 0.0, 1.0])


def lumbosacral(subject: Subject) -> Lumbosacral:
    """Return the disc of a subject.

    The part of the pelvis above it is a slice of de Leva's lower trunk, as heavy as it is high, round about its axis.
    """
    at, lengths = landmarks(subject), link_lengths(subject)
    below = at.omphalion - at.hip - HEIGHT * (lengths.l1 + lengths.l2 - at.hip)
    whole = at.omphalion - at.hip
    mass = segment_mass(subject, "lower_trunk") * below / whole
    about_axis = mass * (SEGMENTS[subject.sex]["lower_trunk"].r_long * whole) ** 2
    across = about_axis / 2.0 + mass * below**2 / 12.0
    slope = radians(SACRAL_SLOPE)
    return Lumbosacral(
        below,
        np.array([sin(slope), 0.0, cos(slope)]),
        np.array([cos(slope), 0.0, -sin(slope)]),
        pin.Inertia(mass, -below / 2.0 * UP, np.diag([across, across, about_axis])),
    )


def pressed_disc(subject: Subject, joint: str, upright: Array, most: float) -> Disc:
    """Return the disc of a subject that must not be pressed with more than so much.

    The muscle behind it or the one ahead of it bears the moment that extends, one of those beside it the lateral one.

    Args:
        subject: who it is.
        joint: name of the joint at the base of the spine.
        upright: (3, 3) forward, left and up in the world where the subject stands upright.
        most: largest compression [N].
    """
    factors = [[1.0, flank / FLANK, behind] for behind in (1.0 / EXTENSOR, -1.0 / FLEXOR) for flank in (1.0, -1.0)]
    muscles = tuple(f"spine ({behind}, {flank})" for behind in ("back", "belly") for flank in ("right", "left"))
    return Disc(joint, upright, lumbosacral(subject), np.array(factors), muscles, most, COMPRESSION_LIMIT)
