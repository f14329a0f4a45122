"""The person's neck and head: a face that shows where the person looks, and hair."""

from __future__ import annotations

from liftopt.multibody.person.anthropometry import dimension, girth_radius, landmarks, link_lengths
from liftopt.multibody.person.segments import SEGMENTS
from liftopt.multibody.person.subject import Subject
from liftopt.viz.scene_mesh import Ring, ball, capsule, merged, tube
from liftopt.viz.scene_part import Colour, Part

HAIR: Colour = (0.22, 0.14, 0.09)
DARK: Colour = (0.08, 0.07, 0.07)
TO_SIDE = (0.0, 1.0, 0.0)


def head_parts(subject: Subject, body: str, skin: Colour) -> list[Part]:
    """Return neck, head, hair, eyes and brows in the world at the upright zero pose, all on ``body``."""
    at, lengths = landmarks(subject), link_lengths(subject)
    simd, deep = dimension(subject, "headbreadth") / 2.0, dimension(subject, "headlength") / 2.0
    height = SEGMENTS[subject.sex]["head"].length * subject.stature
    chin, neck = at.vertex - 1.05 * height, girth_radius(subject, "neckcircumference")
    ahead = 0.012

    def ring(share: float, across: float, along: float, forward: float) -> Ring:
        """Return a section at ``share`` of the way from chin to vertex."""
        return Ring((ahead + forward, 0.0, chin + share * (at.vertex - chin)), across * simd, along * deep, 2.2)

    skull = [
        ring(0.00, 0.34, 0.26, 0.052),
        ring(0.08, 0.56, 0.50, 0.040),
        ring(0.20, 0.78, 0.78, 0.014),
        ring(0.36, 0.92, 0.92, 0.003),
        ring(0.52, 0.99, 0.98, 0.0),
        ring(0.68, 1.00, 1.00, -0.002),
        ring(0.82, 0.90, 0.91, -0.004),
        ring(0.93, 0.62, 0.64, -0.006),
    ]
    throat = [
        Ring((-0.025, 0.0, lengths.l1 + lengths.l2 + 0.03), 0.95 * neck, 0.75 * neck),
        Ring((-0.006, 0.0, chin + 0.01), 0.94 * neck, 0.96 * neck),
        Ring((0.0, 0.0, chin + 0.25 * height), 0.9 * neck, 0.95 * neck),
    ]

    def face(share: float, forward: float, side: float = 0.0) -> tuple[float, float, float]:
        return (ahead + forward * deep, side * simd, chin + share * (at.vertex - chin))

    nose = capsule(face(0.47, 0.97), face(0.33, 1.10), 0.007, 0.012)
    ears = [ball(face(0.44, -0.02, side * 0.99), (0.017, 0.008, 0.031)) for side in (-1.0, 1.0)]
    eyes = [ball(face(0.50, 0.86, side * 0.40), (0.009, 0.013, 0.007)) for side in (-1.0, 1.0)]
    brows = [capsule(face(0.57, 0.93, s * 0.22), face(0.575, 0.84, s * 0.60), 0.0040, 0.0030) for s in (-1.0, 1.0)]
    mouth = capsule(face(0.20, 0.80, -0.20), face(0.20, 0.80, 0.20), 0.005)
    longer = 0.10 if subject.sex == "female" else 0.34
    # A cap that leans back: its front edge is the hair line, everywhere else it lies outside the skull.
    hair = [
        ring(longer, 0.94, 0.62, -0.040),
        ring(0.50, 1.06, 0.80, -0.026),
        ring(0.66, 1.09, 0.90, -0.018),
        ring(0.76, 1.07, 0.99, -0.014),
        ring(0.84, 1.00, 1.04, -0.010),
        ring(0.91, 0.88, 0.94, -0.008),
        ring(0.97, 0.62, 0.70, -0.007),
    ]
    return [
        Part(body, "neck", skin, tube(throat, TO_SIDE)),
        Part(body, "head", skin, merged([tube(skull, TO_SIDE, round_start=0.008, round_end=0.016), nose, *ears])),
        Part(body, "hair", HAIR, tube(hair, TO_SIDE, round_start=0.02, round_end=0.02)),
        Part(body, "eyes", DARK, merged(eyes)),
        Part(body, "brows", HAIR, merged(brows)),
        Part(body, "mouth", (0.62, 0.33, 0.30), mouth),
    ]
