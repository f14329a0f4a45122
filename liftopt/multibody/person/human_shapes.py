"""What the subject looks like: primitive shapes sized from the body dimensions."""

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
HAND_THICKNESS = 0.03  # of a flat hand [m]; drawn only


def human_shapes(subject: Subject) -> dict[str, tuple[Shape, ...]]:
    """Return the shapes of the subject by the DH row that moves them; frame: the upright zero pose, world axes."""
    upper_arm, forearm, hand = _arm(subject, RIGHT, "right")
    return {
        "GT3": _lower_body(subject),
        "Q3": _trunk(subject) + _arm(subject, LEFT, "left"),
        "Q6": (upper_arm,),
        "Q8": (forearm,),
        "Q10": (hand,),
    }


def _lower_body(subject: Subject) -> tuple[Shape, ...]:
    at = landmarks(subject)
    breadth = dimension(subject, "hipbreadth")
    foot = np.array([dimension(subject, "footlength"), dimension(subject, "footbreadthhorizontal"), at.ankle])
    pelvis_size = (dimension(subject, "buttockdepth") * 0.85, breadth * 0.95, at.omphalion - at.hip)
    shapes: list[Shape] = [box_at("pelvis", TROUSERS, np.array([0.0, 0.0, (at.omphalion + at.hip) / 2.0]), pelvis_size)]
    for side, name in ((LEFT, "left"), (RIGHT, "right")):
        y = side * HIP_JOINT_SPREAD * breadth
        hip, knee, ankle = (np.array([0.0, y, z]) for z in (at.hip, at.knee, at.ankle))
        # The girths are maxima; a segment of one radius looks right a little below them.
        shapes += [
            Capsule(f"{name}_thigh", TROUSERS, hip, knee, 0.8 * girth_radius(subject, "thighcircumference")),
            Capsule(f"{name}_shank", TROUSERS, knee, ankle, 0.85 * girth_radius(subject, "calfcircumference")),
            box_at(
                f"{name}_foot",
                SHOES,
                np.array([(0.5 - HEEL_BEHIND_ANKLE) * foot[0], y, at.ankle / 2.0]),
                (float(foot[0]), float(foot[1]), float(foot[2])),
            ),
        ]
    return tuple(shapes)


def _trunk(subject: Subject) -> tuple[Shape, ...]:
    at, lengths = landmarks(subject), link_lengths(subject)
    shoulder = lengths.l1 + lengths.l2
    upper_arm = girth_radius(subject, "bicepscircumferenceflexed")
    waist = (dimension(subject, "waistdepth"), dimension(subject, "waistbreadth"), at.xiphion - at.omphalion)
    chest = (dimension(subject, "chestdepth"), dimension(subject, "chestbreadth"), shoulder - at.xiphion)
    across = np.array([0.0, lengths.l3 - 0.5 * upper_arm, 0.0])
    neck = girth_radius(subject, "neckcircumference")
    head = dimension(subject, "headlength") / 2.0
    head_length = SEGMENTS[subject.sex]["head"].length * subject.stature
    brow, chin = at.vertex - head, at.vertex - max(head_length, 2.05 * head) + 0.8 * head
    return (
        box_at("abdomen", SHIRT, np.array([0.0, 0.0, (at.omphalion + at.xiphion) / 2.0]), waist),
        box_at("chest", SHIRT, np.array([0.0, 0.0, (at.xiphion + shoulder) / 2.0]), chest),
        Capsule("shoulders", SHIRT, _axis(shoulder) - across, _axis(shoulder) + across, upper_arm),
        Capsule("neck", SKIN, _axis(shoulder), _axis(chin), 0.95 * neck),
        Capsule("head", SKIN, _axis(chin), _axis(brow), 0.9 * head),
    )


def _arm(subject: Subject, side: float, name: str) -> tuple[Capsule, Capsule, Box]:
    lengths = link_lengths(subject)
    shoulder = np.array([0.0, side * lengths.l3, lengths.l1 + lengths.l2])
    elbow = shoulder - _axis(lengths.l4)
    wrist = elbow - _axis(lengths.l5)
    upper, lower = (girth_radius(subject, f"{part}circumferenceflexed") for part in ("biceps", "forearm"))
    middle = wrist - _axis(lengths.l6)  # third metacarpale: about the middle of the hand
    size = (HAND_THICKNESS, dimension(subject, "handbreadth"), 2.0 * lengths.l6)
    return (
        Capsule(f"{name}_upper_arm", SHIRT, shoulder, elbow, 0.85 * upper),
        Capsule(f"{name}_forearm", SKIN, elbow, wrist, 0.75 * lower),
        box_at(f"{name}_hand", SKIN, middle, size),
    )


def _axis(height: float) -> Array:
    return np.array([0.0, 0.0, height])
