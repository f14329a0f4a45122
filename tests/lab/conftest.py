"""A person whose motion is known, and the markers that a laboratory would have recorded of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from liftopt.lab.mocap.marker_map import MarkerMap
from liftopt.lab.mocap.recorded_lift import RecordedLift, RecordedWhole
from liftopt.lab.mocap.recording import Recording
from liftopt.multibody.dh import human_rows
from liftopt.multibody.person.anthropometry import LinkLengths, link_lengths
from liftopt.multibody.person.human import human_chain, human_root
from liftopt.multibody.person.segments import SEGMENTS
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.person.whole_body import WholeLengths
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.multibody.urdf import FixedLink, JointBounds, chain_robot, load_model, urdf_text
from liftopt.solution.interpolation import resample
from liftopt.solution.solution import Solution
from liftopt.types import Array

RATE = 100.0
STANDING = 0.4  # s before and after a lift made up
HEADING = np.radians(200.0)
SHIFT = np.array([0.8, -0.3, 0.25])
SUBJECT = Subject(1.7, 65.0, "female")
# In the person's upright zero pose: forward, left, up from the base of the spine, shoulder, elbow or wrist [m].
TRUNK = {"STER": (0.08, 0.0, 0.30), "C7": (-0.08, 0.0, 0.36), "XIPH": (0.09, 0.0, 0.12), "T8": (-0.09, 0.0, 0.18)}
UPPER_ARM = {"ARM1": (0.05, 0.0, -0.1), "ARM2": (0.0, -0.06, -0.15)}
FOREARM = {"FORE1": (0.04, 0.01, -0.08), "FORE2": (0.0, -0.04, -0.12)}
HAND = {"HAND1": (-0.02, 0.0, -0.03)}
BOX = {"B1": (0.1, 0.2, 0.0), "B2": (0.1, -0.2, 0.0), "B3": (-0.1, 0.2, 0.1), "B4": (-0.1, -0.2, 0.1)}


MAPPING: dict[str, Any] = {
    "schema": 1,
    "up": "Z",
    "subject": {"sex": "female", "mass": SUBJECT.mass, "stature": SUBJECT.stature},
    "landmarks": {
        "asis_right": "RASI", "asis_left": "LASI", "psis_right": "RPSI", "psis_left": "LPSI",
        "suprasternale": "STER", "xiphoid": "XIPH", "c7": "C7", "t8": "T8", "acromion_right": "ACRO",
        "elbow_lateral": "ELBL", "elbow_medial": "ELBM", "wrist_radial": "WRSR", "wrist_ulnar": "WRSU",
        "knuckle_index": "MC2", "knuckle_little": "MC5",
    },
    "segments": {
        "upper_arm": list(UPPER_ARM), "forearm": list(FOREARM), "hand": list(HAND), "object": list(BOX),
    },
}  # fmt: skip


@dataclass(frozen=True)
class Lift:
    """A recording and what is true of it.

    Attributes:
        recording: in mm, Z up, turned and shifted against the world.
        mapping: of its markers.
        mapping_dict: the same as a TOML file would give it.
        subject: the person.
        q: (F, 13).
        lengths: L1 to L6.
        box: (F, 3) the object's path in the world [m].
        turn: (3, 3) R_recording_world.
        forearm_and_hand: markers below the elbow.
    """

    recording: Recording
    mapping: MarkerMap
    mapping_dict: dict[str, Any]
    subject: Subject
    q: Array
    lengths: LinkLengths
    box: Array
    turn: Array
    forearm_and_hand: tuple[str, ...]


@pytest.fixture(scope="session")
def truth() -> Lift:
    """Return a slow lift of two seconds at 100 Hz."""
    frames = 200
    lengths = replace(link_lengths(SUBJECT), l2=0.31, l3=0.17, l4=0.28, l5=0.25, l6=0.07)
    model = _model(lengths)
    time = np.arange(frames) / RATE
    phase = np.sin(np.pi * np.clip((time - 0.3) / (time[-1] - 0.6), 0.0, 1.0)) ** 4
    swing = np.array([0.02, 0.01, -0.05, 0.05, 0.3, 0.1, -0.3, 0.8, -0.4, -1.2, 0.4, 0.3, 0.2])
    q = np.array([0, 0, 0, 0, 0, 0, -0.1, 0.1, -0.1, -0.4, -1.2, 0.1, 0.0]) + phase[:, None] * swing
    # The upper arm turns about every axis, or its centre could not be told from its motion.
    q[:, 8] += 0.5 * np.sin(2.0 * np.pi * time / time[-1]) ** 3
    places = _zero_pose(lengths)
    data, zero = model.createData(), model.createData()
    pin.forwardKinematics(model, zero, np.zeros(13))
    rows = {"pelvis": "GT3", "trunk": "Q3", "upper_arm": "Q6", "forearm": "Q8", "hand": "Q10"}
    joints = {name: model.getJointId(f"human_{row}") for name, row in rows.items()}
    points = []
    for pose in q:
        pin.forwardKinematics(model, data, pose)
        seen = [
            data.oMi[joints[s]].act(zero.oMi[joints[s]].actInv(at))
            for s, group in places.items()
            for at in group.values()
        ]
        points.append(seen)
    box = np.array([0.5, 0.0, 1.0]) + phase[:, None] * np.array([-0.1, 0.05, 0.4])
    labels = [label for group in places.values() for label in group] + list(BOX)
    world = np.concatenate([np.array(points), box[:, None] + np.array(list(BOX.values()))], axis=1)
    c, s = np.cos(HEADING), np.sin(HEADING)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    recorded = 1000.0 * (world @ turn.T + SHIFT)
    return Lift(
        recording=Recording("synthetic", RATE, time, tuple(labels), recorded, "mm", "Z"),
        mapping=MarkerMap.checked(MAPPING),
        mapping_dict=MAPPING,
        subject=SUBJECT,
        q=q,
        lengths=lengths,
        box=box,
        turn=turn,
        forearm_and_hand=tuple(label for name in ("forearm", "hand") for label in places[name]),
    )


@pytest.fixture(scope="session")
def as_recorded() -> Callable[..., RecordedLift]:
    """Return a function that makes a record of a predicted motion, with known differences."""
    return _as_recorded


@pytest.fixture(scope="session")
def box_lift() -> Path:
    """Return the folder of a real recorded box lift, beside the repository; skip where it is not."""
    folder = Path(__file__).parents[3] / "shared" / "data" / "box_lift"
    if not folder.is_dir():
        pytest.skip("the recorded box lift (test data of pyomeca) is not beside the repository")
    return folder


def _as_recorded(solution: Solution, late: float = 0.0, scale: float = 1.0, raised: float = 0.0) -> RecordedLift:
    """Return a record of the predicted motion: late by a share of the lift, values scaled, angles raised."""
    dense = resample(solution, 10)
    human, lifted = dense.agents[0], dense.object
    elbow = human.joint_names.index("human_right_Q7" if human.stance else "human_Q7")
    duration = float(dense.time[-1])
    time = np.arange(round((duration + 2 * STANDING) * 200) + 1) / 200

    def over(values: Array) -> Array:
        flat = values.reshape(len(dense.time), -1)
        at = time - STANDING - late * duration
        return np.stack([np.interp(at, dense.time, column) for column in flat.T], axis=1)

    person, none = solution.scenario.first("person"), np.zeros((len(time), 3))
    subject = Subject(person.stature, person.mass, "male" if person.sex == "male" else "female")
    return RecordedLift(
        source="made up",
        rate=200.0,
        cutoff=6.0,
        subject=subject,
        stature_estimated=False,
        stature_by={},
        lengths=link_lengths(subject),
        urdf=solution.urdfs["human"],
        joint_names=human.joint_names,
        time=time,
        q=scale * over(human.q) + raised * human.moving,
        v=over(human.v),
        a=over(human.a),
        tau=scale * over(human.tau),
        hand_position=over(human.p_world_hold),
        hand_force=scale * over(human.load),
        force_from="measured: made up",
        ground_force=scale * over(human.ground_force) if human.stance else none,
        ground_moment=none,
        plate_force=None,
        markers=(),
        residual=np.zeros((len(time), 0)),
        elbow_flexion=-over(human.q[:, [elbow]])[:, 0],
        object_position=over(lifted.pose[:, :3]),
        object_quaternion=over(lifted.quaternion),
        carried=(STANDING, STANDING + duration),
        gaps=(),
        notes=(),
        whole=_whole(human, over, subject, scale) if human.stance else None,
    )


def _whole(human: AgentTrajectory, over: Callable[[Array], Array], subject: Subject, scale: float) -> RecordedWhole:
    lengths, pressure = WholeLengths.of(subject), human.centre_of_pressure
    assert pressure is not None
    knee = over(human.q[:, [human.joint_names.index("human_knee")]])
    elbows = [human.joint_names.index(f"human_{side}_Q7") for side in ("right", "left")]
    shape = (len(knee), 2, 3)
    return RecordedWhole(
        grasp_position=over(human.grasp_position).reshape(shape),
        grasp_force=scale * over(human.grasp_force).reshape(shape),
        centre_of_pressure=over(pressure),
        plate_centre=None,
        elbow_flexion=-over(human.q[:, elbows]),
        knee_flexion=np.hstack([knee, knee]),
        left=lengths.left,
        ankle=lengths.ankle,
        knee=lengths.knee,
        hip=lengths.hip,
        ahead=lengths.ahead,
    )


def _zero_pose(lengths: LinkLengths) -> dict[str, dict[str, Array]]:
    base = np.array([0.0, 0.0, lengths.l1])
    shoulder = base + np.array([0.0, -lengths.l3, lengths.l2])
    elbow = shoulder - np.array([0.0, 0.0, lengths.l4])
    wrist = elbow - np.array([0.0, 0.0, lengths.l5])
    breadth = 0.24
    # Where the lower trunk of de Leva and the hip centres of Bell et al. put the front spines of the pelvis.
    below = 0.3 * breadth - SEGMENTS["female"]["lower_trunk"].length * SUBJECT.stature
    pelvis = {
        "RASI": (0.1, -breadth / 2, below), "LASI": (0.1, breadth / 2, below),
        "RPSI": (-0.1, -0.05, below + 0.02), "LPSI": (-0.1, 0.05, below + 0.02),
    }  # fmt: skip
    index, little = np.array([0.0, -0.02, -lengths.l6]), np.array([0.0, 0.04, -lengths.l6])
    groups: dict[str, tuple[Array, dict[str, Any]]] = {
        "pelvis": (base, pelvis),
        "trunk": (base, TRUNK | {"ACRO": (0.0, -lengths.l3, lengths.l2 + 0.05)}),
        "upper_arm": (shoulder, {"ELBL": (0, -0.04, -lengths.l4), "ELBM": (0, 0.04, -lengths.l4)} | UPPER_ARM),
        "forearm": (elbow, {"WRSR": (0, -0.03, -lengths.l5), "WRSU": (0, 0.03, -lengths.l5)} | FOREARM),
        "hand": (wrist, {"MC2": index, "MC5": little} | HAND),
    }
    return {name: {m: at + np.asarray(p, float) for m, p in group.items()} for name, (at, group) in groups.items()}


def _model(lengths: LinkLengths) -> pin.Model:
    chain = human_chain(SUBJECT)
    chain = replace(chain, rows=human_rows(*vars(lengths).values()))
    free = {row.name: JointBounds(-4.0, 4.0, 1e5, 10.0) for row in chain.rows}
    root = FixedLink("human_base", "world", human_root())
    return load_model(urdf_text(chain_robot(chain, root=root, bounds=free, shapes={}, grasp="human_grasp")))
