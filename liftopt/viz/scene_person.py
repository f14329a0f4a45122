"""The person as a figure: smooth limbs, trunk and head through the subject's own breadths, depths and girths.

Lengths, breadths and girths are the subject's; the fractions of them that shape a limb in between are drawn by eye.
"""

from __future__ import annotations

import numpy as np

from liftopt.multibody.dh import rotation_x
from liftopt.multibody.person.anthropometry import (
    HEEL_BEHIND_ANKLE,
    HIP_JOINT_SPREAD,
    dimension,
    girth_radius,
    landmarks,
    link_lengths,
)
from liftopt.multibody.person.subject import Subject
from liftopt.viz.scene_hand import (
    LEFT,
    RIGHT,
    T_person_palm,
    bone_meshes,
    hand_digits,
    palm_mesh,
    resting_hand,
)
from liftopt.viz.scene_head import head_parts
from liftopt.viz.scene_mesh import Mesh, Ring, tube
from liftopt.viz.scene_part import Colour, Part

SKIN: Colour = (0.86, 0.66, 0.53)
SHIRT: Colour = (0.16, 0.40, 0.66)
TROUSERS: Colour = (0.22, 0.25, 0.32)
SHOES: Colour = (0.10, 0.10, 0.12)
SOLES: Colour = (0.80, 0.80, 0.80)
FREE_ARM = "free_arm"  # ends the name of its body
TO_SIDE = (0.0, 1.0, 0.0)
# Stands in for the clothes, and for girths that ANSUR II measures at their largest [fractions of a radius].
SLACK = 1.06


def person_parts(name: str, subject: Subject, shirt: Colour = SHIRT) -> list[Part]:
    """Return the subject upright at the zero pose: feet at the origin, facing +X, arms hanging, palms forward.

    Legs and pelvis are on joint GT3, the trunk with the head on Q3, the right arm on Q6 (upper arm) and Q8 (forearm),
    each called after the person: ``human_Q3``; the free left arm, hand included, is a body of its own, ``FREE_ARM``.
    The hand that holds is not in it.
    """
    trunk, free = f"{name}_Q3", f"{name}_{FREE_ARM}"
    parts = [
        *_legs(f"{name}_GT3", subject),
        Part(trunk, "trunk", shirt, _trunk(subject)),
        *head_parts(subject, trunk, SKIN),
    ]
    for side, bodies, which in ((LEFT, (free, free), "left"), (RIGHT, (f"{name}_Q6", f"{name}_Q8"), "right")):
        sleeve, upper, forearm = _arm(subject, side)
        parts += [
            Part(bodies[0], f"{which}_sleeve", shirt, sleeve),
            Part(bodies[0], f"{which}_upper_arm", SKIN, upper),
            Part(bodies[1], f"{which}_forearm", SKIN, forearm),
        ]
    # The palm of the free hand faces the thigh.
    hand = resting_hand(subject, LEFT).seen_from(T_person_palm(subject, LEFT) @ rotation_x(-np.pi / 2))
    parts.append(Part(free, "left_hand", SKIN, hand))
    return parts


def hand_parts(hand: str, subject: Subject, side: float) -> list[Part]:
    """Return palm and bones of a hand that holds, each in its own frame; bodies begin with ``hand``, "human_right"."""
    parts = [Part(f"{hand}_palm", "palm", SKIN, palm_mesh(subject, side))]
    for digit in hand_digits(subject, side):
        for j, mesh in enumerate(bone_meshes(digit), start=1):
            parts.append(Part(f"{hand}_{digit.name}_{j}", "bone", SKIN, mesh))
    return parts


def _legs(body: str, subject: Subject) -> list[Part]:
    at, parts = landmarks(subject), []
    breadth, depth = dimension(subject, "hipbreadth"), dimension(subject, "buttockdepth")
    crotch = at.hip - 0.05 * subject.stature
    hips = [
        Ring((0.0, 0.0, crotch), 0.36 * breadth, 0.30 * depth, 2.4),
        Ring((-0.01, 0.0, at.hip), 0.50 * breadth, 0.50 * depth, 2.4),
        Ring((-0.005, 0.0, 0.45 * at.hip + 0.55 * at.omphalion), 0.46 * breadth, 0.45 * depth, 2.4),
        Ring((0.0, 0.0, at.omphalion - 0.01), 0.42 * breadth, 0.40 * depth, 2.4),
    ]
    parts.append(Part(body, "pelvis", TROUSERS, tube(hips, TO_SIDE, round_start=0.03, round_end=0.02)))
    thigh, calf, ankle = (girth_radius(subject, f"{name}circumference") for name in ("thigh", "calf", "ankle"))
    knee = 0.5 * (0.62 * thigh + calf)
    for side, name in ((LEFT, "left"), (RIGHT, "right")):
        y = side * HIP_JOINT_SPREAD * breadth
        leg = [
            Ring((0.0, y, at.hip), 0.90 * thigh, 0.98 * thigh),
            Ring((0.01, y, 0.75 * at.hip + 0.25 * at.knee), 0.92 * thigh, thigh),
            Ring((0.01, y, 0.3 * at.hip + 0.7 * at.knee), 0.74 * thigh, 0.8 * thigh),
            Ring((0.005, y, at.knee), 1.1 * knee, 1.12 * knee),
            Ring((-0.012, y, 0.72 * at.knee + 0.28 * at.ankle), SLACK * calf, 1.1 * calf),
            Ring((-0.008, y, 0.4 * at.knee + 0.6 * at.ankle), 0.92 * calf, calf),
            Ring((0.0, y, at.ankle + 0.03), 1.5 * ankle, 1.7 * ankle),
            Ring((0.0, y, at.ankle - 0.01), 1.5 * ankle, 1.75 * ankle),
        ]
        parts.append(Part(body, f"{name}_leg", TROUSERS, tube(leg, TO_SIDE, round_start=0.05)))
        upper, sole = _shoe(subject, y)
        parts.append(Part(body, f"{name}_shoe", SHOES, upper))
        parts.append(Part(body, f"{name}_sole", SOLES, sole))
    return parts


