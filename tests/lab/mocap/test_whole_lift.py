"""A recorded lift of a whole person from markers whose motion is known: forward kinematics of that motion."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from whole_markers import MAPPING, SUBJECT, WholeTruth, whole_truth

from liftopt.errors import InputError
from liftopt.lab.mocap.from_markers import recorded_lift
from liftopt.lab.mocap.hand_force import HandForce
from liftopt.lab.mocap.loads import Load
from liftopt.lab.mocap.map_file import load_marker_map
from liftopt.lab.mocap.recorded_file import load_recorded, save_recorded
from liftopt.lab.mocap.recorded_lift import RecordedLift
from liftopt.lab.mocap.recording import ForcePlate, Recording
from liftopt.lab.mocap.whole_map import WholeMap
from liftopt.multibody.person.stance import human_stance
from liftopt.multibody.urdf import load_model

CUTOFF = 20.0  # Hz; far above the lift's 1 Hz, so that the filter changes nothing that is tested
MASS = 6.0
MAP = WholeMap.checked(MAPPING)


@pytest.fixture(scope="module", params=["squat", "stoop"])
def lift(request: pytest.FixtureRequest) -> tuple[WholeTruth, RecordedLift]:
    truth = whole_truth(request.param)
    return truth, recorded_lift(truth.recording, MAP, Load(mass=MASS), CUTOFF)


@pytest.fixture(scope="module")
def squat() -> WholeTruth:
    return whole_truth("squat")


def test_angles_are_those_that_moved_the_markers(lift: tuple[WholeTruth, RecordedLift]) -> None:
    truth, found = lift
    assert found.body == "whole"
    assert found.joint_names[:4] == ("human_ankle", "human_knee", "human_hip", "human_Q1")
    assert found.joint_names[-1] == "human_left_Q10"
    np.testing.assert_allclose(np.degrees(found.q), np.degrees(truth.q), atol=0.15)
    legs = slice(0, 3)
    np.testing.assert_allclose(np.degrees(found.q[:, legs]), np.degrees(truth.q[:, legs]), atol=0.15)
    assert np.nanmax(found.residual) < 1.5e-3


def test_lengths_are_those_of_the_person(lift: tuple[WholeTruth, RecordedLift]) -> None:
    truth, found = lift
    assert found.whole is not None
    for name in ("l1", "l2", "l3", "l4", "l5", "l6"):
        assert getattr(found.lengths, name) == pytest.approx(getattr(truth.lengths.links, name), abs=1e-4), name
        assert getattr(found.whole.left, name) == pytest.approx(getattr(truth.lengths.left, name), abs=1e-4), name
    for name in ("ankle", "knee", "hip", "ahead"):
        assert getattr(found.whole, name) == pytest.approx(getattr(truth.lengths, name), abs=5e-4), name


def test_rates_are_those_of_the_motion(lift: tuple[WholeTruth, RecordedLift]) -> None:
    """Central differences of the motion put in, away from its ends.

    In a stoop the arm passes the direction in which abduction and turn of the shoulder are one motion: of these two
    only the difference counts there.
    """
    truth, found = lift
    v = np.gradient(truth.q, 0.01, axis=0)
    a = np.gradient(v, 0.01, axis=0)
    off = found.a - a
    for side in ("right", "left"):
        one, other = (found.joint_names.index(f"human_{side}_{joint}") for joint in ("Q4", "Q6"))
        off[:, one] = off[:, other] = off[:, one] - off[:, other]
    assert np.abs(found.v - v)[5:-5].max() < 0.02 * np.abs(v).max()
    assert np.abs(off[5:-5]).max() < 0.06 * np.abs(a).max()


def test_torques_are_those_of_rnea_with_the_forces_on_both_hands(lift: tuple[WholeTruth, RecordedLift]) -> None:
    """Pinocchio's RNEA with the reactions as external forces on the two last joints."""
    _, found = lift
    assert found.whole is not None
    model = load_model(found.urdf)
    data = model.createData()
    for k in range(0, len(found.time), 60):
        pin.framesForwardKinematics(model, data, found.q[k])
        external = [pin.Force.Zero() for _ in range(model.njoints)]
        for hand, side in enumerate(("right", "left")):
            frame = model.frames[model.getFrameId(f"human_{side}_grasp")]
            point = data.oMf[model.getFrameId(f"human_{side}_grasp")].translation
            np.testing.assert_allclose(found.whole.grasp_position[k, hand], point, atol=1e-12)
            force = -found.whole.grasp_force[k, hand]
            external[frame.parentJoint] = data.oMi[frame.parentJoint].actInv(pin.Force(force, np.cross(point, force)))
        tau = pin.rnea(model, data, found.q[k], found.v[k], found.a[k], external)
        np.testing.assert_allclose(found.tau[k], tau, atol=1e-8)


