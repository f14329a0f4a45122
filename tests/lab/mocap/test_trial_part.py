"""Parts of a trial: a cut, markers left out, several lifts, an object out of sight; the motion is known."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from liftopt.errors import InputError
from liftopt.lab.mocap.from_markers import recorded_lift
from liftopt.lab.mocap.loads import Load
from liftopt.lab.mocap.object_motion import lifts
from liftopt.lab.mocap.recorded_file import load_recorded, save_recorded
from liftopt.lab.mocap.recorded_lift import RecordedLift
from liftopt.lab.mocap.recorded_scenario import recorded_scenario
from liftopt.lab.mocap.recording import ForcePlate, Recording
from liftopt.lab.mocap.trial_part import TrialPart, chosen_part, ignored_markers

LOAD = Load(mass=6.0)


@pytest.fixture(scope="module")
def clean(truth: Any) -> RecordedLift:
    return recorded_lift(truth.recording, truth.mapping, LOAD)


@pytest.fixture(scope="module")
def twice(truth: Any) -> RecordedLift:
    """Return a box lifted, put down, a second on its support, and lifted again."""
    points = truth.recording.points
    whole = np.concatenate([points, np.repeat(points[-1:], 100, axis=0), points])
    recording = replace(truth.recording, points=whole, time=np.arange(len(whole)) / 100.0)
    return recorded_lift(recording, truth.mapping, LOAD)


def test_two_lifts_are_told_apart(truth: Any, twice: RecordedLift, tmp_path: Path) -> None:
    """The second is the first, 3 s later; between them the hand carries nothing."""
    assert len(twice.lifts) == 2
    assert twice.lifts[1] == pytest.approx(np.add(twice.lifts[0], 3.0), abs=0.011)
    away = np.flatnonzero(np.linalg.norm(truth.box - truth.box[0], axis=1) > 0.005)
    assert twice.lifts[0] == pytest.approx((away[0] / 100.0, away[-1] / 100.0), abs=0.021)
    pause = (twice.time > twice.lifts[0][1] + 0.011) & (twice.time < twice.lifts[1][0])
    assert pause.sum() > 150
    assert not twice.hand_force[pause].any()
    assert twice.carried is None
    assert any("lifted 2 times" in note for note in twice.notes)
    with pytest.raises(InputError, match=r"--lift: .* shows 2 lifts, 1 from 0\.4.* choose one"):
        recorded_scenario(twice, 6.0)
    with pytest.raises(InputError, match="shows 2 lifts"):
        twice.over_lift(twice.q)
    with pytest.raises(InputError, match=r"--lift = 3.*1 to 2"):
        twice.of_lift(3)
    save_recorded(twice.of_lift(2), tmp_path)
    second = load_recorded(tmp_path)
    assert second.carried == twice.lifts[1]
    assert second.lifts == twice.lifts
    assert recorded_scenario(second, 6.0).duration == pytest.approx(np.ptp(twice.lifts[1]), abs=1e-3)


def test_lifts_end_where_the_object_lies_anywhere() -> None:
    """Floor to table, a pause of 0.8 s there, table to shelf: two lifts; a pause of 0.3 s in the air is none."""
    time = np.arange(600) / 100.0
    rise = np.interp(time, [0.5, 1.5, 2.3, 3.3], [0.0, 0.7, 0.7, 1.4])
    path = np.stack([0.2 * rise, 0.0 * rise, rise], axis=1)
    assert [(round(a / 100, 1), round(b / 100, 1)) for a, b in lifts(time, path)] == [(0.5, 1.5), (2.3, 3.3)]
    rise = np.interp(time, [0.5, 1.5, 1.8, 2.8], [0.0, 0.7, 0.7, 1.4])
    path = np.stack([0.2 * rise, 0.0 * rise, rise], axis=1)
    assert [(round(a / 100, 1), round(b / 100, 1)) for a, b in lifts(time, path)] == [(0.5, 2.8)]
    assert lifts(time, np.zeros((600, 3))) == ()


@pytest.mark.parametrize("frames", [(0, 3), (0, 30), (185, 200), (95, 105), (82, 102)], ids=str)
def test_a_box_out_of_sight_for_a_moment(truth: Any, clean: RecordedLift, frames: tuple[int, int]) -> None:
    points = truth.recording.points.copy()
    for label in ("B1", "B2", "B3", "B4"):
        points[slice(*frames), truth.recording.index(label)] = np.nan
    lift = recorded_lift(replace(truth.recording, points=points), truth.mapping, LOAD)
    assert lift.lifts == clean.lifts
    np.testing.assert_allclose(lift.hand_force, clean.hand_force, atol=0.02 * np.abs(clean.hand_force).max())


def test_a_box_out_of_sight_while_it_moves_is_refused_with_the_time(truth: Any) -> None:
    points = truth.recording.points.copy()
    for label in ("B1", "B2", "B3", "B4"):
        points[60:120, truth.recording.index(label)] = np.nan
    with pytest.raises(InputError, match=r"0\.60 to 1\.19 s.*in which the object moves"):
        recorded_lift(replace(truth.recording, points=points), truth.mapping, LOAD)


def test_ignored_spans_and_markers(truth: Any, clean: RecordedLift) -> None:
    part = TrialPart(ignored=ignored_markers(["ARM1", "MC2:0.6-0.89"]))
    lift = recorded_lift(truth.recording, truth.mapping, LOAD, part=part)
    assert "ARM1" not in lift.markers
    assert np.isnan(lift.residual[60:90, lift.markers.index("MC2")]).all()
    np.testing.assert_allclose(np.abs(lift.tau).max(axis=0), np.abs(clean.tau).max(axis=0), rtol=0.03, atol=0.15)


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("ELBL", "landmark elbow_lateral, which is needed"),
        ("NOSE", "no such marker"),
        ("ELBL:5-6", "goes from 0 to 1.99 s"),
        ("ELBL:1.2-0.4", "FROM before TO"),
        ("ELBL:1.2.3-4", "in seconds"),
    ],
)
def test_what_cannot_be_ignored(truth: Any, text: str, match: str) -> None:
    with pytest.raises(InputError, match=match):
        recorded_lift(truth.recording, truth.mapping, part=TrialPart(ignored=ignored_markers([text])))


def test_a_label_with_a_colon_can_be_ignored() -> None:
    whole, span = ignored_markers(["Anna:STER", "Anna:STER:0.5-1"])
    assert (whole.marker, whole.start) == ("Anna:STER", -np.inf)
    assert (span.marker, span.start, span.end) == ("Anna:STER", 0.5, 1.0)


@pytest.fixture
def marked(truth: Any) -> Recording:
    samples = np.arange(2000.0)[:, None] * np.ones(3)
    plate = ForcePlate(1000.0, samples, samples, samples, np.zeros((4, 3)))
    events = (("Right Foot Strike", 0.4), ("Left Foot Off", 0.5), ("Left Foot Strike", 1.6), ("Left Foot Off", 1.7))
    cut: Recording = replace(truth.recording, events=events, plates=(plate,))
    return cut


def test_a_trial_is_cut_by_times_and_events(marked: Recording) -> None:
    part = chosen_part(marked, TrialPart("0.3", "left foot strike"))
    assert (part.time[0], part.time[-1]) == (pytest.approx(0.3), pytest.approx(1.6))
    np.testing.assert_array_equal(part.points, marked.points[30:161])
    np.testing.assert_array_equal(part.plates[0].force, marked.plates[0].force[300:1610])
    assert any("cut to 0.30 to 1.60 s" in note for note in part.notes)


@pytest.mark.parametrize(
    ("start", "end", "match"),
    [
        ("7", "", "--from = '7'.*goes from 0 to 1.99 s"),
        ("Left Foot Off", "", "2 events, at 0.50, 1.70 s"),
        ("Foot Strike", "", "2 events"),
        ("lift off", "", "Right Foot Strike at 0.40 s"),
        ("1.5", "0.5", "--to = '0.5'.*after --from"),
        ("nan", "", "--from = 'nan'"),
    ],
)
def test_wrong_cuts_are_refused(marked: Recording, start: str, end: str, match: str) -> None:
    with pytest.raises(InputError, match=match):
        chosen_part(marked, TrialPart(start, end))


def test_two_knuckles_and_the_wrist_make_a_hand(truth: Any, clean: RecordedLift) -> None:
    mapping = truth.mapping.changed(segments=truth.mapping.segments.changed(hand=()))
    lift = recorded_lift(truth.recording, mapping, LOAD)
    np.testing.assert_allclose(lift.q[:, 3:], clean.q[:, 3:], atol=2e-3)
    np.testing.assert_allclose(lift.lengths.l6, truth.lengths.l6, atol=1e-4)
    assert "wrist centre" in lift.markers
