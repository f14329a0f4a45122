"""Joint centres and the axes of pelvis and trunk in every frame, from the landmarks of a full-body marker set."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftopt.lab.mocap.anatomy import BELOW_ACROMION, THIRD_KNUCKLE
from liftopt.lab.mocap.recording import Recording
from liftopt.lab.mocap.rigid import were_seen
from liftopt.lab.mocap.whole_map import SIDES, TRUNK, WholeMap
from liftopt.multibody.person.subject import Sex
from liftopt.types import Array

# Hip centre from midway between the front spines, along the pelvis' own axes (X from the rear to the front spines, Y to
# the side, Z up): share of depth or width, and a constant [m]. Harrington et al. (2007), J Biomech 40:595-602, the
# equations of one predictor each.
HIP_AHEAD, HIP_ASIDE, HIP_UP = (-0.24, -0.0099), (0.33, 0.0073), (-0.30, -0.0109)
# Breadth of a joint where a marker stands on one side only [m]: means of 247 men and 260 women, Heinz et al. (2003),
# J Stat Educ 11(2); rounded to the millimetre.
BREADTH: dict[str, dict[Sex, float]] = {
    "elbow": {"male": 0.072, "female": 0.062},
    "knee": {"male": 0.098, "female": 0.090},
    "ankle": {"male": 0.074, "female": 0.065},
}
# From the knuckle of the index finger to the middle one: a quarter of the hand's breadth (means of ANSUR II) [m].
KNUCKLES_APART: dict[Sex, float] = {"male": 0.022, "female": 0.020}
LEAST_BEND = np.radians(15.0)  # of an elbow that shows the axis it bends about
OUTWARD = {"right": -1.0, "left": 1.0}  # along Y, to the left


@dataclass(frozen=True)
class Axes:
    """Axes of a segment in F frames: X forward, Y left, Z up of one who stands.

    Attributes:
        rotation: (F, 3, 3) R_recording_segment.
        origin: (F, 3) [m].
    """

    rotation: Array
    origin: Array

    def seen(self, points: Array) -> Array:
        """Return points (F, 3) along these axes from their origin [m]."""
        return np.asarray(np.einsum("fji,fj->fi", self.rotation, points - self.origin))

    def place(self, point: Array) -> Array:
        """Return where a point (3,) of the segment is (F, 3) [m]."""
        return np.asarray(self.rotation @ point + self.origin)


@dataclass(frozen=True)
class Centres:
    """What landmarks show without a model.

    Attributes:
        joint: by side and name (``"right", "knee"``): (F, 3) centres of hip, knee, ankle, shoulder, elbow, wrist, and
            ``"knuckle"``, the third one, NaN throughout where no marker shows it [m].
        across: by side and segment (upper_arm, forearm, hand): (F, 3) which way is left when the arm hangs with the
            palm ahead, NaN where nothing shows it.
        pelvis: origin midway between the hips, its axes as the spines have them.
        trunk: origin midway between its landmarks, or between the shoulders.
        has_pelvis: whether markers show how the pelvis is inclined.
    """

    joint: dict[tuple[str, str], Array]
    across: dict[tuple[str, str], Array]
    pelvis: Axes
    trunk: Axes
    has_pelvis: bool

    def middle(self, name: str) -> Array:
        """Return the mean (F, 3) of both sides' centres [m]."""
        return np.asarray((self.joint["right", name] + self.joint["left", name]) / 2.0)


class Landmarks:
    """Landmarks of a recording in metres, each (F, 3)."""

    def __init__(self, recording: Recording, mapping: WholeMap) -> None:
        self._recording, self._mapping = recording, mapping

    def has(self, name: str, side: str = "") -> bool:
        """Return whether the mapping has it."""
        return bool(self._mapping.landmark(name, side))

    def at(self, name: str, side: str = "") -> Array:
        """Return where it is (F, 3), the mean of its markers; NaN where one of these was not seen [m]."""
        channels = [self._recording.index(label) for label in self._mapping.landmark(name, side)]
        return np.asarray(self._recording.points[:, channels].mean(axis=1))

    def both(self, name: str) -> tuple[Array, Array]:
        """Return the right and the left one."""
        return self.at(name, "right"), self.at(name, "left")