def test_hands_share_the_force_of_the_objects_motion(lift: tuple[WholeTruth, RecordedLift]) -> None:
    """Newton: m (a - g) with the acceleration of the path that was put in, half of it on each hand."""
    truth, found = lift
    assert found.whole is not None
    assert found.carried is not None
    inside = (found.time > found.carried[0] + 0.05) & (found.time < found.carried[1] - 0.05)
    a = np.gradient(np.gradient(truth.box, 0.01, axis=0), 0.01, axis=0)
    expected = MASS * (a - np.array([0.0, 0.0, -9.81]))
    assert np.abs(found.hand_force[inside] - expected[inside]).max() < 0.5
    np.testing.assert_allclose(found.whole.grasp_force[:, 0], found.whole.grasp_force[:, 1], atol=1e-12)
    assert "right hand estimated: 50% of the force" in found.force_from
    assert "motion does not show how two hands share" in found.force_from


def test_at_rest_the_ground_bears_the_weight_under_the_centre_of_mass(squat: WholeTruth) -> None:
    """Statics: the sum of weights, below their common centre, the feet of the subject with it."""
    found = recorded_lift(squat.recording, MAP, None, CUTOFF)
    assert found.whole is not None
    model = load_model(found.urdf)
    centre = pin.centerOfMass(model, model.createData(), found.q[0])
    moving = pin.computeTotalMass(model)
    feet = human_stance(SUBJECT)
    assert moving + feet.mass == pytest.approx(SUBJECT.mass, abs=1e-3)
    np.testing.assert_allclose(found.ground_force[0], [0.0, 0.0, 9.81 * SUBJECT.mass], atol=0.5)
    ahead = (moving * centre[0] + feet.mass * feet.p_base_com[0]) / (moving + feet.mass)
    assert found.whole.centre_of_pressure[0, 0] == pytest.approx(ahead, abs=2e-3)


def test_with_noise_and_soft_skin_joints_stay_within_a_few_degrees(lift: tuple[WholeTruth, RecordedLift]) -> None:
    """Noise of 1 mm and markers that slide over the bone by up to 8 mm as the knee bends, each its own way."""
    truth, _ = lift
    noise = np.random.default_rng(1)
    points = truth.recording.points + noise.normal(0.0, 1.0, truth.recording.points.shape)
    bent = truth.q[:, 1] / truth.q[:, 1].max()
    points += 8.0 * bent[:, None, None] * noise.uniform(-0.577, 0.577, (1, points.shape[1], 3))
    found = recorded_lift(replace(truth.recording, points=points), MAP, None, 6.0)
    off = np.degrees(np.sqrt(np.mean((found.q - truth.q) ** 2, axis=0)))
    named = dict(zip(found.joint_names, off, strict=True))
    assert max(named[f"human_{joint}"] for joint in ("ankle", "knee", "hip", "Q1", "Q2", "Q3")) < 2.5
    assert max(named[f"human_{side}_Q{k}"] for side in ("right", "left") for k in (5, 7, 9, 10)) < 4.0


