"""The bodies that the joints of Table 2 move: de Leva's segments of the upright subject, lumped."""

from __future__ import annotations

import numpy as np

from liftopt.multibody.dh import BodyInertia
from liftopt.multibody.person.anthropometry import (
    HEEL_BEHIND_ANKLE,
    HIP_JOINT_SPREAD,
    dimension,
    landmarks,
    link_lengths,
)
from liftopt.multibody.person.segments import SEGMENTS, hanging_segment, standing_foot
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.sources import DE_LEVA_ON_ANSUR, Source
from liftopt.types import Array

BODY_SOURCE: Source = DE_LEVA_ON_ANSUR
RIGHT, LEFT = -1.0, 1.0


def human_bodies(subject: Subject) -> dict[str, BodyInertia]:
    """Return the bodies that carry the subject's whole mass, by the DH row that moves them.

    Frame: the upright zero pose in world axes, feet at the origin, X forward, Y to the left, Z up. The pelvis and
    both legs stand on GT3 and do not move; the trunk with head and the passive left arm, which hangs, follows Q3.
    """
    arm, lower = _arm(subject, RIGHT), _pelvis(subject)
    for side in (LEFT, RIGHT):
        for part in _leg(subject, side).values():
            lower += part
    trunk = _trunk(subject)
    for part in _arm(subject, LEFT).values():
        trunk += part
    return {"GT3": lower, "Q3": trunk, "Q6": arm["upper_arm"], "Q8": arm["forearm"], "Q10": arm["hand"]}


def whole_bodies(subject: Subject) -> dict[str, BodyInertia]:
    """Return the same mass with legs and arms that move, by joint; the feet rest and are ``"feet"``.

    Frame as above. Both legs move as one in the sagittal plane: a body of the legs is the two of them.
    """
    left, right = _leg(subject, LEFT), _leg(subject, RIGHT)
    bodies = {
        "feet": left["foot"] + right["foot"],
        "ankle": left["shank"] + right["shank"],
        "knee": left["thigh"] + right["thigh"],
        "hip": _pelvis(subject),
        "Q3": _trunk(subject),
    }
    for side, word in ((RIGHT, "right"), (LEFT, "left")):
        arm = _arm(subject, side)
        bodies |= {
            f"{word}_Q6": arm["upper_arm"],
            f"{word}_Q8": arm["forearm"],
            f"{word}_Q10": arm["hand"],
        }
    return bodies


def _pelvis(subject: Subject) -> BodyInertia:
    at = landmarks(subject)
    return hanging_segment(subject, "lower_trunk", _axis(at.omphalion), at.omphalion - at.hip)


def _leg(subject: Subject, side: float) -> dict[str, BodyInertia]:
    at, foot_length = landmarks(subject), dimension(subject, "footlength")
    y = side * HIP_JOINT_SPREAD * dimension(subject, "hipbreadth")
    heel = np.array([-HEEL_BEHIND_ANKLE * foot_length, y, at.ankle / 2.0])
    return {
        "thigh": hanging_segment(subject, "thigh", np.array([0.0, y, at.hip]), at.hip - at.knee),
        "shank": hanging_segment(subject, "shank", np.array([0.0, y, at.knee]), at.knee - at.ankle),
        "foot": standing_foot(subject, heel, foot_length),
    }


def _trunk(subject: Subject) -> BodyInertia:
    at = landmarks(subject)
    head_length = SEGMENTS[subject.sex]["head"].length * subject.stature
    body = hanging_segment(subject, "middle_trunk", _axis(at.xiphion), at.xiphion - at.omphalion)
    body += hanging_segment(subject, "upper_trunk", _axis(at.suprasternale), at.suprasternale - at.xiphion)
    body += hanging_segment(subject, "head", _axis(at.vertex), head_length)
    return body


def _arm(subject: Subject, side: float) -> dict[str, BodyInertia]:
    lengths = link_lengths(subject)
    shoulder = np.array([0.0, side * lengths.l3, lengths.l1 + lengths.l2])
    elbow = shoulder - _axis(lengths.l4)
    wrist = elbow - _axis(lengths.l5)
    return {
        "upper_arm": hanging_segment(subject, "upper_arm", shoulder, lengths.l4),
        "forearm": hanging_segment(subject, "forearm", elbow, lengths.l5),
        "hand": hanging_segment(subject, "hand", wrist, lengths.l6),
    }


def _axis(height: float) -> Array:
    return np.array([0.0, 0.0, height])
