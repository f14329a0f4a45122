"""A person's legs and pelvis: thighs, knees and shanks that bend without a gap, and shoes."""

from __future__ import annotations

from liftopt.multibody.person.anthropometry import (
    HEEL_BEHIND_ANKLE,
    HIP_JOINT_SPREAD,
    dimension,
    girth_radius,
    landmarks,
)
from liftopt.multibody.person.subject import Subject
from liftopt.viz.person_bodies import PersonBodies
from liftopt.viz.scene_hand import LEFT, RIGHT
from liftopt.viz.scene_mesh import Mesh, Ring, ball, tube
from liftopt.viz.scene_part import Colour, Part

TROUSERS: Colour = (0.22, 0.25, 0.32)
SHOES: Colour = (0.10, 0.10, 0.12)
SOLES: Colour = (0.80, 0.80, 0.80)
TO_SIDE = (0.0, 1.0, 0.0)
# Stands in for the clothes, and for girths that ANSUR II measures at their largest [fractions of a radius].
SLACK = 1.06


def leg_parts(bodies: PersonBodies, subject: Subject) -> list[Part]:
    """Return pelvis, legs and shoes of the subject upright: feet at the origin, facing +X."""
    breadth, bends = dimension(subject, "hipbreadth"), bodies.pelvis != bodies.thigh
    rings, half = _hips(subject), 0.5 * dimension(subject, "buttockdepth")
    if bends:
        top = tube(rings[1:], TO_SIDE, round_start=half, round_end=0.02)
        seat = ball(rings[1].centre, (half, 0.5 * breadth, half))
        parts = [Part(bodies.pelvis, "pelvis", TROUSERS, top), Part(bodies.groin, "seat", TROUSERS, seat)]
    else:
        parts = [Part(bodies.pelvis, "pelvis", TROUSERS, tube(rings, TO_SIDE, round_start=0.03, round_end=0.02))]
    for side, name in ((LEFT, "left"), (RIGHT, "right")):
        y = side * HIP_JOINT_SPREAD * breadth
        thigh, shank = _leg(subject, y, bends=bends)
        upper, sole = _shoe(subject, y)
        parts += [
            Part(bodies.thigh, f"{name}_thigh", TROUSERS, thigh),
            Part(bodies.shank, f"{name}_shank", TROUSERS, shank),
            Part(bodies.feet, f"{name}_shoe", SHOES, upper),
            Part(bodies.feet, f"{name}_sole", SOLES, sole),
        ]
        if bends:
            parts += [Part(bodies.knee, f"{name}_knee", TROUSERS, _knee(subject, y))]
    return parts


def _hips(subject: Subject) -> list[Ring]:
    """Return sections from the crotch over the hip joints to the waist."""
    at = landmarks(subject)
    breadth, depth = dimension(subject, "hipbreadth"), dimension(subject, "buttockdepth")
    return [
        Ring((0.0, 0.0, at.hip - 0.05 * subject.stature), 0.36 * breadth, 0.30 * depth, 2.4),
        Ring((-0.01, 0.0, at.hip), 0.50 * breadth, 0.50 * depth, 2.4),
        Ring((-0.005, 0.0, 0.45 * at.hip + 0.55 * at.omphalion), 0.46 * breadth, 0.45 * depth, 2.4),
        Ring((0.0, 0.0, at.omphalion - 0.01), 0.42 * breadth, 0.40 * depth, 2.4),
    ]


def _leg(subject: Subject, y: float, *, bends: bool) -> tuple[Mesh, Mesh]:
    """Return thigh and shank; both end in a ball at the knee, the thigh in one in the hip if that ``bends``."""
    at, knee = landmarks(subject), _knee_radius(subject)
    thigh, calf, ankle = (girth_radius(subject, f"{name}circumference") for name in ("thigh", "calf", "ankle"))
    joint = Ring((0.005, y, at.knee), 1.1 * knee, 1.12 * knee)
    top = (0.82 * thigh, 0.90 * thigh, 0.82 * thigh) if bends else (0.90 * thigh, 0.98 * thigh, 0.05)
    upper = [
        Ring((0.0, y, at.hip), *top[:2]),
        Ring((0.01, y, 0.75 * at.hip + 0.25 * at.knee), 0.92 * thigh, thigh),
        Ring((0.01, y, 0.3 * at.hip + 0.7 * at.knee), 0.74 * thigh, 0.8 * thigh),
        joint,
    ]
    lower = [
        joint,
        Ring((-0.012, y, 0.72 * at.knee + 0.28 * at.ankle), SLACK * calf, 1.1 * calf),
        Ring((-0.008, y, 0.4 * at.knee + 0.6 * at.ankle), 0.92 * calf, calf),
        Ring((0.0, y, at.ankle + 0.03), 1.5 * ankle, 1.7 * ankle),
        Ring((0.0, y, at.ankle - 0.01), 1.5 * ankle, 1.75 * ankle),
    ]
    return (
        tube(upper, TO_SIDE, round_start=top[2], round_end=1.1 * knee),
        tube(lower, TO_SIDE, round_start=1.1 * knee),
    )


def _knee_radius(subject: Subject) -> float:
    thigh, calf = (girth_radius(subject, f"{name}circumference") for name in ("thigh", "calf"))
    return 0.5 * (0.62 * thigh + calf)


def _knee(subject: Subject, y: float) -> Mesh:
    """Return the kneecap, which lies inside a straight leg."""
    at, knee = landmarks(subject), _knee_radius(subject)
    return ball((0.28 * knee, y, at.knee), (0.86 * knee, 0.98 * knee, 0.95 * knee))


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