@pytest.mark.parametrize("kind", ["squat", "stoop"])
def test_plug_in_gait_has_half_the_markers(kind: str) -> None:
    """The same motion by 26 markers: none on the inner side of a joint, one on the hand, two on the forearm."""
    truth = whole_truth(kind)
    names = {"CLAV": "STER", "STRN": "XIPH", "T10": "T8", "C7": "C7"}
    for s in "RL":
        own = {"ASI": "ASI", "PSI": "PSI", "KNE": "KNE", "ANK": "ANK", "HEE": "HEE", "TOE": "TOE", "SHO": "SHO"}
        own |= {"ELB": "ELB", "WRA": "WRR", "WRB": "WRU", "FIN": "MC2", "UPA": "UPA"}
        names |= {s + label: s + of for label, of in own.items()}
    recording = truth.with_labels(*names.values())
    recording = replace(recording, labels=(*names, "B1", "B2", "B3", "B4"))
    mapping = load_marker_map("plug_in_gait")
    subject = mapping.subject.changed(sex="female", mass=SUBJECT.mass, stature=SUBJECT.stature)
    found = recorded_lift(recording, mapping.changed(subject=subject), None, CUTOFF)
    off = np.degrees(np.abs(found.q - truth.q).max(axis=0))
    named = dict(zip(found.joint_names, off, strict=True))
    assert max(named[f"human_{joint}"] for joint in ("ankle", "knee", "hip", "Q1", "Q2", "Q3")) < 1.5
    assert max(named[f"human_{side}_{joint}"] for side in ("right", "left") for joint in ("Q5", "Q7", "Q9")) < 6.0
    assert any("the recording lacks" in note and "RTHI" in note for note in found.notes)
    assert any(note.startswith("knee, ankle, elbow: a marker on the outer side only") for note in found.notes)


def test_arms_that_never_bend_show_no_axis_of_the_elbow() -> None:
    """A marker on the outer side only: its centre is inwards of it along the trunk's left, and the elbow straight."""
    truth = whole_truth("straight")
    names = {"CLAV": "STER", "STRN": "XIPH", "T10": "T8", "C7": "C7"}
    pairs = {"WRA": "WRR", "WRB": "WRU", "FIN": "MC2"}
    same = ("ASI", "PSI", "KNE", "ANK", "HEE", "TOE", "SHO", "ELB")
    names |= {s + label: s + pairs.get(label, label) for s in "RL" for label in (*same, *pairs)}
    recording = replace(truth.with_labels(*names.values()), labels=(*names, "B1", "B2", "B3", "B4"))
    mapping = load_marker_map("plug_in_gait")
    subject = mapping.subject.changed(sex="female", mass=SUBJECT.mass, stature=SUBJECT.stature)
    found = recorded_lift(recording, mapping.changed(subject=subject), None, CUTOFF)
    assert found.lengths.l4 == pytest.approx(truth.lengths.links.l4, abs=0.005)
    for side in ("right", "left"):
        assert np.abs(np.degrees(found.q[:, found.joint_names.index(f"human_{side}_Q7")])).max() < 15.0


