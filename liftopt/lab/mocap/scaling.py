"""The subject from the markers: stature for the prediction, measured lengths for the recorded motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.mocap.anatomy import Skeleton
from liftopt.lab.mocap.marker_map import MarkerMap, Person
from liftopt.lab.mocap.rigid import were_seen
from liftopt.multibody.dh import BodyInertia, DHChain, human_rows
from liftopt.multibody.person.anthropometry import DIMENSIONS, LinkLengths, link_lengths
from liftopt.multibody.person.human import NAME, human_chain
from liftopt.multibody.person.segments import SEGMENTS
from liftopt.multibody.person.subject import Sex, Subject
from liftopt.types import Array

# Hip joint centres below the front spines of the pelvis, over the distance of these: Bell, Pedersen & Brand (1990),
# J Biomech 23:617-621.
HIP_BELOW_ASIS = 0.30
# How far the stature may be off that one segment implies [m]: people of one stature differ in their proportions; our
# choice.
SPREAD: dict[str, float] = {
    "trunk": 0.10,
    "upper arm": 0.065,
    "forearm": 0.05,
    "thigh": 0.065,
    "shank": 0.05,
    "breastbone above the ankles": 0.025,
}


@dataclass(frozen=True)
class ScaledSubject:
    """A person as the markers show them.

    Attributes:
        subject: for a prediction.
        lengths: L1 to L6 of the recorded motion: measured, but for L1, which no marker shows and the subject's stature
            gives.
        stature_by: the stature that each segment by itself implies [m].
        estimated: True if the stature was estimated from these, False if it was given.
        spine_base: (3,) base of the spine in the trunk's frame [m].
    """

    subject: Subject
    lengths: LinkLengths
    stature_by: dict[str, float]
    estimated: bool
    spine_base: Array


def scale_subject(found: Skeleton, mapping: MarkerMap) -> ScaledSubject:
    """Return the subject of a recording.

    The stature is that of the mapping, else the mean of what trunk, upper arm and forearm imply, weighted by how little
    each varies among people. The base of the spine is on the line along the trunk under the shoulders, at the height
    of the omphalion while standing.

    Raises:
        InputError: sex or mass are given nowhere, or the stature is that of no adult.
    """
    person = mapping.subject
    sex = told_sex(person)
    implied = _statures(found, mapping, sex, person.mass)
    subject = estimated_subject(person, implied)

    pelvis, trunk = found.segments["pelvis"], found.segments["trunk"]
    navel = _asis(found, mapping)[:, 2] + _navel_above_asis(found, mapping, subject)
    frame, shoulder = found.frames["trunk"], found.shoulder_in_trunk
    under = frame.origin + frame.rotation @ np.array([shoulder[0], 0.0, 0.0])
    up = np.einsum("fij,j->fi", trunk.poses.rotation, frame.rotation[:, 2])
    known = found.upright & were_seen(pelvis.poses.translation) & were_seen(up)
    if not known.any():
        raise InputError("segments.pelvis", NO_VALUE, "pelvis and trunk are never seen together while standing upright")
    depth = float(np.mean(((navel - trunk.poses.to_world(under)[:, 2]) / up[:, 2])[known]))
    base = np.array([shoulder[0], 0.0, depth])
    standard = link_lengths(subject)
    lengths = LinkLengths(
        l1=standard.l1,
        l2=float(shoulder[2] - depth),
        l3=float(-shoulder[1]),
        l4=found.upper_arm,
        l5=found.forearm,
        l6=found.hand,
    )
    return ScaledSubject(subject, lengths, implied, not person.stature, base)


def told_sex(person: Person) -> Sex:
    """Return the person's sex.

    Raises:
        InputError: sex or mass are given nowhere.
    """
    if not person.sex:
        raise InputError("subject.sex", NO_VALUE, 'must be "male" or "female": in the mapping or by --sex')
    if not person.mass:
        raise InputError(
            "subject.mass", NO_VALUE, "must be given in kg, for markers do not weigh: in the mapping or by --mass"
        )
    return person.sex


def estimated_subject(person: Person, implied: Mapping[str, float]) -> Subject:
    """Return the subject with the stature given, else with the mean of what segments imply, by ``SPREAD``."""
    weight = {name: SPREAD[name] ** -2 for name in implied}
    estimate = sum(weight[name] * implied[name] for name in implied) / sum(weight.values())
    return Subject(person.stature or round(float(estimate), 3), person.mass, told_sex(person))


def measured_chain(scaled: ScaledSubject) -> DHChain:
    """Return Table 2 with the measured lengths; the bodies are the subject's.

    Bodies of the arm keep their mass and are stretched to the measured length, in which their centres of mass and
    radii of gyration keep their shares; the trunk's body stays where it is above the base of the spine.
    """
    own, standard, lengths = human_chain(scaled.subject), link_lengths(scaled.subject), scaled.lengths
    stretch = {"Q6": lengths.l4 / standard.l4, "Q8": lengths.l5 / standard.l5, "Q10": lengths.l6 / standard.l6}
    rows = human_rows(lengths.l1, lengths.l2, lengths.l3, lengths.l4, lengths.l5, lengths.l6)
    bodies = []
    for row, old, body in zip(rows, own.rows, own.inertias, strict=True):
        if row.name in stretch:
            body = _stretched(body, stretch[row.name])
        elif row.name == "Q3":
            # Its DH frame is at the shoulder: along z by L2, then along x by L3 from the base of the spine.
            body = replace(
                body, com=body.com - np.array([row.a - old.a, 0.0, 0.0]) - _along_z(row.d - old.d, row.alpha)
            )
        bodies.append(body)
    return DHChain(NAME, rows, tuple(bodies))


def _along_z(shift: float, alpha: float) -> Array:
    # The frame after the row is turned by alpha about x.
    return shift * np.array([0.0, np.sin(alpha), np.cos(alpha)])


def _stretched(body: BodyInertia, factor: float) -> BodyInertia:
    return BodyInertia(body.mass, factor * body.com, factor**2 * body.inertia)


def _asis(found: Skeleton, mapping: MarkerMap) -> Array:
    pelvis = found.segments["pelvis"]
    return pelvis.poses.to_world(pelvis.place(mapping.landmark("asis_right") + mapping.landmark("asis_left")))


def _navel_above_asis(found: Skeleton, mapping: MarkerMap, subject: Subject) -> float:
    return SEGMENTS[subject.sex]["lower_trunk"].length * subject.stature - _hip_below_asis(found, mapping)


def _hip_below_asis(found: Skeleton, mapping: MarkerMap) -> float:
    pelvis = found.segments["pelvis"]
    right, left = (pelvis.place(mapping.landmark(f"asis_{side}")) for side in ("right", "left"))
    return HIP_BELOW_ASIS * float(np.linalg.norm(right - left))


def _statures(found: Skeleton, mapping: MarkerMap, sex: Sex, mass: float) -> dict[str, float]:
    trunk = found.segments["trunk"]
    top = trunk.poses.to_world(trunk.place(mapping.landmark("suprasternale")))[:, 2]
    height = float(np.nanmean((top - _asis(found, mapping)[:, 2])[found.upright]))
    neck, waist = DIMENSIONS[sex]["suprasternaleheight"], DIMENSIONS[sex]["waistheightomphalion"]
    # Suprasternale less front spines: neck - (waist - lower trunk + hip below ASIS), all linear in stature.
    slope = neck.per_stature - waist.per_stature + SEGMENTS[sex]["lower_trunk"].length
    rest = neck.constant - waist.constant + (neck.per_mass - waist.per_mass) * mass - _hip_below_asis(found, mapping)
    return {
        "trunk": (height - rest) / slope,
        "upper arm": found.upper_arm / SEGMENTS[sex]["upper_arm"].length,
        "forearm": found.forearm / SEGMENTS[sex]["forearm"].length,
    }
