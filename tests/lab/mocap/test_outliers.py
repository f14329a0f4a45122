"""Markers that are not where they can be: the oracle is the lift of known motion without them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from liftopt.errors import InputError
from liftopt.lab.mocap.from_markers import read_recording, recorded_lift
from liftopt.lab.mocap.loads import Load
from liftopt.lab.mocap.map_file import load_marker_map, mapped_markers
from liftopt.lab.mocap.outliers import ShapeGroup, without_far_points, without_outliers
from liftopt.lab.mocap.recorded_lift import RecordedLift
from liftopt.lab.mocap.recording import in_metres
from liftopt.types import Array

LOAD = Load(mass=6.0)
LITTLE = 0.03  # of a peak torque, and of 5 Nm where it is smaller


@pytest.fixture(scope="module")
def clean(truth: Any) -> RecordedLift:
    return recorded_lift(truth.recording, truth.mapping, LOAD)


def _with(truth: Any, change: Callable[[Array], None]) -> RecordedLift:
    points = truth.recording.points.copy()
    change(points)
    return recorded_lift(replace(truth.recording, points=points), truth.mapping, LOAD)


def _peaks_agree(lift: RecordedLift, clean: RecordedLift) -> None:
    peak, right = np.abs(lift.tau[:, 3:]).max(axis=0), np.abs(clean.tau[:, 3:]).max(axis=0)
    assert (np.abs(peak - right) < LITTLE * np.maximum(right, 5.0)).all()


def test_a_clean_recording_loses_nothing(clean: RecordedLift) -> None:
    assert not clean.gaps
    assert not any("taken as not seen" in note for note in clean.notes)


@pytest.mark.parametrize("label", ["RASI", "STER", "ELBL", "ARM1", "WRSR", "MC2", "B1"])
@pytest.mark.parametrize("frames", [(95, 97), (0, 1), (70, 130)], ids=str)
def test_a_marker_that_jumps_is_dropped_and_named(
    truth: Any, clean: RecordedLift, label: str, frames: tuple[int, int]
) -> None:
    channel = truth.recording.index(label)

    def jump(points: Array) -> None:
        points[slice(*frames), channel] += 300.0

    lift = _with(truth, jump)
    _peaks_agree(lift, clean)
    first, last = frames[0], frames[1] - 1
    where = f"frame {first}," if first == last else f"frames {first} to {last},"
    assert any(note.startswith(f"{label} leaves") and where in note for note in lift.notes), lift.notes


@pytest.mark.parametrize("value", [-9999.99, 1e6, 9999.0, 99999.0, -1e9])
def test_a_number_that_stands_for_not_seen_is_no_place(truth: Any, clean: RecordedLift, value: float) -> None:
    def hide(points: Array) -> None:
        points[60:90, truth.recording.index("MC2")] = value

    lift = _with(truth, hide)
    _peaks_agree(lift, clean)
    assert any(note.startswith("MC2") and "taken as not seen" in note for note in lift.notes)
    assert np.isnan(lift.residual[60:90, lift.markers.index("MC2")]).all()


def test_swapped_labels_of_two_segments_are_both_named(truth: Any, clean: RecordedLift) -> None:
    pair = [truth.recording.index(label) for label in ("ELBL", "RASI")]

    def swap(points: Array) -> None:
        points[80:110, pair] = points[80:110, pair[::-1]]

    lift = _with(truth, swap)
    _peaks_agree(lift, clean)
    for label in ("ELBL", "RASI"):
        assert any(note.startswith(f"{label} leaves") and "frames 80 to 109" in note for note in lift.notes)


@pytest.mark.parametrize(("pair", "segment"), [(("MC2", "MC5"), "hand"), (("ELBL", "ELBM"), "upper_arm")])
def test_swapped_labels_of_one_segment_never_give_torques(
    truth: Any, clean: RecordedLift, pair: tuple[str, str], segment: str
) -> None:
    """What is left is enough, or the recording is refused with the markers and the time."""
    channels = [truth.recording.index(label) for label in pair]

    def swap(points: Array) -> None:
        points[70:100, channels] = points[70:100, channels[::-1]]

    try:
        lift = _with(truth, swap)
    except InputError as error:
        assert f"markers of the {segment}" in str(error)
        assert all(label in str(error) for label in pair)
        assert "frames 70 to 99, 0.70 to 0.99 s" in str(error)
    else:
        _peaks_agree(lift, clean)
        assert all(any(note.startswith(f"{label} leaves") for note in lift.notes) for label in pair)


@pytest.mark.parametrize("label", ["WRSR", "ARM2", "LASI", "B3"])
def test_a_frozen_marker_is_dropped(truth: Any, clean: RecordedLift, label: str) -> None:
    def freeze(points: Array) -> None:
        points[70:120, truth.recording.index(label)] = points[70, truth.recording.index(label)]

    lift = _with(truth, freeze)
    _peaks_agree(lift, clean)
    assert any(note.startswith(f"{label} leaves") for note in lift.notes)


def test_what_was_right_before_a_marker_froze_is_kept(truth: Any) -> None:
    """It jumps back at the end, so that the stretch up to there is one piece."""
    noise = np.random.default_rng(1).normal(0.0, 0.5, truth.recording.points.shape)
    channel = truth.recording.index("MC2")

    def freeze(points: Array) -> None:
        points += noise
        points[55:70, channel] = points[55, channel]

    lift = _with(truth, freeze)
    (note,) = [note for note in lift.notes if note.startswith("MC2 leaves")]
    assert "in 14 frames" in note
    assert "frames 56 to 69" in note


def test_a_frozen_marker_that_trembles_is_dropped_from_where_it_froze(truth: Any, clean: RecordedLift) -> None:
    channel, rng = truth.recording.index("RASI"), np.random.default_rng(2)

    def freeze(points: Array) -> None:
        points[60:95, channel] = points[60, channel] + rng.normal(0.0, 0.05, (35, 3))

    lift = _with(truth, freeze)
    _peaks_agree(lift, clean)
    (dropped,) = [gap for gap in lift.gaps if gap.marker == "RASI"]
    assert 55 <= dropped.first <= 60
    assert dropped.last == 94


@pytest.mark.parametrize(("group", "name"), [(("MC2", "MC5", "HAND1"), "hand"), (("B1", "B2", "B3", "B4"), "object")])
def test_a_segment_that_is_frozen_while_it_moves_is_refused(truth: Any, group: tuple[str, ...], name: str) -> None:
    channels = [truth.recording.index(label) for label in group]

    def freeze(points: Array) -> None:
        points[70:100, channels] = points[70, channels]

    with pytest.raises(InputError, match=rf"{name}.*0\.71 to 0\.99 s") as refused:
        _with(truth, freeze)
    assert all(label in str(refused.value) for label in group)


@pytest.mark.parametrize("label", ["B4", "ARM1"])
def test_a_marker_that_is_all_over_the_place_is_dropped(truth: Any, clean: RecordedLift, label: str) -> None:
    """By chance it is near its place in some frames."""

    def scatter(points: Array) -> None:
        points[100:160, truth.recording.index(label)] += np.random.default_rng(0).normal(0.0, 200.0, (60, 3))

    lift = _with(truth, scatter)
    _peaks_agree(lift, clean)
    assert any(note.startswith(f"{label} leaves") for note in lift.notes)


def test_a_marker_that_is_off_too_often_is_refused(truth: Any) -> None:
    def lose(points: Array) -> None:
        points[40:130, truth.recording.index("ARM1")] += np.array([0.0, 150.0, 80.0])

    with pytest.raises(InputError, match=r"ARM1.*upper_arm.*90 of 200 frames.*0\.40 to 1\.29 s.*--ignore ARM1"):
        _with(truth, lose)


def test_a_recording_that_jumps_as_a_whole_is_refused(truth: Any) -> None:
    """As where frames were cut out."""

    def shift(points: Array) -> None:
        points[90:] += 80.0

    with pytest.raises(InputError, match=r"markers jump at 0\.90 s \(frame 90\)"):
        _with(truth, shift)


def test_noise_of_a_good_system_drops_nothing(truth: Any) -> None:
    noise = np.random.default_rng(3).normal(0.0, 0.5, truth.recording.points.shape)
    lift = recorded_lift(replace(truth.recording, points=truth.recording.points + noise), truth.mapping, LOAD)
    assert not lift.gaps


def test_the_real_recording_loses_no_marker(box_lift: Any) -> None:
    mapping = load_marker_map("box_lift")
    mapped, _ = mapped_markers(read_recording(box_lift / "markers_analogs.c3d"), mapping)
    metres = in_metres(without_far_points(mapped), mapping.units, mapping.up)
    groups = [ShapeGroup(name, labels, labels) for name, labels in mapping.by_segment().items()]
    judged, outliers = without_outliers(metres, groups)
    assert outliers == ()
    np.testing.assert_array_equal(judged.points, metres.points)