def test_video_gives_joint_centres_only(squat: WholeTruth) -> None:
    labels = [s + name for s in "RL" for name in ("Hip", "Knee", "Ankle", "Shoulder", "Elbow", "Wrist")]
    recording = squat.with_labels(*labels)
    feet = squat.with_labels("RHEE", "LHEE", "RTOE", "LTOE")
    points = np.concatenate([recording.points[:, :-4], feet.points[:, :-4]], axis=1)
    recording = replace(recording, labels=(*labels, "RHeel", "LHeel", "RBigToe", "LBigToe"), points=points)
    mapping = load_marker_map("pose2sim")
    subject = mapping.subject.changed(sex="female", mass=SUBJECT.mass, stature=SUBJECT.stature)
    found = recorded_lift(recording, mapping.changed(subject=subject, up="Z"), None, CUTOFF)
    off = np.degrees(np.abs(found.q - squat.q).max(axis=0))
    named = dict(zip(found.joint_names, off, strict=True))
    assert max(named["human_ankle"], named["human_knee"]) < 0.5
    assert max(named[f"human_{side}_Q7"] for side in ("right", "left")) < 1.5
    held = [note for note in found.notes if note.startswith("no marker shows human_")]
    assert len(held) == 7  # Q2, and Q8 to Q10 of both arms
    at = found.joint_names.index("human_Q2")
    assert not found.q[:, at].any()
    # Pelvis and trunk as one are inclined as the line from the hips to the shoulders.
    legs = [found.joint_names.index(f"human_{joint}") for joint in ("ankle", "knee", "hip")]
    line = sum(squat.points[s + "Shoulder"] - squat.points[s + "Hip"] for s in "RL")
    inclined = np.degrees(np.arctan2(line[:, 0], line[:, 2]))
    np.testing.assert_allclose(np.degrees(found.q[:, legs] @ [1.0, -1.0, 1.0]), inclined, atol=1.0)


def test_what_legs_as_one_do_not_show_is_told(squat: WholeTruth) -> None:
    """The left foot 6 cm ahead of the right one and its knee with it, both 2 cm farther out; hips to the left."""
    recording, points = squat.recording, squat.recording.points.copy()
    ahead, left = squat.turn @ np.array([1.0, 0.0, 0.0]), squat.turn @ np.array([0.0, 1.0, 0.0])
    for label in ("LKNE", "LKNM", "LANK", "LANM", "LHEE", "LTOE", "LTIB", "LTHI"):
        points[:, recording.index(label)] += 60.0 * ahead + 20.0 * left
    for label in ("RKNE", "RKNM", "RANK", "RANM", "RHEE", "RTOE", "RTIB", "RTHI"):
        points[:, recording.index(label)] -= 20.0 * left
    found = recorded_lift(replace(recording, points=points), MAP, None, CUTOFF)
    legs = next(note for note in found.notes if note.startswith("both legs are followed as one"))
    assert "the left foot stands 6.0 cm ahead of the other" in legs
    assert "cm apart sideways" in legs
    assert any(note.startswith("the feet are taken to stand") for note in found.notes)


def test_a_step_is_refused_with_its_time(squat: WholeTruth) -> None:
    recording, points = squat.recording, squat.recording.points.copy()
    ahead = squat.turn @ np.array([1.0, 0.0, 0.0])
    share = np.clip((recording.time - 2.4) / 0.3, 0.0, 1.0)[:, None]
    for label in ("LANK", "LANM", "LHEE", "LTOE", "LTIB", "LKNE", "LKNM", "LTHI"):
        points[:, recording.index(label)] += 250.0 * share * ahead
    stepping = replace(recording, points=points)
    with pytest.raises(InputError, match=r"0\.25 m.*the left foot is.*2\.5\d to 2\.99 s.*--from and --to"):
        recorded_lift(stepping, MAP, None, CUTOFF)


def test_plates_are_summed_with_their_common_centre_of_pressure(squat: WholeTruth) -> None:
    """Statics of two forces: 200 N and 400 N, 0.3 m apart."""
    count = len(squat.recording.time) * 10
    turn, shift = squat.turn, np.array([0.8, -0.3, 0.25])

    def plate(newton: float, y: float) -> ForcePlate:
        force = np.tile([0.0, 0.0, -newton], (count, 1))
        centre = np.tile(turn @ np.array([0.05, y, 0.0]) + shift, (count, 1))
        return ForcePlate(1000.0, force, 0.0 * force, centre, np.zeros((4, 3)))

    found = recorded_lift(replace(squat.recording, plates=(plate(200.0, -0.15), plate(400.0, 0.15))), MAP, None, CUTOFF)
    assert found.whole is not None
    assert found.plate_force is not None
    assert found.whole.plate_centre is not None
    np.testing.assert_allclose(found.plate_force[:, 2], 600.0, atol=1e-9)
    np.testing.assert_allclose(found.whole.plate_centre[:, :2], np.tile([0.05, 0.05], (300, 1)), atol=2e-3)


