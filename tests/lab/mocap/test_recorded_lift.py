"""A recorded lift from markers whose motion is known: the oracle is forward kinematics of the motion put in."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from liftopt.errors import InputError
from liftopt.lab.mocap.from_markers import recorded_lift
from liftopt.lab.mocap.hand_force import HandForce
from liftopt.lab.mocap.loads import Load
from liftopt.lab.mocap.recorded_file import load_recorded, save_recorded
from liftopt.lab.mocap.recorded_lift import RecordedLift
from liftopt.lab.mocap.recording import TO_Z_UP, ForcePlate, Recording, in_metres
from liftopt.multibody.urdf import load_model

CUTOFF = 20.0  # Hz; far above the lift's 1 Hz, so that the filter changes nothing that is tested
FORCE = np.array([-10.0, 4.0, 30.0])


@pytest.fixture(scope="module")
def recorded(truth: Any) -> RecordedLift:
    in_file = truth.turn @ FORCE
    time = truth.recording.time
    series = HandForce("series", time[[0, -1]], np.stack([in_file, in_file]))
    return recorded_lift(truth.recording, truth.mapping, Load(measured=series), CUTOFF)


def test_angles_are_those_that_moved_the_markers(truth: Any, recorded: RecordedLift) -> None:
    np.testing.assert_allclose(recorded.q[:, 3:], truth.q[:, 3:], atol=2e-4)
    travel = recorded.q[:, :3] - truth.q[:, :3]
    np.testing.assert_allclose(travel, np.broadcast_to(travel[0], travel.shape), atol=1e-5)
    assert recorded.residual_rms.max() < 2e-5


def test_measured_lengths_are_those_of_the_person(truth: Any, recorded: RecordedLift) -> None:
    for name in ("l1", "l2", "l3", "l4", "l5", "l6"):
        assert getattr(recorded.lengths, name) == pytest.approx(getattr(truth.lengths, name), abs=2e-5), name
    assert recorded.subject == truth.subject
    assert recorded.stature_estimated is False


def test_rates_are_those_of_the_motion(truth: Any, recorded: RecordedLift) -> None:
    """Central differences of the motion put in, away from its ends."""
    step = 1.0 / truth.recording.rate
    v = np.gradient(truth.q, step, axis=0)[5:-5]
    a = np.gradient(np.gradient(truth.q, step, axis=0), step, axis=0)[5:-5]
    assert np.abs(recorded.v[5:-5] - v).max() < 0.01 * np.abs(v).max()
    assert np.abs(recorded.a[5:-5] - a).max() < 0.02 * np.abs(a).max()


def test_torques_are_those_of_rnea_with_the_force_on_the_hand(recorded: RecordedLift) -> None:
    """Pinocchio's RNEA with the reaction as an external force on the last joint."""
    model = load_model(recorded.urdf)
    data = model.createData()
    last = model.njoints - 1
    for k in range(0, len(recorded.time), 40):
        pin.forwardKinematics(model, data, recorded.q[k])
        pin.updateFramePlacements(model, data)
        point = data.oMf[model.getFrameId("human_grasp")].translation
        np.testing.assert_allclose(recorded.hand_position[k], point, atol=1e-12)
        on_hand = pin.Force(-FORCE, np.cross(point, -FORCE))
        external = [pin.Force.Zero() for _ in range(model.njoints)]
        external[last] = data.oMi[last].actInv(on_hand)
        tau = pin.rnea(model, data, recorded.q[k], recorded.v[k], recorded.a[k], external)
        np.testing.assert_allclose(recorded.tau[k], tau, atol=1e-8)
    np.testing.assert_allclose(recorded.hand_force, np.broadcast_to(FORCE, recorded.hand_force.shape), atol=1e-6)


def test_the_ground_bears_body_and_load_at_rest(truth: Any, recorded: RecordedLift) -> None:
    weight = truth.subject.mass * 9.81
    np.testing.assert_allclose(recorded.ground_force[0], np.array([0.0, 0.0, weight]) + FORCE, atol=0.5)