def joint_centres(recording: Recording, mapping: WholeMap, sex: Sex) -> Centres:
    """Return joint centres and axes in every frame of a recording in metres, Z up.

    Hips by regression on the pelvis (Harrington et al. 2007), knees and ankles midway between their two sides or half
    a breadth inwards of the outer one, shoulders below the acromia (Rab et al. 2002), elbows and wrists midway, or half
    a breadth from the outer side along the axis about which the elbow bends; where video shows a centre, that.
    """
    found = Landmarks(recording, mapping)
    pelvis, hips = _pelvis(found) if found.has("asis", "right") else _pelvis_of_hips(found)
    trunk = _trunk(found, pelvis)
    joint: dict[tuple[str, str], Array] = {}
    across: dict[tuple[str, str], Array] = {}
    for side, hip, shoulder in zip(SIDES, hips, _shoulders(found, trunk), strict=True):
        joint[side, "hip"], joint[side, "shoulder"] = hip, shoulder
        inward = -OUTWARD[side] * pelvis.rotation[:, :, 1]
        for name in ("knee", "ankle"):
            joint[side, name] = _of_leg(found, side, name, BREADTH[name][sex] * inward)
        arm, lefts = _arm(found, side, shoulder, trunk.rotation[:, :, 1], sex)
        joint |= {(side, name): centre for name, centre in arm.items()}
        across |= {(side, name): left for name, left in lefts.items()}
    return Centres(joint, across, pelvis, trunk, found.has("asis", "right"))


def axes_of(up: Array, left: Array) -> Array:
    """Return (F, 3, 3) the axes X forward, Y left, Z up: Z along ``up`` (F, 3), Y as near to ``left`` as it can be."""
    z = unit(up)
    y = unit(left - (left * z).sum(axis=1, keepdims=True) * z)
    return np.stack([np.cross(y, z), y, z], axis=2)


def unit(vectors: Array) -> Array:
    """Return vectors (F, 3) of length one."""
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


def _pelvis(found: Landmarks) -> tuple[Axes, tuple[Array, Array]]:
    front, rear = found.both("asis"), found.both("psis")
    middle = (front[0] + front[1]) / 2.0
    forward, left = middle - (rear[0] + rear[1]) / 2.0, front[1] - front[0]
    depth, width = (float(np.nanmean(np.linalg.norm(way, axis=1))) for way in (forward, left))
    y = unit(left)
    x = unit(forward - (forward * y).sum(axis=1, keepdims=True) * y)
    rotation = np.stack([x, y, np.cross(x, y)], axis=2)
    (ax, bx), (ay, by), (az, bz) = HIP_AHEAD, HIP_ASIDE, HIP_UP
    ahead, aside, up = ax * depth + bx, ay * width + by, az * width + bz
    hips = [Axes(rotation, middle).place(np.array([ahead, OUTWARD[side] * aside, up])) for side in SIDES]
    return Axes(rotation, (hips[0] + hips[1]) / 2.0), (hips[0], hips[1])


def _pelvis_of_hips(found: Landmarks) -> tuple[Axes, tuple[Array, Array]]:
    """Return a pelvis that is inclined as the trunk: nothing shows how it is."""
    hips, shoulders = found.both("hip"), _tops(found)
    middle = (hips[0] + hips[1]) / 2.0
    return Axes(axes_of((shoulders[0] + shoulders[1]) / 2.0 - middle, hips[1] - hips[0]), middle), hips


def _tops(found: Landmarks) -> tuple[Array, Array]:
    return found.both("shoulder" if found.has("shoulder", "right") and found.has("shoulder", "left") else "acromion")


def _trunk(found: Landmarks, pelvis: Axes) -> Axes:
    """Return the axes of the thorax (Wu et al. 2005, J Biomech 38:981-992), or of the line from hips to shoulders."""
    if not found.has(TRUNK[0]):
        right, left = _tops(found)
        middle = (right + left) / 2.0
        return Axes(axes_of(middle - pelvis.origin, left - right), middle)
    front_up, front_down, back_up, back_down = (found.at(name) for name in TRUNK)
    up = front_up + back_up - front_down - back_down
    forward = front_up + front_down - back_up - back_down
    return Axes(axes_of(up, np.cross(up, forward)), (front_up + front_down + back_up + back_down) / 4.0)


