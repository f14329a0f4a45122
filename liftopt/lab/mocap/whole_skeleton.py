"""The whole skeleton that markers show: axes, lengths, how the feet stand and how alike both sides are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.mocap.anatomy import LONGEST_ARM, SHORTEST_ARM, UPRIGHT
from liftopt.lab.mocap.gaps import runs
from liftopt.lab.mocap.outliers import shown
from liftopt.lab.mocap.recording import TO_Z_UP, Recording
from liftopt.lab.mocap.rigid import were_seen
from liftopt.lab.mocap.whole_centres import Axes, Centres, axes_of
from liftopt.lab.mocap.whole_map import SIDES, WholeMap
from liftopt.types import Array

LONGEST_LEG, SHORTEST_LEG = 0.65, 0.2  # m, of a thigh or shank
STRAIGHT, ERECT = np.radians(25.0), np.radians(20.0)  # of knee and trunk of one who stands
STRAIGHTEST = np.radians(3.0)  # knee and trunk together, from the straightest frame
FEWEST_STANDING = 5  # frames
# Inclination of the plane through the spines of the pelvis where nobody stands in a trial: mean of 30 pelves in the
# anatomical position, 13 deg (sd 5), Preece et al. (2008), J Man Manip Ther 16:113-117.
PELVIC_TILT = np.radians(13.0)
STEP = 0.10  # m on the floor from where a foot stands; farther, it has stepped


@dataclass(frozen=True)
class WholeSkeleton:
    """What the markers show of the whole person.

    Attributes:
        centres: of the joints, and axes of pelvis and trunk.
        axes: of ``"pelvis"``, upright while standing, ``"trunk"`` and, by side and segment (``"right upper_arm"``), of
            the arms; their origins are the hips' middle, the trunk's landmarks, and the proximal joint.
        lengths: of thigh and shank in the sagittal plane, both legs as one; of upper arm, forearm and hand, mean of
            both sides; NaN of a hand that no marker shows [m].
        by_side: all of them by side, right and left, in space [m].
        heading: direction that the pelvis faces, mean over the trial, about Z from X [rad].
        upright: (F,) True in the frames with the trunk most upright.
        pelvic_tilt: inclination of the pelvis' plane that counts as upright [rad].
        standing: (F,) True in the frames in which the person stands; where they are few that is a mean of people.
        breastbone: height of its notch above the ankles while standing, None where nobody stands or no marker shows it
            [m].
        elbow_flexion, knee_flexion: (F, 2) right and left, between the lines from centre to centre, 0 when straight
            [rad].
    """

    centres: Centres
    axes: dict[str, Axes]
    lengths: dict[str, float]
    by_side: dict[str, tuple[float, float]]
    heading: float
    upright: npt.NDArray[np.bool_]
    pelvic_tilt: float
    standing: npt.NDArray[np.bool_]
    breastbone: float | None
    elbow_flexion: Array
    knee_flexion: Array

    @property
    def stands(self) -> bool:
        """Whether the person stands upright long enough to be measured so."""
        return bool(self.standing.sum() >= FEWEST_STANDING)


def whole_skeleton(recording: Recording, mapping: WholeMap, centres: Centres) -> WholeSkeleton:
    """Return the skeleton of a recording in metres, Z up, gaps filled.

    Raises:
        InputError: the person does not stand upright (a wrong up axis), right and left are swapped, a limb is longer or
            shorter than limbs are (wrong units), or a foot steps.
    """
    _check_upright(recording, mapping, centres)
    forward = centres.pelvis.rotation[:, :, 0]
    mean = np.nanmean(forward, axis=0)
    heading = float(np.arctan2(mean[1], mean[0]))
    up = centres.trunk.rotation[:, 2, 2]
    upright = up >= np.nanquantile(up, 1.0 - UPRIGHT)
    knee = np.stack([_bend(centres, side, "hip", "knee", "ankle") for side in SIDES], axis=1)
    standing = _standing(np.nanmax(knee, axis=1, initial=0.0), np.arccos(np.clip(up, -1.0, 1.0)))
    tilt = 0.0
    if centres.has_pelvis:
        pitch = -np.arcsin(np.clip(forward[:, 2], -1.0, 1.0))[standing & np.isfinite(forward[:, 2])]
        tilt = float(pitch.mean()) if len(pitch) >= FEWEST_STANDING else float(PELVIC_TILT)
    by_side = {name: _lengths(centres, *ends) for name, ends in SEGMENTS.items()}
    ahead = np.array([np.cos(heading), np.sin(heading), 0.0])
    lengths = {name: float(np.mean(pair)) for name, pair in by_side.items()}
    lengths |= {name: _sagittal(centres, ahead, *SEGMENTS[name]) for name in ("thigh", "shank")}
    _check_sizes(recording, lengths)
    _check_feet(recording, centres)
    c, s = np.cos(tilt), np.sin(tilt)
    level = np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])
    axes = {"pelvis": Axes(centres.pelvis.rotation @ level, centres.pelvis.origin), "trunk": centres.trunk}
    for side in SIDES:
        for name in ("upper_arm", "forearm", "hand"):
            proximal, distal = (centres.joint[side, end] for end in SEGMENTS[name])
            axes[f"{side} {name}"] = Axes(axes_of(proximal - distal, centres.across[side, name]), proximal)
    breastbone = _breastbone(recording, mapping, centres, standing)
    return WholeSkeleton(
        centres, axes, lengths, by_side, heading, upright, tilt, standing, breastbone,
        np.stack([_bend(centres, side, "shoulder", "elbow", "wrist") for side in SIDES], axis=1), knee,
    )  # fmt: skip


# Segment -> proximal and distal joint.
SEGMENTS = {
    "thigh": ("hip", "knee"),
    "shank": ("knee", "ankle"),
    "upper_arm": ("shoulder", "elbow"),
    "forearm": ("elbow", "wrist"),
    "hand": ("wrist", "knuckle"),
}


def _standing(knee: Array, lean: Array) -> npt.NDArray[np.bool_]:
    """Return (F,) True where knees and trunk are straightest, if they are as straight as of one who stands."""
    bent = knee + lean
    stands = (knee < STRAIGHT) & (lean < ERECT)
    return np.asarray(stands & (bent <= np.nanmin(bent) + STRAIGHTEST))


def _breastbone(
    recording: Recording, mapping: WholeMap, centres: Centres, standing: npt.NDArray[np.bool_]
) -> float | None:
    channels = [recording.index(label) for label in mapping.landmark("suprasternale")]
    if not channels:
        return None
    rise = (recording.points[:, channels].mean(axis=1) - centres.middle("ankle"))[standing, 2]
    return float(np.nanmean(rise)) if np.isfinite(rise).sum() >= FEWEST_STANDING else None


def _lengths(centres: Centres, proximal: str, distal: str) -> tuple[float, float]:
    right, left = (
        _mean(np.linalg.norm(centres.joint[side, proximal] - centres.joint[side, distal], axis=1)) for side in SIDES
    )
    return right, left


def _sagittal(centres: Centres, ahead: Array, proximal: str, distal: str) -> float:
    way = centres.middle(proximal) - centres.middle(distal)
    return _mean(np.hypot(way @ ahead, way[:, 2]))


def _bend(centres: Centres, side: str, first: str, middle: str, last: str) -> Array:
    upper = centres.joint[side, middle] - centres.joint[side, first]
    lower = centres.joint[side, last] - centres.joint[side, middle]
    cosine = (upper * lower).sum(axis=1) / (np.linalg.norm(upper, axis=1) * np.linalg.norm(lower, axis=1))
    return np.asarray(np.arccos(np.clip(cosine, -1.0, 1.0)))


def _mean(values: Array) -> float:
    return float(np.nanmean(values)) if np.isfinite(values).any() else float("nan")


def _check_upright(recording: Recording, mapping: WholeMap, centres: Centres) -> None:
    rise = centres.trunk.origin - centres.pelvis.origin
    if not were_seen(rise).any():
        raise InputError(recording.source, NO_VALUE, "trunk and pelvis are never seen in one frame")
    middle = np.median(rise[were_seen(rise)], axis=0)
    if not (np.nanmax(centres.trunk.rotation[:, 2, 2]) > 0.5 and middle[2] > 0.0):
        in_file = TO_Z_UP[mapping.up].T @ middle
        axis = int(np.argmax(np.abs(in_file)))
        name = ("-" if in_file[axis] < 0.0 else "") + "XYZ"[axis]
        says = f'does not stand upright so; trunk over pelvis says "{name}"'
        raise InputError("up", mapping.up, f"the person of {recording.source} {says}")
    if centres.has_pelvis and np.nanmean(centres.pelvis.rotation[:, 2, 2]) <= 0.0:
        raise InputError(
            "landmarks.right.asis",
            list(mapping.landmark("asis", "right")),
            "is to the left of the left one for who faces from psis to asis: swapped labels or left-handed axes",
        )


def _check_sizes(recording: Recording, lengths: dict[str, float]) -> None:
    for name in ("thigh", "shank", "upper_arm", "forearm"):
        length, legs = lengths[name], name in ("thigh", "shank")
        least, most = (SHORTEST_LEG, LONGEST_LEG) if legs else (SHORTEST_ARM, LONGEST_ARM)
        what = name.replace("_", " ")
        if np.isnan(length):
            raise InputError(recording.source, NO_VALUE, f"the {what} is never seen in one frame with its neighbours")
        if not least <= length <= most:
            allowed = f"from {least:g} to {most:g} m; are units and landmarks right?"
            raise InputError(
                recording.source, NO_VALUE, f"the {what} would be {length:.4g} m long, but must be {allowed}"
            )


def _check_feet(recording: Recording, centres: Centres) -> None:
    """Check that both feet stay where they stand."""
    for side in SIDES:
        way = foot_travel(centres, side)
        if np.isnan(way).all():
            raise InputError(recording.source, NO_VALUE, f"the {side} ankle is never seen")
        if np.nanmax(way) > STEP:
            spans = shown(recording, runs(np.nan_to_num(way) > STEP))
            raise InputError(
                recording.source,
                f"{np.nanmax(way):.2f} m",
                f"is how far the {side} foot is from where it stands most of the time ({spans}); feet must stay within "
                f"{STEP:g} m: cut the trial with --from and --to",
            )


def foot_travel(centres: Centres, side: str) -> Array:
    """Return how far (F,) an ankle is, along the floor, from where it is most of the time [m]."""
    ankle = centres.joint[side, "ankle"][:, :2]
    return np.asarray(np.linalg.norm(ankle - np.nanmedian(ankle, axis=0), axis=1))