def test_the_object_and_the_load_of_its_motion(truth: Any) -> None:
    """Newton: half of m (a - g), with the acceleration of the path that was put in."""
    lift = recorded_lift(truth.recording, truth.mapping, Load(mass=6.0, share=0.5), CUTOFF)
    assert lift.object_position is not None
    moved = lift.object_position - lift.object_position[0]
    np.testing.assert_allclose(moved, truth.box - truth.box[0], atol=2e-5)
    assert lift.carried is not None
    inside = (lift.time > lift.carried[0]) & (lift.time < lift.carried[1])
    a = np.gradient(np.gradient(truth.box, 0.01, axis=0), 0.01, axis=0)
    expected = 3.0 * (a - np.array([0.0, 0.0, -9.81]))
    assert np.abs(lift.hand_force[inside] - expected[inside]).max() < 0.5
    assert not lift.hand_force[lift.time < lift.carried[0]].any()
    off = np.linalg.norm(truth.box - truth.box[0], axis=1)
    first, last = np.flatnonzero(off > 0.005)[[0, -1]]
    assert lift.carried == (pytest.approx(lift.time[first], abs=0.011), pytest.approx(lift.time[last], abs=0.011))


@pytest.mark.parametrize("up", ["Y"])
def test_any_axis_may_point_up(truth: Any, recorded: RecordedLift, up: str) -> None:
    turned = replace(truth.recording, points=truth.recording.points @ TO_Z_UP[up], up=None)
    lift = recorded_lift(turned, truth.mapping.changed(up=up), None, CUTOFF)
    np.testing.assert_allclose(lift.q, recorded.q, atol=1e-6)


def test_gaps_change_little(truth: Any, recorded: RecordedLift) -> None:
    points = truth.recording.points.copy()
    points[50:55, truth.recording.index("ELBL")] = np.nan  # short: a spline
    points[80:120, truth.recording.index("ARM1")] = np.nan  # long: from the segment
    points[60:100, truth.recording.index("MC2")] = np.nan  # the hand has only three markers: left open
    lift = recorded_lift(replace(truth.recording, points=points), truth.mapping, None, CUTOFF)
    assert {gap.marker: gap.filled for gap in lift.gaps} == {"ELBL": "spline", "ARM1": "segment", "MC2": "open"}
    assert np.isnan(lift.residual[70, lift.markers.index("MC2")])
    np.testing.assert_allclose(lift.q[:, 3:10], recorded.q[:, 3:10], atol=5e-3)


def test_an_object_out_of_sight_is_left_out_unless_its_load_is_asked_for(truth: Any) -> None:
    points = truth.recording.points.copy()
    points[150:, truth.recording.index("B1")] = np.nan
    points[150:, truth.recording.index("B2")] = np.nan
    hidden = replace(truth.recording, points=points)
    lift = recorded_lift(hidden, truth.mapping, None, CUTOFF)
    assert lift.object_position is None
    assert any("fewer than 3 markers in 50 frames, first 150" in note for note in lift.notes)
    with pytest.raises(InputError, match="fewer than 3 markers in 50 frames"):
        recorded_lift(hidden, truth.mapping, Load(mass=6.0), CUTOFF)


def test_plates_are_reported_apart_and_push(truth: Any) -> None:
    samples = np.tile(truth.turn @ np.array([5.0, 0.0, -600.0]), (2000, 1))  # stated as the force on the plate
    plate = ForcePlate(1000.0, samples, 0.0 * samples, 0.0 * samples, np.zeros((4, 3)))
    lift = recorded_lift(replace(truth.recording, plates=(plate, plate)), truth.mapping, None, CUTOFF)
    assert lift.plate_force is not None
    np.testing.assert_allclose(lift.plate_force, np.tile([-10.0, 0.0, 1200.0], (200, 1)), atol=1e-9)


