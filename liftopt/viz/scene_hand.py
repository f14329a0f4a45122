"""A person's hand: a palm with four fingers and a thumb that close on what they hold.

Length to the knuckles, breadth and wrist are the subject's; the bones' shares of it and their flesh are drawn by eye.
The palm's frame P has its origin at the wrist's joint, x towards the knuckles, z out of the palm, and y to the thumb of
a left hand.
"""

from __future__ import annotations

from math import asin, radians

import numpy as np

from liftopt.multibody.person.anthropometry import dimension, girth_radius, link_lengths
from liftopt.multibody.person.subject import Subject
from liftopt.types import Array
from liftopt.viz.digits import Digit
from liftopt.viz.scene_mesh import Mesh, Ring, ball, capsule, merged, tube

LEFT, RIGHT = 1.0, -1.0
PALM = 0.013  # half thickness of the palm at the knuckles [m]
FINGERS = ("index", "middle", "ring", "little")
REACH = (0.93, 1.0, 0.95, 0.78)  # of a finger over the middle one
AHEAD = (-0.003, 0.0, -0.004, -0.011)  # of a knuckle before the middle one [m]
BONES = (0.50, 0.30, 0.24)  # of the middle finger, over the way from wrist to knuckles
FLESH = (0.0098, 0.0090, 0.0082, 0.0070)
THUMB_BONES = (0.48, 0.38, 0.30)
THUMB_FLESH = (0.0150, 0.0118, 0.0102, 0.0082)
OUT, FLAT_THUMB = np.array([0.0, 0.0, 1.0]), (radians(10.0), radians(10.0))  # of the palm; how far a flat thumb bends
# Of a hand that holds nothing.
RELAXED, RELAXED_THUMB = np.radians([22.0, 28.0, 18.0]), np.radians([52.0, 28.0, 18.0])


def palm_tilt(subject: Subject) -> float:
    """Return the turn about the palm's y that brings its surface to where the bone between wrist and grasp is [rad]."""
    return asin(PALM / link_lengths(subject).l6)


def hand_digits(subject: Subject, side: float, *, flat: bool = False) -> tuple[Digit, ...]:
    """Return fingers and thumb in the palm's frame; ``side`` is ``LEFT`` or ``RIGHT``.

    The thumb of a ``flat`` hand lies beside the palm, that of another one is opposite the fingers.
    """
    knuckles, half = link_lengths(subject).l6, dimension(subject, "handbreadth") / 2.0
    across, ahead = np.array([0.0, -1.0, 0.0]), np.array([1.0, 0.0, 0.0])
    opened, closed = (radians(-30.0), 0.0, 0.0), (radians(62.0), radians(70.0), radians(40.0))
    digits = []
    for i, (name, reach, before) in enumerate(zip(FINGERS, REACH, AHEAD, strict=True)):
        root = np.array([knuckles + before, side * (0.75 - 0.5 * i) * half, 0.0])
        bones = tuple(knuckles * reach * bone for bone in BONES)
        digits.append(Digit(name, root, ahead, across, bones, FLESH, opened, closed))
    root = np.array([0.22 * knuckles, side * 0.66 * half, 0.004])
    bones = tuple(knuckles * bone for bone in THUMB_BONES)
    if flat:
        beside = _unit(0.66, 0.75 * side, 0.0)
        hinge, opened, closed = np.cross(beside, OUT), (radians(-15.0), 0.0, 0.0), (radians(20.0), *FLAT_THUMB)
        return (*digits, Digit("thumb", root, beside, hinge, bones, THUMB_FLESH, opened, closed))
    up, forward = _unit(0.25, 0.34 * side, 0.90), np.array([1.0, -0.10 * side, -0.35])
    hinge = _unit(*np.cross(up, forward))
    opened, closed = (radians(-40.0), 0.0, 0.0), (radians(72.0), radians(45.0), radians(55.0))
    digits.append(Digit("thumb", root, up, hinge, bones, THUMB_FLESH, opened, closed))
    return tuple(digits)


def palm_mesh(subject: Subject, side: float) -> Mesh:
    """Return the palm in its own frame, wrist and ball of the thumb with it."""
    knuckles, half = link_lengths(subject).l6, dimension(subject, "handbreadth") / 2.0
    thin = girth_radius(subject, "wristcircumference")
    rings = [
        Ring((-0.010, 0.0, 0.0), 0.98 * thin, 0.80 * thin),
        Ring((0.12 * knuckles, 0.0, 0.0), 0.96 * thin, 0.72 * thin, 2.2),
        Ring((0.40 * knuckles, 0.0, 0.0), 0.92 * half, 0.0165, 2.5),
        Ring((0.80 * knuckles, 0.0, 0.0), 1.02 * half, 0.0145, 2.8),
        Ring((knuckles, 0.0, 0.0), 0.98 * half, PALM, 2.8),
    ]
    thumb = ball((0.30 * knuckles, side * 0.55 * half, 0.006), (0.026, 0.015, 0.012))
    return merged([tube(rings, (0.0, 1.0, 0.0), round_start=0.01, round_end=0.009), thumb])


def bone_meshes(digit: Digit) -> list[Mesh]:
    """Return a mesh for each bone, along x from its hinge."""
    ends = zip(digit.bones, digit.radii[:-1], digit.radii[1:], strict=True)
    return [capsule((0.0, 0.0, 0.0), (bone, 0.0, 0.0), near, far) for bone, near, far in ends]


def resting_hand(subject: Subject, side: float) -> Mesh:
    """Return a whole hand that holds nothing, in the palm's frame."""
    meshes = [palm_mesh(subject, side)]
    for digit in hand_digits(subject, side):
        frames = digit.frames((RELAXED_THUMB if digit.name == "thumb" else RELAXED)[None])[0]
        meshes += [mesh.seen_from(frame) for mesh, frame in zip(bone_meshes(digit), frames, strict=True)]
    return merged(meshes)


def T_person_palm(subject: Subject, side: float) -> Array:
    """Return the palm's frame (4, 4) in the axes of a person who stands upright at zero: the arm hangs, palm ahead."""
    lengths, placement = link_lengths(subject), np.eye(4)
    placement[:3, :3] = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    placement[:3, 3] = 0.0, side * lengths.l3, lengths.l1 + lengths.l2 - lengths.l4 - lengths.l5
    return placement


def _unit(x: float, y: float, z: float) -> Array:
    vector = np.array([x, y, z])
    return np.asarray(vector / np.linalg.norm(vector))
