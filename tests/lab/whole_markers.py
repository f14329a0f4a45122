"""A whole person whose motion is known, and the full-body markers that a laboratory would have recorded of it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pinocchio as pin

from liftopt.lab.mocap.recording import Recording
from liftopt.multibody.person.anthropometry import landmarks, link_lengths
from liftopt.multibody.person.segments import SEGMENTS
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.person.whole_body import WholeLengths, whole_human_urdf
from liftopt.multibody.urdf import load_model
from liftopt.types import Array

RATE, FRAMES = 100.0, 300
SUBJECT = Subject(1.7, 65.0, "female")
HEADING, SHIFT = np.radians(200.0), np.array([0.8, -0.3, 0.25])
TILT = np.radians(10.0)
# Breadths and regressions as published: Harrington et al. (2007) with a pelvis 0.24 m wide and 0.15 m deep.
WIDTH, DEPTH, ELBOW, KNEE, ANKLE = 0.24, 0.15, 0.062, 0.09, 0.065
HIP = np.array([-0.24 * DEPTH - 0.0099, 0.33 * WIDTH + 0.0073, -0.30 * WIDTH - 0.0109])
SIDES = (("right", "R", -1.0), ("left", "L", 1.0))
# In degrees: legs ankle, knee, hip; trunk Q2; of both arms Q4, Q5, Q6, Q7, Q8, Q9, Q10.
LOW = {
    "squat": (30.0, 105.0, 85.0, 25.0, (-15.0, 60.0, 12.0, -40.0, -70.0, -8.0, 6.0)),
    "straight": (-8.0, 12.0, 60.0, 35.0, (-5.0, 80.0, 2.0, -4.0, -60.0, -6.0, 2.0)),
    "stoop": (-8.0, 12.0, 70.0, 45.0, (-12.0, 105.0, 10.0, -25.0, -60.0, -10.0, 5.0)),
}
STRAIGHT = (-5.0, 5.0, 2.0, -4.0, -60.0, -5.0, 2.0)
HIGH = (-10.0, 20.0, 8.0, -75.0, -60.0, -5.0, 4.0)
BOX = np.array([[0.15, 0.2, 0.1], [0.15, -0.2, 0.1], [-0.15, 0.2, 0.15], [-0.15, -0.2, 0.05]])
MAPPING: dict[str, Any] = {
    "schema": 1,
    "body": "whole",
    "up": "Z",
    "subject": {"sex": "female", "mass": SUBJECT.mass, "stature": SUBJECT.stature},
    "landmarks": {"suprasternale": "STER", "xiphoid": "XIPH", "c7": "C7", "t8": "T8"}
    | {
        side: {
            "asis": f"{s}ASI", "psis": f"{s}PSI", "acromion": f"{s}SHO", "elbow_lateral": f"{s}ELB",
            "elbow_medial": f"{s}ELM", "wrist_radial": f"{s}WRR", "wrist_ulnar": f"{s}WRU",
            "knuckle_index": f"{s}MC2", "knuckle_little": f"{s}MC5", "knee_lateral": f"{s}KNE",
            "knee_medial": f"{s}KNM", "ankle_lateral": f"{s}ANK", "ankle_medial": f"{s}ANM", "heel": f"{s}HEE",
            "toe": f"{s}TOE",
        }
        for side, s, _ in SIDES
    },
    "segments": {"object": ["B1", "B2", "B3", "B4"]}
    | {
        side: {"upper_arm": [f"{s}UPA"], "forearm": [f"{s}FRM"], "hand": [f"{s}HND"], "thigh": [f"{s}THI"],
               "shank": [f"{s}TIB"]}
        for side, s, _ in SIDES
    },
}  # fmt: skip


@dataclass(frozen=True)
class WholeTruth:
    """A recording and what is true of it.

    Attributes:
        recording: in mm, Z up, turned and shifted against the world.
        q: (F, 20).
        lengths: of the person; the left arm is not as long as the right one.
        urdf: of the person.
        box: (F, 3) path of the box in the world [m].
        turn: (3, 3) R_recording_world.
        points: by label (F, 3) in the world [m], joint centres (``"RKnee"``) among them.
    """

    recording: Recording
    q: Array
    lengths: WholeLengths
    urdf: str
    box: Array
    turn: Array
    points: dict[str, Array]

    def with_labels(self, *labels: str) -> Recording:
        """Return a recording of other points, and the box."""
        chosen = [*labels, "B1", "B2", "B3", "B4"]
        seen = np.stack([self.points[label] for label in chosen], axis=1)
        # No camera sees a foot at the very same place twice.
        seen = seen + np.random.default_rng(0).normal(0.0, 1e-7, seen.shape)
        return replace(self.recording, labels=tuple(chosen), points=1000.0 * (seen @ self.turn.T + SHIFT))


def whole_truth(kind: str) -> WholeTruth:
    """Return a ``"squat"`` or ``"stoop"`` lift with both hands, or a stoop with ``"straight"`` arms.

    The person is upright, down to the box, up with it.
    """
    own, links = WholeLengths.of(SUBJECT), link_lengths(SUBJECT)
    hip = landmarks(SUBJECT).ankle + 0.40 + 0.41
    base = hip + SEGMENTS["female"]["lower_trunk"].length * SUBJECT.stature
    right = replace(links, l1=base, l2=0.30, l3=0.17, l4=0.28, l5=0.25, l6=0.07)
    lengths = WholeLengths(right, replace(right, l4=0.27, l5=0.245, l6=0.072), own.ankle, hip - 0.41, hip, 0.02)
    urdf = whole_human_urdf(SUBJECT, measured=lengths)
    q = _motion(kind, list(load_model(urdf).names)[1:])
    seen = points_on(lengths, urdf, q)
    middle = (seen["RGrasp"] + seen["LGrasp"]) / 2.0
    lifted = np.arange(FRAMES) >= FRAMES // 2
    box = np.where(lifted[:, None], middle, middle[FRAMES // 2])
    box = box + np.array([0.15, 0.0, 0.0])
    return _with_recording(q, lengths, urdf, box, seen)


def recorded_truth(lengths: WholeLengths, urdf: str, q: Array, box: Array, turn: Array) -> WholeTruth:
    """Return what a laboratory would have recorded at ``RATE`` of any motion of a person and a box.

    Args:
        lengths: of the person.
        urdf: of the person, who stands at the origin and faces X.
        q: (F, 20).
        box: (F, 3) its centre in the world [m].
        turn: (F, 3, 3) its axes in the world.
    """
    seen = points_on(lengths, urdf, q)
    return _with_recording(q, lengths, urdf, box, seen, turn)


def points_on(lengths: WholeLengths, urdf: str, q: Array) -> dict[str, Array]:
    """Return by label where markers, in capitals, and joint centres are (F, 3) in the world [m]."""
    model, places = load_model(urdf), _at_zero(lengths)
    zero, data = model.createData(), model.createData()
    pin.forwardKinematics(model, zero, np.zeros(model.nq))
    joints = {name: model.getJointId(f"human_{name}") for name in places if name != "feet"}
    points: dict[str, list[Array]] = {label: [] for group in places.values() for label in group}
    for pose in q:
        pin.forwardKinematics(model, data, pose)
        for name, group in places.items():
            for label, at in group.items():
                joint = joints.get(name, 0)
                points[label].append(data.oMi[joint].act(zero.oMi[joint].actInv(at)))
    return {label: np.array(path) for label, path in points.items()}


def _with_recording(
    q: Array, lengths: WholeLengths, urdf: str, box: Array, seen: dict[str, Array], axes: Array | None = None
) -> WholeTruth:
    turns = np.broadcast_to(np.eye(3), (len(q), 3, 3)) if axes is None else axes
    marked = [label for label in seen if label.isupper()]
    seen = seen | {f"B{i + 1}": box + turns @ at for i, at in enumerate(BOX)}
    c, s = np.cos(HEADING), np.sin(HEADING)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    blank = Recording("synthetic", RATE, np.arange(len(q)) / RATE, (), np.zeros((len(q), 0, 3)), "mm", "Z")
    truth = WholeTruth(blank, q, lengths, urdf, box, turn, seen)
    return replace(truth, recording=truth.with_labels(*marked))


def _motion(kind: str, names: list[str]) -> Array:
    """Return (F, 20): upright for 0.4 s, down until half time, where all is at rest for a moment, and up again."""
    ankle, knee, hip, trunk, arm = LOW[kind]
    low = {"human_ankle": ankle, "human_knee": knee, "human_hip": hip, "human_Q2": trunk}
    high = {}
    for side in ("right", "left"):
        for k in range(7):
            above = STRAIGHT if kind == "straight" else HIGH
            low[f"human_{side}_Q{k + 4}"], high[f"human_{side}_Q{k + 4}"] = arm[k], above[k]
    low |= {"human_Q3": 4.0, "human_right_Q5": low["human_right_Q5"] + 4.0, "human_left_Q7": arm[3] - 6.0}
    time = np.arange(FRAMES) / (FRAMES - 1.0)
    down = np.clip((time - 0.13) / 0.34, 0.0, 1.0)
    up = np.clip((time - 0.53) / 0.34, 0.0, 1.0)
    bent = _smooth(down) - _smooth(up)
    start = np.array([high.get(name, 0.0) for name in names])
    return np.radians(start + bent[:, None] * (np.array([low.get(name, 0.0) for name in names]) - start))


def _smooth(share: Array) -> Array:
    """Return a minimum-jerk course from 0 to 1."""
    return share**3 * (10.0 - 15.0 * share + 6.0 * share**2)


def _at_zero(lengths: WholeLengths) -> dict[str, dict[str, Array]]:
    """Return markers, in capitals, and joint centres of the upright person by the joint that moves them [m]."""
    c, s = np.cos(TILT), np.sin(TILT)
    tilt = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    hips, base = np.array([0.0, 0.0, lengths.hip]), np.array([lengths.ahead, 0.0, lengths.links.l1])
    spines = hips - tilt @ np.array([HIP[0], 0.0, HIP[2]])
    trunk = {"STER": (0.08, 0.0, 0.31), "C7": (-0.08, 0.0, 0.37), "XIPH": (0.09, 0.0, 0.13), "T8": (-0.09, 0.0, 0.19)}
    places: dict[str, dict[str, Any]] = {
        "feet": {}, "ankle": {}, "knee": {}, "hip": {}, "Q3": {name: base + at for name, at in trunk.items()},
    }  # fmt: skip
    breadth = lengths.links.l3 + lengths.left.l3
    for side, mark, out in SIDES:
        links = lengths.arms[side]
        leg = np.array([0.0, out * HIP[1], 0.0])
        ankle, knee, hip = (leg + _xyz(0.0, 0.0, z) for z in (lengths.ankle, lengths.knee, lengths.hip))
        places["feet"] |= {f"{mark}HEE": ankle + _xyz(-0.06, 0.0, -0.05), f"{mark}TOE": ankle + _xyz(0.14, 0.0, -0.05),
                           f"{mark}ANK": ankle + _xyz(0.0, out * ANKLE / 2, 0.0), f"{mark}Ankle": ankle,
                           f"{mark}ANM": ankle - _xyz(0.0, out * ANKLE / 2, 0.0)}  # fmt: skip
        places["ankle"] |= {f"{mark}TIB": knee + _xyz(0.06, out * 0.02, -0.2)}
        places["knee"] |= {f"{mark}KNE": knee + _xyz(0.0, out * KNEE / 2, 0.0), f"{mark}Knee": knee, f"{mark}Hip": hip,
                           f"{mark}KNM": knee - _xyz(0.0, out * KNEE / 2, 0.0),
                           f"{mark}THI": knee + _xyz(0.05, out * 0.05, 0.15)}  # fmt: skip
        places["hip"] |= {f"{mark}ASI": spines + tilt @ np.array([0.0, out * WIDTH / 2, 0.0]),
                          f"{mark}PSI": spines + tilt @ np.array([-DEPTH, out * 0.05, 0.0])}  # fmt: skip
        shoulder = base + _xyz(0.0, out * links.l3, links.l2)
        elbow = shoulder - _xyz(0.0, 0.0, links.l4)
        wrist = elbow - _xyz(0.0, 0.0, links.l5)
        hand = wrist - _xyz(0.0, 0.0, links.l6)
        places["Q3"] |= {f"{mark}SHO": shoulder + _xyz(0.0, 0.0, 0.17 * breadth), f"{mark}Shoulder": shoulder}
        places[f"{side}_Q6"] = {f"{mark}ELB": elbow + _xyz(0.0, out * ELBOW / 2, 0.0), f"{mark}Elbow": elbow,
                                f"{mark}ELM": elbow - _xyz(0.0, out * ELBOW / 2, 0.0),
                                f"{mark}UPA": shoulder + _xyz(0.05, out * 0.03, -0.12)}  # fmt: skip
        places[f"{side}_Q8"] = {f"{mark}WRR": wrist + _xyz(0.0, out * 0.03, 0.0), f"{mark}Wrist": wrist,
                                f"{mark}WRU": wrist - _xyz(0.0, out * 0.03, 0.0),
                                f"{mark}FRM": elbow + _xyz(0.03, out * 0.03, -0.12)}  # fmt: skip
        places[f"{side}_Q10"] = {f"{mark}MC2": hand + _xyz(0.0, out * 0.02, 0.0), f"{mark}Grasp": hand,
                                 f"{mark}MC5": hand - _xyz(0.0, out * 0.04, 0.0),
                                 f"{mark}HND": wrist + _xyz(-0.02, 0.0, -0.03)}  # fmt: skip
    return places


def _xyz(*point: float) -> Array:
    return np.array(point)
