"""Gaps in marker trajectories: short ones by a spline, long ones from the other markers of the segment."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.interpolate import make_lsq_spline

from liftopt.lab.mocap.recording import Recording
from liftopt.lab.mocap.rigid import FEWEST, fit_poses, were_seen
from liftopt.types import Array

LONGEST_SPLINE = 0.1  # s; at 6 Hz, the cut-off used for lifting, a little over half a period
LONGEST_OF_OBJECT = 0.2  # s; nothing else shows where it is, and it goes more smoothly than a limb
AROUND, AROUND_TIME = 10, 0.1  # frames and s, the longer of them: what a spline follows on either side of a gap
DEGREE, POINTS_EACH = 5, 3  # of that spline, and points for each degree: fewer, and it would follow their noise

SPLINE, SEGMENT, OPEN = "spline", "segment", "open"


@dataclass(frozen=True)
class Gap:
    """One run of frames in which a marker was not seen.

    Attributes:
        marker: its label.
        first, last: frames, counted from 0, both within the gap.
        filled: ``"spline"``, ``"segment"`` (from the other markers of its segment) or ``"open"`` (not filled).
    """

    marker: str
    first: int
    last: int
    filled: str


def fill_gaps(recording: Recording, segments: Mapping[str, tuple[str, ...]]) -> tuple[Recording, tuple[Gap, ...]]:
    """Return the recording with gaps filled, and all gaps.

    A gap of up to 0.1 s between seen frames is closed by a quintic spline of one piece, fitted by least squares to
    ten frames or 0.1 s on either side: one through noisy frames swings out in the gap. A longer
    one is closed by the pose of the segment's other markers, at least three of them: the marker's place in the segment
    goes linearly from where it was before the gap to where it is after it. Where these do not suffice, a spline closes
    gaps of the object's markers of up to 0.2 s. What then is left stays NaN: inverse kinematics goes without.

    Args:
        recording: in metres.
        segments: labels of the markers of each segment.
    """
    points, gaps = recording.points.copy(), []
    for channel, label in enumerate(recording.labels):
        for first, last in runs(~were_seen(points[:, channel])):
            gap = Gap(label, first, last, OPEN)
            if _is_inside(gap, recording, LONGEST_SPLINE):
                points[first : last + 1, channel] = _spline(recording, channel, first, last)
                gap = replace(gap, filled=SPLINE)
            gaps.append(gap)
    with_splines = points.copy()
    for i, gap in enumerate(gaps):
        if gap.filled == OPEN:
            others = _others(recording, segments, gap.marker)
            channel = recording.labels.index(gap.marker)
            found = _from_segment(with_splines[:, channel], with_splines[:, others], gap)
            if found is not None:
                points[gap.first : gap.last + 1, channel] = found
                gaps[i] = replace(gap, filled=SEGMENT)
            elif gap.marker in segments.get("object", ()) and _is_inside(gap, recording, LONGEST_OF_OBJECT):
                # Before the filter, which would bend both sides of a gap away from each other.
                points[gap.first : gap.last + 1, channel] = _spline(recording, channel, gap.first, gap.last)
                gaps[i] = replace(gap, filled=SPLINE)
    return replace(recording, points=points), tuple(gaps)


def runs(flags: npt.NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return first and last index of each run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(int)))
    return [(int(start), int(end) - 1) for start, end in zip(edges[::2], edges[1::2], strict=True)]


def _is_inside(gap: Gap, recording: Recording, longest: float) -> bool:
    """Return whether there are frames before and after a gap of at most ``longest`` [s]."""
    inside = gap.first > 0 and gap.last < len(recording.points) - 1
    return inside and gap.last - gap.first + 1 <= int(longest * recording.rate)


def _spline(recording: Recording, channel: int, first: int, last: int) -> Array:
    values, around = recording.points[:, channel], max(AROUND, round(AROUND_TIME * recording.rate))
    frames = np.arange(max(0, first - around), min(len(values), last + 1 + around))
    seen = frames[were_seen(values[frames])]
    degree = min(DEGREE, max(1, len(seen) // POINTS_EACH))
    knots = np.repeat([float(seen[0]), float(seen[-1])], degree + 1)
    return np.asarray(make_lsq_spline(seen, values[seen], knots, k=degree)(np.arange(first, last + 1)))


def _others(recording: Recording, segments: Mapping[str, tuple[str, ...]], marker: str) -> list[int]:
    mates = next((labels for labels in segments.values() if marker in labels), ())
    return [recording.labels.index(label) for label in mates if label != marker]


def _from_segment(marker: Array, others: Array, gap: Gap) -> Array | None:
    """Return the marker (n, 3) in a gap from the segment's other markers (F, M, 3); None if they do not suffice."""
    inside = slice(gap.first, gap.last + 1)
    known = were_seen(others)
    seen = known[inside].all(axis=0)
    ends = [frame for frame in (gap.first - 1, gap.last + 1) if 0 <= frame < len(marker)]
    ends = [frame for frame in ends if (known[frame] | ~seen).all() and np.isfinite(marker[frame]).all()]
    if seen.sum() < FEWEST or not ends:
        return None
    # The segment's shape is that of one end: so the marker leaves it without a step.
    poses = fit_poses(others[ends[0]][seen], others[:, seen])
    local = poses.to_body(marker)[ends]
    frames, place = np.arange(gap.first, gap.last + 1), np.zeros_like(marker)
    place[inside] = np.stack([np.interp(frames, ends, local[:, axis]) for axis in range(3)], axis=1)
    found = poses.to_world(place)[inside]
    return found if np.isfinite(found).all() else None