def test_the_hand_without_a_series_bears_what_is_left(squat: WholeTruth) -> None:
    in_file = squat.turn @ np.array([0.0, 0.0, 20.0])
    series = HandForce("series", squat.recording.time[[0, -1]], np.stack([in_file, in_file]))
    found = recorded_lift(squat.recording, MAP, Load(measured=series, mass=MASS), CUTOFF)
    assert found.whole is not None
    k = int(np.searchsorted(found.time, 2.0))
    np.testing.assert_allclose(found.whole.grasp_force[k, 0], [0.0, 0.0, 20.0], atol=1e-6)
    both = recorded_lift(squat.recording, MAP, Load(mass=MASS), CUTOFF)
    np.testing.assert_allclose(found.hand_force[k], both.hand_force[k], atol=1e-6)
    assert "left hand estimated: what the other hand leaves" in found.force_from
    given = recorded_lift(squat.recording, MAP, Load(mass=MASS, share=0.3, left_share=0.2), CUTOFF)
    np.testing.assert_allclose(given.hand_force[k], 0.5 * both.hand_force[k], atol=1e-9)


def test_swapped_and_lost_markers_are_named_and_change_little(lift: tuple[WholeTruth, RecordedLift]) -> None:
    truth, clean = lift
    recording, points = truth.recording, truth.recording.points.copy()
    right, left = recording.index("RASI"), recording.index("LASI")
    points[100:120, [right, left]] = points[100:120, [left, right]]
    points[200:204, recording.index("LKNE")] += np.array([0.0, 0.0, 300.0])
    points[140:180, recording.index("RUPA")] = np.nan
    points[100:140, recording.index("RHEE")] += 200.0  # two markers are on a foot, which stands
    found = recorded_lift(replace(recording, points=points), MAP, Load(mass=MASS), CUTOFF)
    for label in ("RASI", "LASI", "LKNE", "RHEE"):
        assert any(note.startswith(f"{label} leaves the shape") for note in found.notes), label
    np.testing.assert_allclose(np.degrees(found.q), np.degrees(clean.q), atol=1.5)


def test_what_is_saved_is_read_back(lift: tuple[WholeTruth, RecordedLift], tmp_path: Path) -> None:
    _, found = lift
    save_recorded(found, tmp_path)
    again = load_recorded(tmp_path)
    _same(found, again)
    _same(found.whole, again.whole)
    assert again.over_lift(again.q).shape == (101, 20)


def _same(one: Any, other: Any) -> None:
    for name, value in vars(one).items():
        found = getattr(other, name)
        if isinstance(value, np.ndarray):
            np.testing.assert_array_equal(found, value, err_msg=name)
        elif name != "whole":
            assert found == value, name


def test_wrong_recordings_are_refused_with_the_reason(squat: WholeTruth) -> None:
    recording = squat.recording

    def refused(match: str, recording: Recording = recording, **changes: object) -> None:
        with pytest.raises(InputError, match=match):
            recorded_lift(recording, MAP.changed(**changes), None, CUTOFF)

    refused("up = 'Y'.*says \"Z\"", up="Y")
    mirrored = recording.points * np.array([-1.0, 1.0, 1.0])
    refused("swapped labels or left-handed", replace(recording, points=mirrored))
    hidden = recording.points.copy()
    hidden[:, recording.index("RANK")] = np.nan
    refused("the shank is never seen", replace(recording, points=hidden))
    refused("subject.mass", subject=MAP.subject.changed(mass=0.0))
    without = [i for i, label in enumerate(recording.labels) if label != "STER"]
    fewer = replace(recording, points=recording.points[:, without], labels=tuple(recording.labels[i] for i in without))
    refused("STER.*not in synthetic", fewer)
