"""The subject's shapes, drawn and collided with: primitives sized from the body dimensions.

Breadths, depths and girths are ANSUR II's (``anthropometry``). Soft tissue gives way: trunk and hips are no
broader than leaves room for arms that hang straight down from the shoulder joints.
"""

from __future__ import annotations

import numpy as np

from liftopt.multibody.person.anthropometry import (
    HEEL_BEHIND_ANKLE,
    HIP_JOINT_SPREAD,
    dimension,
    girth_radius,
    landmarks,
    link_lengths,
)
from liftopt.multibody.person.bodies import LEFT, RIGHT
from liftopt.multibody.person.segments import SEGMENTS
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.shapes import Box, Capsule, Colour, Shape, box_at
from liftopt.types import Array

SKIN = Colour("skin", (0.87, 0.68, 0.55, 1.0))
SHIRT = Colour("shirt", (0.20, 0.42, 0.66, 1.0))
TROUSERS = Colour("trousers", (0.25, 0.27, 0.32, 1.0))
SHOES = Colour("shoes", (0.12, 0.12, 0.13, 1.0))
SIDES, ENDS = ((LEFT, "left"), (RIGHT, "right")), ((1.0, "front"), (-1.0, "back"))
HAND_THICKNESS = 0.03  # of a flat hand [m]; chosen for this model
# Girths are maxima; a segment of one radius is a little thinner. Shares of the radius, chosen for this model.
UPPER_ARM, FOREARM, THIGH, SHANK = 0.85, 0.75, 0.9, 0.95
FACE_AHEAD = 0.012  # middle of the head before the neck [m]; chosen for this model
BESIDE_ARM = 0.004  # between the trunk and a hanging arm [m]; chosen for this model


def human_shapes(subject: Subject) -> dict[str, tuple[Shape, ...]]:
    """Return the shapes of the subject by the DH row that moves them; frame: the upright zero pose, world axes.

    The right palm faces ahead, as where its joints are zero; the left arm rests, its palm to the thigh.
    """
    upper_arm, forearm, hand = _arm(subject, RIGHT, "right")
    left, right = _leg(subject, LEFT, "left"), _leg(subject, RIGHT, "right")
    return {
        "GT3": (*_pelvis(subject), *left, *right),
        "Q3": _trunk(subject) + _arm(subject, LEFT, "left", palm_ahead=False),
        "Q6": (upper_arm,),
        "Q8": (forearm,),
        "Q10": (hand,),
    }


def whole_shapes(subject: Subject) -> dict[str, tuple[Shape, ...]]:
    """Return the shapes of the subject whose legs and arms move, by joint; the feet rest and are ``"feet"``."""
    (left_thigh, left_shank, left_foot), (right_thigh, right_shank, right_foot) = (
        _leg(subject, side, name) for side, name in SIDES
    )
    shapes: dict[str, tuple[Shape, ...]] = {
        "feet": (left_foot, right_foot),
        "ankle": (left_shank, right_shank),
        "knee": (left_thigh, right_thigh),
        "hip": _pelvis(subject),
        "Q3": _trunk(subject),
    }
    for side, name in ((RIGHT, "right"), (LEFT, "left")):
        upper_arm, forearm, hand = _arm(subject, side, name)
        shapes |= {f"{name}_Q6": (upper_arm,), f"{name}_Q8": (forearm,), f"{name}_Q10": (hand,)}
    return shapes


def _pelvis(subject: Subject) -> tuple[Shape, ...]:
    at, breadth = landmarks(subject), dimension(subject, "hipbreadth")
    depth = 0.85 * dimension(subject, "buttockdepth")
    # It ends at the base of the spine, above which the trunk moves.
    return tuple(_rounded("hip", TROUSERS, 0.95 * breadth, depth, at.hip, at.omphalion, _room(subject)))


