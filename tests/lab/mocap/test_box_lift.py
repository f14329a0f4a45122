"""The real recorded box lift (pyomeca's test data): what was found in it, and what another tool found."""

from __future__ import annotations

import hashlib
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from liftopt.lab.mocap.from_markers import read_recording, recorded_lift
from liftopt.lab.mocap.loads import Load
from liftopt.lab.mocap.map_file import load_marker_map
from liftopt.lab.mocap.motion_table import read_motion_table
from liftopt.lab.mocap.recorded_lift import RecordedLift
from liftopt.lab.mocap.recorded_scenario import recorded_scenario
from liftopt.multibody.person.human import human_agent
from liftopt.multibody.solid_pairs import solid_pairs
from liftopt.scenario.build import object_of
from liftopt.scenario.model import load_scenario


@pytest.fixture(scope="module")
def recorded(box_lift: Path) -> RecordedLift:
    path = box_lift / "markers_analogs.c3d"
    before = hashlib.sha256(path.read_bytes()).hexdigest()
    mapping = load_marker_map("box_lift")
    lift = recorded_lift(
        read_recording(path), mapping.changed(subject=mapping.subject.changed(mass=60.0)), Load(mass=6.0)
    )
    assert hashlib.sha256(path.read_bytes()).hexdigest() == before
    return lift


def test_the_markers_are_followed(recorded: RecordedLift) -> None:
    assert recorded.q.shape == (580, 13)
    assert np.sqrt(np.nanmean(recorded.residual**2)) < 0.011
    assert recorded.residual_rms.max() < 0.018
    assert np.nanmax(recorded.residual) < 0.026


def test_all_gaps_are_found_and_filled(recorded: RecordedLift) -> None:
    """The file marks 210 points of mapped markers by a residual of -1: counted in the file itself."""
    assert sum(gap.last - gap.first + 1 for gap in recorded.gaps) == 210
    assert {gap.filled for gap in recorded.gaps} == {"spline", "segment"}
    assert np.isfinite(recorded.residual).all()


def test_the_subject(recorded: RecordedLift) -> None:
    """Lengths measured between landmarks by hand in the file; the stature is an estimate."""
    assert recorded.lengths.l5 == pytest.approx(0.262, abs=0.003)
    assert recorded.lengths.l4 == pytest.approx(0.289, abs=0.005)
    assert recorded.stature_estimated
    assert 1.5 < recorded.subject.stature < 1.85
    assert len(recorded.stature_by) == 3


def test_the_arm_is_never_in_the_body(recorded: RecordedLift, coal_distance: ModuleType) -> None:
    """A person cannot do that: where the recorded angles did, the collision shapes would be too large."""
    agent = human_agent(recorded.subject)
    pairs = solid_pairs([agent], object_of(load_scenario()))
    nearest = [min(coal_distance.own_distances(agent, pairs, q[3:]).values()) for q in recorded.q[::20]]
    assert min(nearest) > 0.01


def test_limits_hold_and_torques_are_those_of_a_person(recorded: RecordedLift) -> None:
    assert recorded.q[:, 9].max() <= 0.0
    assert any("human_Q10 is at the limit" in note for note in recorded.notes)
    elbow, trunk = np.abs(recorded.tau[:, 9]).max(), np.abs(recorded.tau[:, 4]).max()
    assert 3.0 < elbow < 15.0
    assert trunk < 60.0


def test_the_object_is_lifted_where_the_file_has_it(recorded: RecordedLift) -> None:
    """Heights of the box's upper markers in the file; its load cell rises and falls at 1.65 and 3.95 s."""
    assert recorded.object_position is not None
    rise = recorded.object_position[:, 2] - recorded.object_position[0, 2]
    assert rise.max() == pytest.approx(0.335, abs=0.02)
    assert rise[-1] == pytest.approx(0.228, abs=0.01)
    assert recorded.carried == (pytest.approx(1.65, abs=0.1), pytest.approx(3.75, abs=0.15))


def test_its_scenario(recorded: RecordedLift) -> None:
    """Where the box's markers start and end in the file, and half a metre between its two hands."""
    scenario = recorded_scenario(recorded, 6.0)
    start, end = scenario.task.start, scenario.task.end
    assert end.height - start.height == pytest.approx(0.23, abs=0.02)
    assert scenario.duration == pytest.approx(2.1, abs=0.1)
    assert 0.4 < scenario.object.depth < 0.7
    assert 0.4 < (end.human_distance or 0.0) < (start.human_distance or 0.0) < 0.7
    assert (scenario.first("person").sex, scenario.first("person").mass) == ("female", 60.0)


def test_another_tool_worked_on_this_trial(box_lift: Path) -> None:
    """The angle of acromion, elbow and wrist follows OpenSim's elbow best at the very times that ik.mot states."""
    recording, table = read_recording(box_lift / "markers_analogs.c3d"), read_motion_table(box_lift / "ik.mot")
    assert (table.in_degrees, table.notes) == (True, ("the header says nrows 250, the file holds 88",))
    places = [("ACRO_tip",), ("EPICl", "EPICm"), ("STYLr", "STYLu")]
    shoulder, elbow, wrist = (
        np.mean([recording.points[:, recording.index(label)] for label in labels], axis=0) for labels in places
    )
    upper, fore = elbow - shoulder, wrist - elbow
    cosine = (upper * fore).sum(axis=1) / np.linalg.norm(upper, axis=1) / np.linalg.norm(fore, axis=1)
    angle, other = np.degrees(np.arccos(cosine)), table.column("elbow_flexion")
    stated = round(table.time[0] * recording.rate)
    apart = {k: np.sqrt(np.nanmean((angle[k : k + len(other)] - other) ** 2)) for k in range(stated - 50, stated + 50)}
    assert min(apart, key=lambda k: apart[k]) == stated
    assert apart[stated] < 1.7


def test_elbow_flexion_of_another_tool(recorded: RecordedLift, box_lift: Path) -> None:
    """OpenSim's model has a clavicle, so compare the markers' own angle; its zero is another, the course the same."""
    table = read_motion_table(box_lift / "ik.mot")
    other = table.column("elbow_flexion")
    ours = np.interp(table.time, recorded.time, np.degrees(recorded.elbow_flexion))
    assert np.corrcoef(ours, other)[0, 1] > 0.995
    assert np.sqrt(np.mean((ours - other) ** 2)) < 8.0


def test_moments_of_another_tool_are_read(box_lift: Path) -> None:
    table = read_motion_table(box_lift / "id.sto")
    assert (table.in_degrees, len(table.time)) == (False, 92)
    assert table.column("box_transZ_force")[0] == 59.682