def test_what_is_saved_is_read_back(recorded: RecordedLift, tmp_path: Path) -> None:
    save_recorded(recorded, tmp_path)
    again = load_recorded(tmp_path)
    for name, value in vars(recorded).items():
        found = getattr(again, name)
        if isinstance(value, np.ndarray):
            np.testing.assert_array_equal(found, value)
        else:
            assert found == value, name
    assert (tmp_path / "models" / "human_recorded.urdf").read_text() == recorded.urdf
    assert recorded.over_lift(recorded.q).shape == (101, 13)


def test_joint_limits_are_respected(truth: Any) -> None:
    """Markers of an elbow bent backwards: the model's elbow stays at its limit."""
    lift = recorded_lift(_bent_back(truth), truth.mapping, None, CUTOFF)
    assert lift.q[:, 9].max() <= 0.0
    assert any("human_Q7 is at the limit" in note for note in lift.notes)


def _bent_back(truth: Any) -> Recording:
    """Return the recording with forearm and hand turned about the elbow's axis by 0.6 rad towards extension."""
    metres = in_metres(truth.recording, None, "Z")
    points = metres.points.copy()
    elbow = [metres.index("ELBL"), metres.index("ELBM")]
    axis = points[:, elbow[1]] - points[:, elbow[0]]
    axis /= np.linalg.norm(axis, axis=1)[:, None]
    centre = points[:, elbow].mean(axis=1)
    for label in truth.forearm_and_hand:
        r = points[:, metres.index(label)] - centre
        along = (r * axis).sum(axis=1)[:, None] * axis
        turned = along + np.cos(0.6) * (r - along) + np.sin(0.6) * np.cross(axis, r)
        points[:, metres.index(label)] = centre + turned
    return replace(metres, points=points)


def test_wrong_recordings_are_refused_with_the_reason(truth: Any) -> None:
    recording, mapping = truth.recording, truth.mapping

    def refused(match: str, recording: Recording = recording, **changes: object) -> None:
        with pytest.raises(InputError, match=match):
            recorded_lift(recording, mapping.changed(**changes), None, CUTOFF)

    refused("up = 'Y'.*says \"Z\"", up="Y")
    refused("'m': cannot be the unit of length.*units = \"mm\" would make it", replace(recording, units="m"))
    refused("'cm': cannot be the unit of length", replace(recording, units="cm"))
    refused("^units = 'cm': cannot be the unit of length", units="cm")
    refused("states no unit", replace(recording, units=None))
    refused("furlong", replace(recording, units="furlong"))
    without = [i for i, label in enumerate(recording.labels) if label not in ("STER", "MC5")]
    fewer = replace(recording, points=recording.points[:, without], labels=tuple(recording.labels[i] for i in without))
    refused("STER, MC5.*not in synthetic", fewer)
    mirrored = recording.points * np.array([-1.0, 1.0, 1.0])
    refused("swapped labels or left-handed", replace(recording, points=mirrored))
    refused("at least 12", replace(recording, points=recording.points[:8], time=recording.time[:8]))
    hidden = recording.points.copy()
    hidden[:, recording.index("XIPH")] = np.nan
    refused("XIPH: never seen", replace(recording, points=hidden))
    refused("never seen", replace(recording, points=np.full_like(hidden, np.nan)))
    apart = recording.points.copy()
    for label in ("RASI", "LASI", "RPSI", "LPSI"):
        apart[:100, recording.index(label)] = np.nan
    for label in ("STER", "XIPH", "C7", "T8"):
        apart[100:, recording.index(label)] = np.nan
    refused("trunk and pelvis are never seen in one frame", replace(recording, points=apart))
    refused("subject.mass", subject=mapping.subject.changed(mass=0.0))
    refused("subject.sex", subject=mapping.subject.changed(sex=""))
    with pytest.raises(InputError, match="cutoff = 60"):
        recorded_lift(recording, mapping, None, 60.0)