def _shoulders(found: Landmarks, trunk: Axes) -> list[Array]:
    tops = _tops(found)
    below = BELOW_ACROMION * float(np.nanmean(np.linalg.norm(tops[0] - tops[1], axis=1)))
    return [
        found.at("shoulder", side)
        if found.has("shoulder", side)
        else found.at("acromion", side) - below * trunk.rotation[:, :, 2]
        for side in SIDES
    ]


def _of_leg(found: Landmarks, side: str, name: str, inward: Array) -> Array:
    """Return the centre of a knee or an ankle; ``inward`` (F, 3) is as long as the joint is broad."""
    if found.has(name, side):
        return found.at(name, side)
    outer = found.at(f"{name}_lateral", side)
    return (
        (outer + found.at(f"{name}_medial", side)) / 2.0 if found.has(f"{name}_medial", side) else outer + inward / 2.0
    )


def _arm(
    found: Landmarks, side: str, shoulder: Array, left: Array, sex: Sex
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return elbow, wrist and knuckle, and which way is left of upper arm, forearm and hand; ``left`` of the trunk."""
    inward, unknown = -OUTWARD[side], np.full_like(shoulder, np.nan)
    has_wrist_sides = found.has("wrist_radial", side)
    radial, ulnar = (
        (found.at("wrist_radial", side), found.at("wrist_ulnar", side)) if has_wrist_sides else (unknown, unknown)
    )
    wrist = found.at("wrist", side) if found.has("wrist", side) else (radial + ulnar) / 2.0
    forearm = inward * (ulnar - radial)
    if found.has("elbow", side):
        elbow = found.at("elbow", side)
        upper_arm = _bend_axis(shoulder, elbow, wrist)
    elif found.has("elbow_medial", side):
        outer, inner = found.at("elbow_lateral", side), found.at("elbow_medial", side)
        elbow, upper_arm = (outer + inner) / 2.0, inward * (inner - outer)
    else:
        outer = found.at("elbow_lateral", side)
        upper_arm = _bend_axis(shoulder, outer, wrist)
        elbow = outer + 0.5 * BREADTH["elbow"][sex] * inward * _carried_on(upper_arm, left)
    index, middle, little = (
        found.at(name, side) if found.has(name, side) else unknown
        for name in ("knuckle_index", "knuckle_middle", "knuckle_little")
    )
    hand = inward * (little - index) if found.has("knuckle_little", side) else forearm
    if found.has("knuckle_middle", side):
        knuckle = middle
    elif found.has("knuckle_little", side):
        knuckle = index + THIRD_KNUCKLE * (little - index)
    else:
        knuckle = index + KNUCKLES_APART[sex] * inward * unit(forearm)
    return {"elbow": elbow, "wrist": wrist, "knuckle": knuckle}, {
        "upper_arm": upper_arm, "forearm": forearm, "hand": hand,
    }  # fmt: skip


def _bend_axis(shoulder: Array, elbow: Array, wrist: Array) -> Array:
    """Return (F, 3) the axis about which the elbow bends, to the left; NaN where it is too straight to tell."""
    upper, fore = unit(elbow - shoulder), unit(wrist - elbow)
    axis = np.cross(fore, upper)
    bent = np.linalg.norm(axis, axis=1) >= np.sin(LEAST_BEND)
    return np.where(bent[:, None], unit(np.where(bent[:, None], axis, 1.0)), np.nan)


def _carried_on(axis: Array, otherwise: Array) -> Array:
    """Return an axis (F, 3) where it is unknown as it is before and after; another one if it is known nowhere."""
    known = np.flatnonzero(were_seen(axis))
    if not known.size:
        return otherwise
    frames = np.arange(len(axis))
    return unit(np.stack([np.interp(frames, known, axis[known, i]) for i in range(3)], axis=1))
