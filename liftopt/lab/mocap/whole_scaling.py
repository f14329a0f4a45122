"""The whole person from the markers: stature for the prediction, measured lengths for the recorded motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from liftopt.lab.mocap.marker_map import Person
from liftopt.lab.mocap.rigid import were_seen
from liftopt.lab.mocap.scaling import estimated_subject, told_sex
from liftopt.lab.mocap.whole_map import SIDES
from liftopt.lab.mocap.whole_skeleton import WholeSkeleton
from liftopt.multibody.person.anthropometry import LinkLengths, landmarks, link_lengths
from liftopt.multibody.person.segments import SEGMENTS
from liftopt.multibody.person.subject import Sex, Subject
from liftopt.multibody.person.whole_body import WholeLengths
from liftopt.types import Array

BREASTBONE = "breastbone above the ankles"
# What a stature says of the lengths that markers show [m].
OF_SUBJECT: dict[str, Callable[[Subject], float]] = {
    BREASTBONE: lambda one: landmarks(one).suprasternale - landmarks(one).ankle,
    "upper arm": lambda one: link_lengths(one).l4,
    "forearm": lambda one: link_lengths(one).l5,
    "thigh": lambda one: landmarks(one).hip - landmarks(one).knee,
    "shank": lambda one: landmarks(one).knee - landmarks(one).ankle,
}
TWO_STATURES = (1.6, 1.8)  # m; between and beyond them all these lengths are linear


@dataclass(frozen=True)
class ScaledWhole:
    """A whole person as the markers show them.

    Attributes:
        subject: for a prediction.
        lengths: of the recorded motion: measured, but for the ankle's height and how far the spine's base is above the
            hips, which no marker shows and the subject's stature gives.
        stature_by: the stature that each segment by itself implies [m].
        estimated: True if the stature was estimated from these, False if it was given.
        spine_base: (3,) base of the spine in the trunk's axes [m].
    """

    subject: Subject
    lengths: WholeLengths
    stature_by: dict[str, float]
    estimated: bool
    spine_base: Array


def scale_whole(found: WholeSkeleton, person: Person) -> ScaledWhole:
    """Return the subject of a recording.

    The stature is that of the mapping, else the mean of what the height of the breastbone while standing, arms and legs
    imply, weighted by how little each varies among people. The base of the spine is on the line along the trunk
    under the shoulders, as far above the hips as the subject's lower trunk is long.

    Raises:
        InputError: sex or mass are given nowhere, or the stature is that of no adult.
    """
    sex = told_sex(person)
    measured = {} if found.breastbone is None else {BREASTBONE: found.breastbone}
    measured |= {name.replace("_", " "): found.lengths[name] for name in ("upper_arm", "forearm", "thigh", "shank")}
    implied = {name: _stature(OF_SUBJECT[name], length, person.mass, sex) for name, length in measured.items()}
    subject = estimated_subject(person, implied)

    trunk, pelvis = found.axes["trunk"], found.axes["pelvis"]
    shoulders = {side: _mean(trunk.seen(found.centres.joint[side, "shoulder"])) for side in SIDES}
    shoulder = (shoulders["right"] + shoulders["left"]) / 2.0
    above_hips = SEGMENTS[sex]["lower_trunk"].length * subject.stature
    under = pelvis.seen(trunk.place(np.array([shoulder[0], 0.0, 0.0])))
    up = np.einsum("fji,fj->fi", pelvis.rotation, trunk.rotation[:, :, 2])
    depth = float(np.nanmean(((above_hips - under[:, 2]) / up[:, 2])[found.upright]))
    spine_base = np.array([shoulder[0], 0.0, depth])
    ahead = float(np.nanmean(pelvis.seen(trunk.place(spine_base))[found.upright, 0]))

    own = link_lengths(subject)
    ankle = landmarks(subject).ankle
    knee = ankle + found.lengths["shank"]
    hip = knee + found.lengths["thigh"]

    def arm(side: str) -> LinkLengths:
        upper_arm, forearm, hand = (found.by_side[name][SIDES.index(side)] for name in ("upper_arm", "forearm", "hand"))
        return LinkLengths(
            l1=hip + above_hips,
            l2=float(shoulders[side][2] - depth),
            l3=float(abs(shoulders[side][1])),
            l4=upper_arm,
            l5=forearm,
            l6=own.l6 if np.isnan(hand) else hand,
        )

    lengths = WholeLengths(arm("right"), arm("left"), ankle, knee, hip, ahead)
    return ScaledWhole(subject, lengths, implied, not person.stature, spine_base)


def _stature(of: Callable[[Subject], float], length: float, mass: float, sex: Sex) -> float:
    low, high = (of(Subject(stature, mass, sex)) for stature in TWO_STATURES)
    first, second = TWO_STATURES
    return first + (second - first) * (length - low) / (high - low)


def _mean(points: Array) -> Array:
    return np.asarray(points[were_seen(points)].mean(axis=0))
