"""Lengths of a subject: the links of Table 2, and what else it takes to place and draw the segments."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

from liftopt.multibody.person.segments import SEGMENTS
from liftopt.multibody.person.subject import Sex, Subject
from liftopt.multibody.sources import ANSUR_II, DE_LEVA_1996, DE_LEVA_AND_ANSUR, DE_LEVA_BELOW_OMPHALION, Source


@dataclass(frozen=True)
class Regression:
    """One body dimension: ``constant + per_stature * stature + per_mass * mass`` [m], stature in m and mass in kg."""

    constant: float
    per_stature: float
    per_mass: float

    def __call__(self, subject: Subject) -> float:
        """Return the dimension of ``subject`` [m]."""
        return self.constant + self.per_stature * subject.stature + self.per_mass * subject.mass


# Ordinary least squares on every row of ANSUR_II (``sources``); its column names.
DIMENSIONS: dict[Sex, dict[str, Regression]] = {
    "male": {
        "waistheightomphalion": Regression(-0.20437, 0.74477, -0.000551),
        "suprasternaleheight": Regression(-0.07078, 0.84194, 0.0003595),
        "biacromialbreadth": Regression(0.20459, 0.09168, 0.0005855),
        "lateralmalleolusheight": Regression(0.01173, 0.03098, 7.91e-05),
        "footlength": Regression(0.04493, 0.12038, 0.0001735),
        "balloffootlength": Regression(0.03428, 0.08808, 0.00014),
        "footbreadthhorizontal": Regression(0.05585, 0.01802, 0.000168),
        "headbreadth": Regression(0.15656, -0.00861, 0.0001508),
        "headlength": Regression(0.14473, 0.02454, 0.0001366),
        "neckcircumference": Regression(0.40776, -0.08508, 0.001629),
        "chestbreadth": Regression(0.2062, 0.00356, 0.0009002),
        "chestdepth": Regression(0.25813, -0.08938, 0.0017853),
        "waistbreadth": Regression(0.30601, -0.10326, 0.0023593),
        "waistdepth": Regression(0.3024, -0.15329, 0.0023921),
        "hipbreadth": Regression(0.23257, -0.00647, 0.0014562),
        "buttockdepth": Regression(0.25904, -0.09808, 0.0018598),
        "bicepscircumferenceflexed": Regression(0.3803, -0.12234, 0.0022531),
        "forearmcircumferenceflexed": Regression(0.25274, -0.0315, 0.0013172),
        "wristcircumference": Regression(0.0975, 0.02525, 0.0003984),
        "handbreadth": Regression(0.04659, 0.0176, 0.000126),
        "thighcircumference": Regression(0.59474, -0.18359, 0.0041254),
        "calfcircumference": Regression(0.35096, -0.06845, 0.0018884),
        "anklecircumference": Regression(0.15309, 0.00791, 0.0007291),
    },
    "female": {
        "waistheightomphalion": Regression(-0.2236, 0.76517, -0.0006244),
        "suprasternaleheight": Regression(-0.0662, 0.84309, 0.0003386),
        "biacromialbreadth": Regression(0.13199, 0.12829, 0.0003607),
        "lateralmalleolusheight": Regression(0.00692, 0.03381, 1.13e-05),
        "footlength": Regression(0.03785, 0.11804, 0.0002393),
        "balloffootlength": Regression(0.02964, 0.08541, 0.0001965),
        "footbreadthhorizontal": Regression(0.05769, 0.01382, 0.0001847),
        "headbreadth": Regression(0.13512, 0.00368, 9.81e-05),
        "headlength": Regression(0.1343, 0.02787, 0.0001496),
        "neckcircumference": Regression(0.30582, -0.04685, 0.0014799),
        "chestbreadth": Regression(0.20635, -0.01285, 0.0012383),
        "chestdepth": Regression(0.27781, -0.11634, 0.0023473),
        "waistbreadth": Regression(0.2959, -0.11378, 0.0027934),
        "waistdepth": Regression(0.31707, -0.18103, 0.0028154),
        "hipbreadth": Regression(0.26242, -0.03156, 0.0021078),
        "buttockdepth": Regression(0.26363, -0.11128, 0.0022215),
        "bicepscircumferenceflexed": Regression(0.34141, -0.13988, 0.0028331),
        "forearmcircumferenceflexed": Regression(0.21588, -0.03185, 0.0014768),
        "wristcircumference": Regression(0.08086, 0.02795, 0.0004194),
        "handbreadth": Regression(0.04161, 0.01755, 0.0001175),
        "thighcircumference": Regression(0.58401, -0.19423, 0.0051423),
        "calfcircumference": Regression(0.30585, -0.05141, 0.0022304),
        "anklecircumference": Regression(0.13987, 0.01407, 0.0007815),
    },
}
# Height of suprasternale above the shoulder joint centres, over stature: de Leva's 'trunk' less 'trunk3' length.
SUPRASTERNALE_ABOVE_SHOULDER: dict[Sex, float] = {"male": 0.00942, "female": 0.0181}
# Half the distance between the hip joint centres, over hip breadth, and the heel's distance behind the ankle, over foot
# length. Chosen for this model.
HIP_JOINT_SPREAD, HEEL_BEHIND_ANKLE = 0.25, 0.25

LINK_SOURCES: dict[str, Source] = {
    "L1": ANSUR_II,  # omphalion height, so that the trunk that moves is the table's upper and middle trunk
    "L2": DE_LEVA_AND_ANSUR,  # shoulder joint centre above L1
    "L3": ANSUR_II,  # half the biacromial breadth
    "L4": DE_LEVA_1996,  # shoulder to elbow joint centre
    "L5": DE_LEVA_1996,  # elbow to wrist joint centre
    "L6": DE_LEVA_1996,  # wrist joint centre to third metacarpale, where the hand grips
}
JOINT_SOURCES: dict[str, Source] = {
    "hip": DE_LEVA_BELOW_OMPHALION,
    "knee": DE_LEVA_BELOW_OMPHALION,
    "ankle": ANSUR_II,  # lateral malleolus
}


@dataclass(frozen=True)
class LinkLengths:
    """L1 to L6 of Table 2 [m]: foot to spine, spine to shoulder height, half breadth, upper arm, forearm, hand."""

    l1: float
    l2: float
    l3: float
    l4: float
    l5: float
    l6: float


def dimension(subject: Subject, name: str) -> float:
    """Return one body dimension [m] by its ANSUR II column name, such as ``"footlength"``."""
    return DIMENSIONS[subject.sex][name](subject)


def girth_radius(subject: Subject, name: str) -> float:
    """Return the radius [m] of the circle whose circumference is the named ANSUR II dimension."""
    return dimension(subject, name) / (2.0 * pi)


def link_lengths(subject: Subject) -> LinkLengths:
    """Return the subject's L1 to L6 [m]; ``LINK_SOURCES`` says where each comes from."""
    table = SEGMENTS[subject.sex]
    spine = dimension(subject, "waistheightomphalion")
    drop = SUPRASTERNALE_ABOVE_SHOULDER[subject.sex] * subject.stature
    return LinkLengths(
        l1=spine,
        l2=dimension(subject, "suprasternaleheight") - drop - spine,
        l3=dimension(subject, "biacromialbreadth") / 2.0,
        l4=table["upper_arm"].length * subject.stature,
        l5=table["forearm"].length * subject.stature,
        l6=table["hand"].length * subject.stature,
    )