def _leg(subject: Subject, side: float, name: str) -> tuple[Capsule, Capsule, Box]:
    """Return thigh, shank and foot."""
    at, breadth = landmarks(subject), dimension(subject, "hipbreadth")
    foot = np.array([dimension(subject, "footlength"), dimension(subject, "footbreadthhorizontal"), at.ankle])
    thigh = min(THIGH * girth_radius(subject, "thighcircumference"), _room(subject))
    inside = min(HIP_JOINT_SPREAD * breadth, _room(subject) - thigh)
    y = side * HIP_JOINT_SPREAD * breadth
    knee, ankle = (np.array([0.0, y, z]) for z in (at.knee, at.ankle))
    top, bottom = (np.array([0.0, side * inside, z]) for z in (at.hip, at.knee))
    return (
        Capsule(f"{name}_thigh", TROUSERS, top, bottom, thigh),
        Capsule(f"{name}_shank", TROUSERS, knee, ankle, SHANK * girth_radius(subject, "calfcircumference")),
        box_at(
            f"{name}_foot",
            SHOES,
            np.array([(0.5 - HEEL_BEHIND_ANKLE) * foot[0], y, at.ankle / 2.0]),
            (float(foot[0]), float(foot[1]), float(foot[2])),
        ),
    )


def _trunk(subject: Subject) -> tuple[Shape, ...]:
    at, lengths, room = landmarks(subject), link_lengths(subject), _room(subject)
    shoulder = lengths.l1 + lengths.l2
    girdle = girth_radius(subject, "bicepscircumferenceflexed")
    waist, chest = (
        (dimension(subject, f"{part}breadth"), dimension(subject, f"{part}depth")) for part in ("waist", "chest")
    )
    across = np.array([0.0, room - girdle, 0.0])
    neck = girth_radius(subject, "neckcircumference")
    head, face = dimension(subject, "headlength") / 2.0, np.array([FACE_AHEAD, 0.0, 0.0])
    head_length = SEGMENTS[subject.sex]["head"].length * subject.stature
    brow, chin = at.vertex - head, at.vertex - max(head_length, 2.05 * head) + 0.8 * head
    return (
        *_rounded("abdomen", SHIRT, *waist, at.omphalion, at.xiphion + waist[1] / 2.0, room),
        *_rounded("chest", SHIRT, *chest, at.xiphion, shoulder + girdle, room),
        Capsule("shoulders", SHIRT, _axis(shoulder) - across, _axis(shoulder) + across, girdle),
        Capsule("neck", SKIN, _axis(shoulder), _axis(chin), 0.95 * neck),
        Capsule("head", SKIN, _axis(chin) + face, _axis(brow) + face, head),
    )


def _rounded(
    name: str, colour: Colour, breadth: float, depth: float, low: float, high: float, room: float
) -> list[Shape]:
    """Return a part of the trunk as two upright capsules: side by side, or one behind the other where it is deeper.

    Args:
        name: of the part.
        colour: its material.
        breadth: of the part [m].
        depth: likewise.
        low: height of the lower ends of the axes [m].
        high: height of the top [m].
        room: half of what it is broad at most [m].
    """
    half = np.array([depth / 2.0, min(breadth / 2.0, room)])
    radius = float(half.min())
    sides = SIDES if half[0] < half[1] else ENDS
    return [
        Capsule(f"{word}_{name}", colour, np.array([*aside, low]), np.array([*aside, high - radius]), radius)
        for sign, word in sides
        for aside in [sign * (half - radius)]
    ]


def _room(subject: Subject) -> float:
    """Return how far to the side [m] there is room beside an arm that hangs from the shoulder joint."""
    arm = max(UPPER_ARM * girth_radius(subject, "bicepscircumferenceflexed"), dimension(subject, "handbreadth") / 2.0)
    return link_lengths(subject).l3 - arm - BESIDE_ARM


def _arm(subject: Subject, side: float, name: str, *, palm_ahead: bool = True) -> tuple[Capsule, Capsule, Box]:
    lengths = link_lengths(subject)
    shoulder = np.array([0.0, side * lengths.l3, lengths.l1 + lengths.l2])
    elbow = shoulder - _axis(lengths.l4)
    wrist = elbow - _axis(lengths.l5)
    upper, lower = (girth_radius(subject, f"{part}circumferenceflexed") for part in ("biceps", "forearm"))
    middle = wrist - _axis(lengths.l6)  # third metacarpale: about the middle of the hand
    breadth = dimension(subject, "handbreadth")
    across = (HAND_THICKNESS, breadth) if palm_ahead else (breadth, HAND_THICKNESS)
    size = (*across, 2.0 * lengths.l6)
    return (
        Capsule(f"{name}_upper_arm", SHIRT, shoulder, elbow, UPPER_ARM * upper),
        Capsule(f"{name}_forearm", SKIN, elbow, wrist, FOREARM * lower),
        box_at(f"{name}_hand", SKIN, middle, size),
    )


def _axis(height: float) -> Array:
    return np.array([0.0, 0.0, height])
