"""From a recording as read to the mapped markers of the wanted part, in metres, without outliers and gaps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from liftopt.errors import InputError
from liftopt.lab.mocap.gaps import Gap, fill_gaps
from liftopt.lab.mocap.map_file import AnyMap, mapped_markers
from liftopt.lab.mocap.marker_map import Labels
from liftopt.lab.mocap.outliers import Outlier, check_enough, without_far_points
from liftopt.lab.mocap.recording import Recording, in_metres
from liftopt.lab.mocap.trial_part import TrialPart, chosen_part

FEWEST_FRAMES = 12  # for the filter and the spline
Judge = Callable[[Recording], tuple[Recording, tuple[Outlier, ...]]]


@dataclass(frozen=True)
class TakenMarkers:
    """Markers of a person and an object.

    Attributes:
        recording: the wanted part of the trial, as read.
        filled: the mapped markers in metres, Z up, gaps filled.
        unused: labels that the mapping leaves aside.
        outliers: that were dropped.
        gaps: all gaps.
    """

    recording: Recording
    filled: Recording
    unused: Labels
    outliers: tuple[Outlier, ...]
    gaps: tuple[Gap, ...]


def taken_markers(recording: Recording, mapping: AnyMap, part: TrialPart, judged: Judge) -> TakenMarkers:
    """Return the markers of a trial.

    Args:
        recording: as read.
        mapping: of its markers.
        part: of the trial that is used.
        judged: takes outliers out of a recording in metres.

    Raises:
        InputError: recording and mapping do not go together, or markers are where they cannot be in too many frames.
    """
    recording = chosen_part(recording, part)
    mapped, unused = mapped_markers(recording, mapping)
    metres = in_metres(without_far_points(mapped), mapping.units or None, mapping.up)
    if len(metres.time) < FEWEST_FRAMES:
        raise InputError(recording.source, f"{len(metres.time)} frames", f"must be at least {FEWEST_FRAMES}")
    clean, outliers = judged(metres)
    filled, gaps = fill_gaps(clean, mapping.by_segment())
    check_enough(filled, mapping.by_segment(), outliers)
    return TakenMarkers(recording, filled, unused, outliers, gaps)