def feet_apart(subject: Subject) -> float:
    """Return the distance between the middles of the subject's feet, which stand below the hip joints [m]."""
    return 2.0 * HIP_JOINT_SPREAD * dimension(subject, "hipbreadth")


@dataclass(frozen=True)
class Landmarks:
    """Heights above the ground of the upright subject [m]; omphalion is the base of the spine (L1)."""

    vertex: float
    suprasternale: float
    xiphion: float
    omphalion: float
    hip: float
    knee: float
    ankle: float


def landmarks(subject: Subject) -> Landmarks:
    """Return the subject's landmark heights [m].

    Vertex, suprasternale, omphalion and ankle are measured heights (ANSUR II); in between, the segments of de
    Leva's table divide the distance in their proportions, so that segments stack up to the stature without gaps.
    """
    table = SEGMENTS[subject.sex]
    suprasternale = dimension(subject, "suprasternaleheight")
    omphalion = dimension(subject, "waistheightomphalion")
    ankle = dimension(subject, "lateralmalleolusheight")
    upper, middle = table["upper_trunk"].length, table["middle_trunk"].length
    thigh, shank = table["thigh"].length, table["shank"].length
    hip = omphalion - table["lower_trunk"].length * subject.stature
    return Landmarks(
        vertex=subject.stature,
        suprasternale=suprasternale,
        xiphion=suprasternale - (suprasternale - omphalion) * upper / (upper + middle),
        omphalion=omphalion,
        hip=hip,
        knee=hip - (hip - ankle) * thigh / (thigh + shank),
        ankle=ankle,
    )
