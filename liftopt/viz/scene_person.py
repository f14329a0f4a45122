"""The person as a figure: smooth limbs, trunk and head through the subject's own breadths, depths and girths.

Lengths, breadths and girths are the subject's; the fractions of them that shape a limb in between are drawn by eye.
"""

from __future__ import annotations

import numpy as np

from liftopt.multibody.dh import rotation_x
from liftopt.multibody.person.anthropometry import dimension, girth_radius, landmarks, link_lengths
from liftopt.multibody.person.subject import Subject
from liftopt.viz.person_bodies import PersonBodies
from liftopt.viz.scene_hand import T_person_palm, bone_meshes, hand_digits, palm_mesh, resting_hand
from liftopt.viz.scene_head import head_parts
from liftopt.viz.scene_legs import leg_parts
from liftopt.viz.scene_mesh import Mesh, Ring, tube
from liftopt.viz.scene_part import Colour, Part

SKIN: Colour = (0.86, 0.66, 0.53)
SHIRT: Colour = (0.16, 0.40, 0.66)
TO_SIDE = (0.0, 1.0, 0.0)
MIDDLE, SEAM = 0.98, 0.0004  # of the waist: share of its section in what is half way, and half its straight part [m]


def person_parts(bodies: PersonBodies, subject: Subject, shirt: Colour = SHIRT) -> list[Part]:
    """Return the subject upright at the zero pose: feet at the origin, facing +X, arms hanging, palms forward.

    Hands that hold are not in it.
    """
    hem, waist, trunk = _trunk(subject)
    parts = [
        *leg_parts(bodies, subject),
        Part(bodies.pelvis, "hem", shirt, hem),
        Part(bodies.waist, "waist", shirt, waist),
        Part(bodies.trunk, "trunk", shirt, trunk),
        *head_parts(subject, bodies.trunk, SKIN),
    ]
    for arm in bodies.arms:
        sleeve, upper, forearm = _arm(subject, arm.side)
        parts += [
            Part(arm.upper, f"{arm.word}_sleeve", shirt, sleeve),
            Part(arm.upper, f"{arm.word}_upper_arm", SKIN, upper),
            Part(arm.forearm, f"{arm.word}_forearm", SKIN, forearm),
        ]
        if not arm.hand:
            # The palm of an arm without joints faces the thigh.
            turn = np.eye(4) if arm.moves else rotation_x(arm.side * -np.pi / 2)
            hand = resting_hand(subject, arm.side).seen_from(T_person_palm(subject, arm.side) @ turn)
            parts.append(Part(arm.wrist, f"{arm.word}_hand", SKIN, hand))
    return parts


def hand_parts(hand: str, subject: Subject, side: float) -> list[Part]:
    """Return palm and bones of a hand that holds, each in its own frame; bodies begin with ``hand``, "human_right"."""
    parts = [Part(f"{hand}_palm", "palm", SKIN, palm_mesh(subject, side))]
    for digit in hand_digits(subject, side):
        for j, mesh in enumerate(bone_meshes(digit), start=1):
            parts.append(Part(f"{hand}_{digit.name}_{j}", "bone", SKIN, mesh))
    return parts


def _trunk(subject: Subject) -> tuple[Mesh, Mesh, Mesh]:
    """Return what of the shirt moves with the pelvis, half way, and with the trunk."""
    at, lengths = landmarks(subject), link_lengths(subject)
    shoulder = lengths.l1 + lengths.l2
    waist = dimension(subject, "waistbreadth") / 2.0, dimension(subject, "waistdepth") / 2.0
    chest = dimension(subject, "chestbreadth") / 2.0, dimension(subject, "chestdepth") / 2.0
    neck = girth_radius(subject, "neckcircumference")
    hips = 0.525 * dimension(subject, "hipbreadth"), 0.53 * dimension(subject, "buttockdepth")
    rise = at.suprasternale - shoulder + 0.055
    slim = 1.02 * waist[0], 1.04 * waist[1]
    broad, deep = (0.29 * a + 0.71 * b for a, b in zip(hips, slim, strict=True))
    hem = Ring((0.0, 0.0, at.omphalion - 0.05), *hips, 2.4)
    joint = Ring((0.0, 0.0, at.omphalion), broad, deep, 2.4)
    # Both end flat at the joint, one on the other while upright; where it bends, what is half way shows between them.
    middle = [Ring((0.0, 0.0, at.omphalion + z), MIDDLE * broad, MIDDLE * deep, 2.4) for z in (-SEAM, SEAM)]
    rings = [
        joint,
        Ring((0.0, 0.0, at.omphalion + 0.02), *slim, 2.4),
        Ring((0.0, 0.0, 0.5 * (at.omphalion + at.xiphion)), 1.01 * waist[0], waist[1], 2.4),
        Ring((0.0, 0.0, at.xiphion), 1.02 * chest[0], 0.97 * chest[1], 2.5),
        Ring((-0.005, 0.0, 0.45 * at.xiphion + 0.55 * shoulder), 1.12 * chest[0], chest[1], 2.5),
        Ring((-0.015, 0.0, shoulder - 0.01), lengths.l3, 0.72 * chest[1], 2.6),
        Ring((-0.02, 0.0, shoulder + 0.4 * rise), 0.84 * lengths.l3, 0.55 * chest[1], 2.4),
        Ring((-0.02, 0.0, shoulder + 0.8 * rise), 0.50 * lengths.l3, max(0.42 * chest[1], 1.12 * neck), 2.2),
        Ring((-0.015, 0.0, shoulder + 1.15 * rise), 1.16 * neck, 1.2 * neck, 2.0),
    ]
    return (
        tube([hem, joint], TO_SIDE, round_start=0.015),
        tube(middle, TO_SIDE, round_start=middle[0].along, round_end=middle[0].along),
        tube(rings, TO_SIDE),
    )


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
