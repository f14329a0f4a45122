"""The skeleton that the markers show: segment frames, joint centres and lengths, averaged over a trial."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.mocap.marker_map import TRACKED, Labels, MarkerMap
from liftopt.lab.mocap.recording import TO_Z_UP, Recording
from liftopt.lab.mocap.rigid import FEWEST, Poses, common_point, fit_poses, mean_shape, were_seen
from liftopt.lab.mocap.wrist_centre import with_wrist
from liftopt.types import Array

# Shoulder centre below the acromion over the breadth between the acromia: Rab, Petuskey & Bagley (2002), Gait Posture
# 15:113-119. Used where the arm moves too little to find its centre of rotation.
BELOW_ACROMION = 0.17
ENOUGH_MOTION = 0.05
LONGEST_ARM, SHORTEST_ARM = 0.5, 0.1  # m, of an upper arm or forearm
THIRD_KNUCKLE = 1.0 / 3.0  # of the way from the index finger's to the little finger's: knuckles are evenly spaced
UPRIGHT = 0.25  # share of the frames, those with the trunk most upright, taken as standing


@dataclass(frozen=True)
class Segment:
    """One segment over a trial.

    Attributes:
        labels: its markers.
        shape: (M, 3) their mean places in the body's own axes [m].
        poses: of the body.
        scatter: (M,) root mean square distance of each marker from its mean place: how far it is from rigid [m].
    """

    labels: Labels
    shape: Array
    poses: Poses
    scatter: Array

    def place(self, labels: Labels) -> Array:
        """Return (3,) the mean of these markers in the body [m]."""
        return np.asarray(self.shape[[self.labels.index(label) for label in labels]].mean(axis=0))


@dataclass(frozen=True)
class Frame:
    """Anatomical axes of a segment in its body: X forward, Y left, Z up when the arm hangs with the palm forward.

    Attributes:
        rotation: (3, 3) R_body_anatomical.
        origin: (3,) [m].
    """

    rotation: Array
    origin: Array

    def seen(self, points: Array) -> Array:
        """Return points (..., 3) of the body in the anatomical frame."""
        return np.asarray((points - self.origin) @ self.rotation)


@dataclass(frozen=True)
class Skeleton:
    """What the markers show of the person.

    Attributes:
        segments: by name.
        frames: of the trunk (origin halfway between its landmarks), upper arm (shoulder), forearm (elbow), hand
            (wrist).
        shoulder_in_trunk: (3,) mean of the shoulder's centre in the trunk's frame [m].
        shoulder_travel: (3,) its range in the trunk's frame: what clavicle and shoulder blade do [m].
        shoulder_found: how the shoulder's centre was found, in words.
        upper_arm, forearm, hand: joint to joint, and wrist to the third knuckle [m].
        elbow_flexion: (F,) between the lines from joint centre to joint centre, 0 when the arm is straight [rad].
        upright: (F,) True in the frames taken as standing.
        heading: direction that the pelvis faces, mean over the trial, about Z from X [rad].
        pelvis_turn: (F, 3) heading against that mean, pitch and roll of the pelvis against standing [rad].
    """

    segments: dict[str, Segment]
    frames: dict[str, Frame]
    shoulder_in_trunk: Array
    shoulder_travel: Array
    shoulder_found: str
    upper_arm: float
    forearm: float
    hand: float
    elbow_flexion: Array
    upright: npt.NDArray[np.bool_]
    heading: float
    pelvis_turn: Array


def skeleton(recording: Recording, mapping: MarkerMap) -> Skeleton:
    """Return the skeleton of a recording in metres, Z up, gaps filled.

    Raises:
        InputError: a segment has too few markers, the person does not stand upright (a wrong up axis), right and left
            are swapped, or an arm is longer or shorter than arms are (wrong units).
    """
    segments = {
        name: _segment(recording, name, labels)
        for name, labels in with_wrist(mapping).items()
        if name in ("pelvis", "scapula", *TRACKED)
    }
    trunk = _trunk_frame(segments["trunk"], mapping)
    up = np.einsum("fij,j->fi", segments["trunk"].poses.rotation, trunk.rotation[:, 2])
    _check_upright(recording, mapping, segments, up)
    upright = up[:, 2] >= np.nanquantile(up[:, 2], 1.0 - UPRIGHT)
    heading, turn = _pelvis(segments["pelvis"], mapping, upright)

    arm, forearm, hand = segments["upper_arm"], segments["forearm"], segments["hand"]
    shoulder, in_trunk, how = _shoulder(recording, mapping, segments, trunk)
    elbow = arm.place(mapping.landmark("elbow_lateral") + mapping.landmark("elbow_medial"))
    elbow_on_forearm = _mean(forearm.poses.to_body(arm.poses.to_world(elbow)))
    wrist = forearm.place(mapping.landmark("wrist_radial") + mapping.landmark("wrist_ulnar"))
    wrist_on_hand = _mean(hand.poses.to_body(forearm.poses.to_world(wrist)))
    index, little = hand.place(mapping.landmark("knuckle_index")), hand.place(mapping.landmark("knuckle_little"))
    knuckle = index + THIRD_KNUCKLE * (little - index)
    lengths = [float(np.linalg.norm(a - b)) for a, b in ((shoulder, elbow), (elbow_on_forearm, wrist))]
    _check_size(recording, dict(zip(("upper arm", "forearm"), lengths, strict=True)))

    def across(segment: Segment, outer: str, inner: str) -> Array:
        return segment.place(mapping.landmark(inner)) - segment.place(mapping.landmark(outer))

    frames = {
        "trunk": trunk,
        "upper_arm": _limb(shoulder, elbow, across(arm, "elbow_lateral", "elbow_medial")),
        "forearm": _limb(elbow_on_forearm, wrist, across(forearm, "wrist_radial", "wrist_ulnar")),
        "hand": _limb(wrist_on_hand, knuckle, across(hand, "knuckle_index", "knuckle_little")),
    }
    travel = trunk.seen(in_trunk)
    return Skeleton(
        segments=segments,
        frames=frames,
        shoulder_in_trunk=_mean(travel),
        shoulder_travel=np.nanmax(travel, axis=0) - np.nanmin(travel, axis=0),
        shoulder_found=how,
        upper_arm=lengths[0],
        forearm=lengths[1],
        hand=float(np.linalg.norm(knuckle - wrist_on_hand)),
        elbow_flexion=_bend(
            segments["trunk"].poses.to_world(in_trunk),
            _midpoint(recording, mapping, "elbow_lateral", "elbow_medial"),
            _midpoint(recording, mapping, "wrist_radial", "wrist_ulnar"),
        ),
        upright=upright,
        heading=heading,
        pelvis_turn=turn,
    )


def _segment(recording: Recording, name: str, labels: Labels) -> Segment:
    if len(labels) < FEWEST:
        raise InputError(f"segments.{name}", list(labels), f"a pose takes {FEWEST} markers that are not on a line")
    points = recording.points[:, [recording.index(label) for label in labels]]
    unseen = [label for i, label in enumerate(labels) if not np.isfinite(points[:, i]).any()]
    if unseen:
        raise InputError(f"{recording.source}, {', '.join(unseen)}", NO_VALUE, f"never seen; needed for the {name}")
    shape = mean_shape(points)
    poses = fit_poses(shape, points) if were_seen(shape).all() else None
    if poses is None or not were_seen(poses.translation).any():
        raise InputError(
            f"segments.{name}",
            list(labels),
            f"no frame of {recording.source} shows {FEWEST} of them that are not on a line",
        )
    scatter = np.sqrt(np.nanmean(((poses.to_body(points) - shape) ** 2).sum(axis=2), axis=0))
    return Segment(labels, shape, poses, scatter)


def _trunk_frame(trunk: Segment, mapping: MarkerMap) -> Frame:
    """Return the axes of the thorax (Wu et al. 2005, J Biomech 38:981-992), its origin amid its four landmarks."""
    front_up, front_down, back_up, back_down = (
        trunk.place(mapping.landmark(name)) for name in ("suprasternale", "xiphoid", "c7", "t8")
    )
    up = front_up + back_up - front_down - back_down
    forward = front_up + front_down - back_up - back_down
    left = _unit(np.cross(up, forward))
    up = _unit(up)
    origin = (front_up + front_down + back_up + back_down) / 4.0
    return Frame(np.column_stack([np.cross(left, up), left, up]), origin)


def _limb(proximal: Array, distal: Array, inward: Array) -> Frame:
    """Return the axes of a hanging limb of the right side; ``inward`` goes from its outer to its inner landmark."""
    up = _unit(proximal - distal)
    left = _unit(inward - (inward @ up) * up)
    return Frame(np.column_stack([np.cross(left, up), left, up]), proximal)


def _shoulder(
    recording: Recording, mapping: MarkerMap, segments: dict[str, Segment], trunk: Frame
) -> tuple[Array, Array, str]:
    """Return the shoulder's centre in the upper arm (3,), in the trunk's body (F, 3), and how it was found."""
    arm, thorax = segments["upper_arm"].poses, segments["trunk"].poses
    carrier = "scapula" if "scapula" in segments else "trunk"
    point = common_point(segments[carrier].poses, arm)
    if point.motion >= ENOUGH_MOTION:
        in_trunk = thorax.to_body(segments[carrier].poses.to_world(point.first))
        where = "shoulder blade" if carrier == "scapula" else carrier
        how = f"centre of rotation of the upper arm on the {where}, to {1000 * point.distance:.1f} mm"
        return point.second, in_trunk, how
    channels = [recording.index(label) for label in mapping.landmark("acromion_right")]
    acromion = thorax.to_body(recording.points[:, channels].mean(axis=1))
    breadth = 2.0 * np.abs(trunk.seen(acromion)[:, 1])
    in_trunk = acromion - BELOW_ACROMION * breadth[:, None] * trunk.rotation[:, 2]
    return _mean(arm.to_body(thorax.to_world(in_trunk))), in_trunk, "below the acromion, as the arm hardly moves"


def _midpoint(recording: Recording, mapping: MarkerMap, *names: str) -> Array:
    channels = [[recording.index(label) for label in mapping.landmark(name)] for name in names]
    return np.asarray(np.mean([recording.points[:, group].mean(axis=1) for group in channels], axis=0))


def _bend(shoulder: Array, elbow: Array, wrist: Array) -> Array:
    upper, fore = elbow - shoulder, wrist - elbow
    cosine = (upper * fore).sum(axis=1) / (np.linalg.norm(upper, axis=1) * np.linalg.norm(fore, axis=1))
    return np.asarray(np.arccos(np.clip(cosine, -1.0, 1.0)))


def _pelvis(pelvis: Segment, mapping: MarkerMap, upright: npt.NDArray[np.bool_]) -> tuple[float, Array]:
    right, left = (pelvis.place(mapping.landmark(f"asis_{side}")) for side in ("right", "left"))
    rear = (pelvis.place(mapping.landmark("psis_right")) + pelvis.place(mapping.landmark("psis_left"))) / 2.0
    forward = np.einsum("fij,j->fi", pelvis.poses.rotation, _unit((right + left) / 2.0 - rear))
    aside = np.einsum("fij,j->fi", pelvis.poses.rotation, _unit(left - right))
    mean = np.nanmean(forward, axis=0)
    if np.cross([0.0, 0.0, 1.0], mean) @ np.nanmean(aside, axis=0) <= 0.0:
        raise InputError(
            "landmarks.asis_right",
            list(mapping.landmark("asis_right")),
            "is to the left of asis_left for one who faces from psis to asis: swapped labels or left-handed axes",
        )
    heading = float(np.arctan2(mean[1], mean[0]))
    yaw = np.arctan2(forward[:, 1], forward[:, 0]) - heading
    yaw = np.arctan2(np.sin(yaw), np.cos(yaw))
    pitch, roll = -np.arcsin(np.clip(forward[:, 2], -1, 1)), np.arcsin(np.clip(aside[:, 2], -1, 1))
    return heading, np.column_stack([yaw, pitch - np.nanmean(pitch[upright]), roll - np.nanmean(roll[upright])])


def _check_upright(recording: Recording, mapping: MarkerMap, segments: dict[str, Segment], up: Array) -> None:
    rise = segments["trunk"].poses.translation - segments["pelvis"].poses.translation
    rise = np.median(rise[were_seen(rise)], axis=0) if were_seen(rise).any() else np.full(3, np.nan)
    if np.isnan(rise).any():
        raise InputError(recording.source, NO_VALUE, "trunk and pelvis are never seen in one frame")
    if np.nanmax(up[:, 2]) > 0.5 and rise[2] > 0.0:
        return
    in_file = TO_Z_UP[mapping.up].T @ rise
    axis = int(np.argmax(np.abs(in_file)))
    name = ("-" if in_file[axis] < 0.0 else "") + "XYZ"[axis]
    raise InputError(
        "up", mapping.up, f'the person of {recording.source} does not stand upright so; trunk over pelvis says "{name}"'
    )


def _check_size(recording: Recording, lengths: dict[str, float]) -> None:
    for name, length in lengths.items():
        if np.isnan(length):
            raise InputError(recording.source, NO_VALUE, f"the {name} is never seen in one frame with its neighbours")
        if not SHORTEST_ARM <= length <= LONGEST_ARM:
            allowed = f"from {SHORTEST_ARM:g} to {LONGEST_ARM:g} m; are units and landmarks right?"
            raise InputError(
                recording.source, NO_VALUE, f"the {name} would be {length:.4g} m long, but must be {allowed}"
            )


def _mean(points: Array) -> Array:
    known = were_seen(points)
    return np.asarray(points[known].mean(axis=0)) if known.any() else np.full(3, np.nan)


def _unit(vector: Array) -> Array:
    return np.asarray(vector / np.linalg.norm(vector))