def _shoe(subject: Subject, y: float) -> tuple[Mesh, Mesh]:
    length, breadth = dimension(subject, "footlength") * SLACK, dimension(subject, "footbreadthhorizontal") / 2.0
    heel, ankle, sole = -HEEL_BEHIND_ANKLE * length, landmarks(subject).ankle, 0.018

    def ring(share: float, simd: float, height: float) -> Ring:
        return Ring((heel + share * length, y, sole + height / 2.0), simd * breadth, height / 2.0, 2.6)

    upper = [ring(0.03, 0.55, 0.6 * ankle), ring(0.15, 0.72, 1.05 * ankle), ring(0.30, 0.74, 1.12 * ankle)]
    upper += [ring(0.50, 0.86, 0.85 * ankle), ring(0.72, 1.0, 0.58 * ankle), ring(0.95, 0.72, 0.42 * ankle)]
    outline = [(0.0, 0.5), (0.06, 0.72), (0.3, 0.72), (0.5, 0.84), (0.74, 1.04), (0.92, 0.84), (1.0, 0.45)]
    flat = [Ring((heel + s * length, y, sole / 2.0), w * breadth, sole / 2.0, 6.0) for s, w in outline]
    return (
        tube(upper, TO_SIDE, round_start=0.01, round_end=0.015),
        tube(flat, TO_SIDE, round_start=0.004, round_end=0.006),
    )


def _trunk(subject: Subject) -> Mesh:
    at, lengths = landmarks(subject), link_lengths(subject)
    shoulder = lengths.l1 + lengths.l2
    waist = dimension(subject, "waistbreadth") / 2.0, dimension(subject, "waistdepth") / 2.0
    chest = dimension(subject, "chestbreadth") / 2.0, dimension(subject, "chestdepth") / 2.0
    neck = girth_radius(subject, "neckcircumference")
    hips = 0.525 * dimension(subject, "hipbreadth"), 0.53 * dimension(subject, "buttockdepth")
    rise = at.suprasternale - shoulder + 0.055
    rings = [
        Ring((0.0, 0.0, at.omphalion - 0.05), hips[0], hips[1], 2.4),
        Ring((0.0, 0.0, at.omphalion + 0.02), 1.02 * waist[0], 1.04 * waist[1], 2.4),
        Ring((0.0, 0.0, 0.5 * (at.omphalion + at.xiphion)), 1.01 * waist[0], waist[1], 2.4),
        Ring((0.0, 0.0, at.xiphion), 1.02 * chest[0], 0.97 * chest[1], 2.5),
        Ring((-0.005, 0.0, 0.45 * at.xiphion + 0.55 * shoulder), 1.12 * chest[0], chest[1], 2.5),
        Ring((-0.015, 0.0, shoulder - 0.01), lengths.l3, 0.72 * chest[1], 2.6),
        Ring((-0.02, 0.0, shoulder + 0.4 * rise), 0.84 * lengths.l3, 0.55 * chest[1], 2.4),
        Ring((-0.02, 0.0, shoulder + 0.8 * rise), 0.50 * lengths.l3, max(0.42 * chest[1], 1.12 * neck), 2.2),
        Ring((-0.015, 0.0, shoulder + 1.15 * rise), 1.16 * neck, 1.2 * neck, 2.0),
    ]
    return tube(rings, TO_SIDE, round_start=0.015)


def _arm(subject: Subject, side: float) -> tuple[Mesh, Mesh, Mesh]:
    """Return sleeve, upper arm and forearm of a hanging arm."""
    lengths = link_lengths(subject)
    y, shoulder = side * lengths.l3, lengths.l1 + lengths.l2
    elbow, wrist = shoulder - lengths.l4, shoulder - lengths.l4 - lengths.l5
    biceps, forearm = (0.92 * girth_radius(subject, f"{p}circumferenceflexed") for p in ("biceps", "forearm"))
    thin = girth_radius(subject, "wristcircumference")

    def ring(height: float, radius: float, ahead: float = 0.0) -> Ring:
        return Ring((ahead, y, height), radius, radius)

    half = 0.5 * (shoulder + elbow)
    sleeve = [ring(shoulder + 0.004, 1.02 * biceps), ring(shoulder - 0.06, 1.10 * biceps)]
    sleeve += [ring(half, 1.1 * biceps), ring(half - 0.02, 1.1 * biceps)]
    upper = [ring(half + 0.03, 0.96 * biceps), ring(half - 0.03, 0.98 * biceps), ring(elbow, 0.86 * forearm)]
    lower = [ring(elbow, 0.88 * forearm), ring(elbow - 0.25 * lengths.l5, forearm)]
    lower += [ring(elbow - 0.6 * lengths.l5, 0.8 * forearm), ring(wrist + 0.02, 1.08 * thin), ring(wrist, 1.02 * thin)]
    return (
        tube(sleeve, TO_SIDE, round_start=0.92 * biceps),
        tube(upper, TO_SIDE, round_end=0.8 * forearm),
        tube(lower, TO_SIDE, round_start=0.8 * forearm, round_end=0.015),
    )
