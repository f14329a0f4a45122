"""Points that cannot be the marker's: jumps, swapped labels, frozen markers and values that stand for "not seen".

A marker is judged by the shape of its segment (its distances to the segment's other markers keep to what they are for
most of the trial) and by its own steps from frame to frame. What fails is taken as not seen, and said.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.ndimage import binary_closing

from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.mocap.gaps import runs
from liftopt.lab.mocap.marker_path import aside_of, jumps_of, pieces_of
from liftopt.lab.mocap.recording import Recording
from liftopt.lab.mocap.rigid import were_seen
from liftopt.types import Array

Flags = npt.NDArray[np.bool_]

FAR = 100.0  # times the usual distance from the middle of all markers: beyond it, a number and no place
ALIKE = 0.01  # m, width of the band in which a distance is most often: its usual value
LEAST_CHANGE = 0.02  # m that two markers of one segment may always come nearer or go apart: skin moves over bone
SPREAD_FACTOR = 9.0  # medians of the deviation that are still the segment's own softness, 6 standard deviations
EDGE, LONGEST_EDGE = 0.15, 0.25  # share of the tolerance down to which an outlier's run reaches, and how long [s]
HOLE = 6  # frames between two outliers of one marker that are taken as outliers too
STILL, MOVED = 3, 0.005  # frames with the very same coordinates while the others moved so far [m] are frozen
TREMBLE = 0.001  # m within which a marker is still that then jumps: some systems write a frozen one with noise
PIECE = 0.1  # share of the frames between two jumps whose shape is wrong: then all of them are
TOO_MANY = 0.4  # share of a marker's frames: with more, nobody knows which of its two places is the right one
FEWEST_LEFT = 2  # markers that with its neighbour show a segment
OPTIONAL = ("object", "scapula", "right foot", "left foot")  # segments that may be unknown for a while; feet stand
TOGETHER = 0.6  # share of all markers that jump in one frame: the recording does


@dataclass(frozen=True)
class Outlier:
    """A run of frames in which a marker is not where it can be.

    Attributes:
        marker: its label.
        first, last: frames, counted from 0, both within the run.
    """

    marker: str
    first: int
    last: int


@dataclass(frozen=True)
class ShapeGroup:
    """Markers that keep their distances.

    Attributes:
        name: of their segment.
        labels: the markers.
        judged: those of them that may be dropped.
        change: by which two of them may always come nearer or go apart [m].
    """

    name: str
    labels: tuple[str, ...]
    judged: tuple[str, ...]
    change: float = LEAST_CHANGE


def without_far_points(recording: Recording) -> Recording:
    """Return the recording, in any unit, without points that lie a hundred times further off than markers do."""
    points = recording.points.copy()
    seen = were_seen(points)
    if not seen.any():
        return recording
    away = np.linalg.norm(points - np.median(points[seen], axis=0), axis=2)
    far = seen & (away > FAR * np.median(away[seen]))
    notes = [
        f"{recording.labels[i]}: {far[:, i].sum()} points far from all others, first "
        f"{', '.join(f'{x:.7g}' for x in points[np.flatnonzero(far[:, i])[0], i])}, taken as not seen"
        for i in np.flatnonzero(far.any(axis=0))
    ]
    points[far] = np.nan
    return replace(recording, points=points, notes=(*recording.notes, *notes))


def without_outliers(recording: Recording, groups: Sequence[ShapeGroup]) -> tuple[Recording, tuple[Outlier, ...]]:
    """Return the recording with outliers taken as not seen, and these.

    Args:
        recording: in metres.
        groups: markers that keep their distances.

    Raises:
        InputError: all markers jump at once, or a marker is off in so many frames that its right place is not known.
    """
    points, found = recording.points.copy(), []
    labels = dict.fromkeys(label for group in groups for label in group.judged)
    _check_whole(recording, [recording.index(label) for label in labels])
    for group in groups:
        channels = [recording.index(label) for label in group.labels]
        judged = [label in group.judged for label in group.labels]
        wrong = wrong_points(points[:, channels], recording.rate, group.change) & judged
        seen = were_seen(points[:, channels])
        for column, label in enumerate(group.labels):
            spans = runs(wrong[:, column])
            if wrong[:, column].sum() > TOO_MANY * seen[:, column].sum():
                raise InputError(
                    f"{recording.source}, {label}",
                    NO_VALUE,
                    f"is not where a marker of the {group.name} can be in {wrong[:, column].sum()} of "
                    f"{seen[:, column].sum()} frames ({shown(recording, spans)}): is it swapped with another, or "
                    f"loose? Cut the trial with --from and --to, or leave the marker out with --ignore {label}",
                )
            found += [Outlier(label, first, last) for first, last in spans]
        points[:, channels] = np.where(wrong[:, :, None], np.nan, points[:, channels])
    return replace(recording, points=points), tuple(found)


def check_enough(recording: Recording, groups: Mapping[str, tuple[str, ...]], outliers: tuple[Outlier, ...]) -> None:
    """Check that outliers leave enough of each segment of the person.

    Args:
        recording: with gaps filled.
        groups: labels of the markers of each segment.
        outliers: that were dropped.

    Raises:
        InputError: a segment shows fewer than two markers where some were dropped.
    """
    for name, group in groups.items():
        dropped = [one for one in outliers if one.marker in group]
        if name in OPTIONAL or not dropped:
            continue
        few = were_seen(recording.points[:, [recording.index(label) for label in group]]).sum(axis=1) < FEWEST_LEFT
        bad = [one for one in dropped if few[one.first : one.last + 1].any()]
        if bad:
            markers = ", ".join(dict.fromkeys(one.marker for one in bad))
            spans = sorted({(one.first, one.last) for one in bad})
            raise InputError(
                f"{recording.source}, {markers}",
                NO_VALUE,
                f"not where markers of the {name} can be in {shown(recording, spans)}; what "
                "is left does not show the segment there. Are they swapped? Cut the trial with --from and --to",
            )


def shown(recording: Recording, spans: list[tuple[int, int]], most: int = 4) -> str:
    """Return runs of frames and their times in words; frames are counted from 0."""
    words = [
        f"frames {first} to {last}, {recording.time[first]:.2f} to {recording.time[last]:.2f} s"
        if last > first
        else f"frame {first}, {recording.time[first]:.2f} s"
        for first, last in spans[:most]
    ]
    return "; ".join(words) + (f"; and {len(spans) - most} more runs" if len(spans) > most else "")


def outlier_notes(recording: Recording, outliers: tuple[Outlier, ...]) -> list[str]:
    """Return one sentence for each marker that was dropped somewhere."""
    notes = []
    for label in dict.fromkeys(outlier.marker for outlier in outliers):
        spans = [(one.first, one.last) for one in outliers if one.marker == label]
        count = sum(last - first + 1 for first, last in spans)
        frames = "1 frame" if count == 1 else f"{count} frames"
        notes.append(
            f"{label} leaves the shape of its segment, jumps or is frozen in {frames} and is taken as not seen there: "
            + shown(recording, spans)
        )
    return notes


def wrong_points(points: Array, rate: float, change: float = LEAST_CHANGE) -> Flags:
    """Return (F, M) True where a marker of one segment (F, M, 3) cannot be the marker's [m].

    The usual distance of two markers is where most frames have it, so that it holds while fewer than half are wrong.
    Of the markers whose distances are off in a frame the one with most of them goes first.
    """
    work = points.copy()
    frozen = _frozen(work, rate)
    wrong = frozen.copy()
    work[wrong] = np.nan
    suspect = aside_of(work, rate)
    for _ in range(2):  # the usual distances once more, without what was wrong
        deviation, tolerance = _deviations(np.where(wrong[:, :, None], np.nan, points), change)
        wrong |= _leaving(deviation, tolerance, suspect)
        wrong |= _edges(deviation, tolerance, wrong, rate)
        # A marker that is off before and after is not right by chance between.
        wrong |= binary_closing(wrong, np.ones((HOLE + 1, 1), bool))
    # A freeze shows its own start: before it the marker was right, though no jump lies between.
    wrong |= _whole_pieces(points, wrong & ~frozen, rate)
    work[wrong] = np.nan
    # What jumps without a change of shape: two markers that are alike seen from the others.
    return np.asarray(wrong | aside_of(work, rate))


def _check_whole(recording: Recording, channels: list[int]) -> None:
    jumps = jumps_of(recording.points[:, channels], recording.rate)
    seen = were_seen(recording.points[:, channels])
    both = np.concatenate([np.zeros((1, len(channels)), bool), seen[1:] & seen[:-1]])
    together = jumps.sum(axis=1) > np.maximum(TOGETHER * both.sum(axis=1), 3)
    if together.any():
        frame = int(np.flatnonzero(together)[0])
        raise InputError(
            recording.source,
            NO_VALUE,
            f"{jumps[frame].sum()} of {both[frame].sum()} markers jump at {recording.time[frame]:.2f} s "
            f"(frame {frame}): frames are missing or repeated there; cut the trial with --from and --to",
        )


def _frozen(points: Array, rate: float) -> Flags:
    """Return (F, M) where a marker has the very same coordinates for some frames in which the others move.

    Where they all are frozen, that they jump afterwards shows it. One that jumps afterwards may have trembled.
    """
    frozen, jumps = np.zeros(points.shape[:2], bool), jumps_of(points, rate)
    for marker in range(points.shape[1]):
        same = np.concatenate([[False], (points[1:, marker] == points[:-1, marker]).all(axis=1)])
        for first, last in runs(same):
            if last - first + 2 < STILL:
                continue
            if last + 1 < len(points) and jumps[last + 1, marker]:
                frozen[first : last + 1, marker] = True
                continue
            # The first of them is where it was.
            frozen[first : last + 1, marker] |= _others_moved(points[first - 1 : last + 1], marker)
        for jump in np.flatnonzero(jumps[1:, marker] & ~frozen[:-1, marker]) + 1:
            path = points[:jump, marker][::-1]
            spread = np.maximum.accumulate(path, axis=0) - np.minimum.accumulate(path, axis=0)
            count = int(np.argmin(np.append((spread <= TREMBLE).all(axis=1), False)))
            still = slice(jump - count, jump)
            frozen[still, marker] |= count >= STILL and _others_moved(points[still], marker)
    return frozen


def _others_moved(points: Array, marker: int) -> bool:
    """Return whether most of the other markers (F, M, 3) that are seen in all frames went further than ``MOVED``."""
    others = np.delete(points, marker, axis=1)
    whole = others[:, were_seen(others).all(axis=0)]
    return bool(whole.shape[1]) and bool(np.median(np.ptp(whole, axis=0).max(axis=1)) > MOVED)


def _whole_pieces(points: Array, wrong: Flags, rate: float) -> Flags:
    """Return (F, M) all frames from jump to jump, or to the end of what was seen, in which some were wrong."""
    jumps, seen, whole = jumps_of(points, rate), were_seen(points), np.zeros_like(wrong)
    for marker in np.flatnonzero(wrong.any(axis=0) & jumps.any(axis=0)):
        for first, behind in pieces_of(seen[:, marker], jumps[:, marker]):
            ended = jumps[first, marker] or (behind < len(points) and jumps[behind, marker])
            if ended and 2 * (behind - first) < seen[:, marker].sum():
                whole[first:behind, marker] |= wrong[first:behind, marker].mean() > PIECE
    return whole


def _deviations(points: Array, change: float) -> tuple[Array, Array]:
    """Return (F, M, M) how far distances are from their usual value, 0 where unknown, and (M, M) what they may be."""
    count = points.shape[1]
    deviation, tolerance = np.zeros((len(points), count, count)), np.full((count, count), change)
    for i in range(count):
        for j in range(i):
            distance = np.linalg.norm(points[:, i] - points[:, j], axis=1)
            known = np.sort(distance[np.isfinite(distance)])
            if not known.size:
                continue
            ends = np.searchsorted(known, known + ALIKE, side="right")
            start = int(np.argmax(ends - np.arange(len(known))))
            off = np.abs(distance - np.median(known[start : ends[start]]))
            deviation[:, i, j] = deviation[:, j, i] = np.where(np.isfinite(off), off, 0.0)
            tolerance[i, j] = tolerance[j, i] = max(change, SPREAD_FACTOR * float(np.nanmedian(off)))
    return deviation, tolerance


def _leaving(deviation: Array, tolerance: Array, suspect: Flags) -> Flags:
    """Return (F, M) the fewest markers without which no distance is off, those that jumped before others."""
    off, gone = deviation > tolerance, np.zeros(suspect.shape, bool)
    frames = np.flatnonzero(off.any(axis=(1, 2)))
    for _ in range(suspect.shape[1]):
        count = off[frames].sum(axis=2)
        frames, count = frames[count.any(axis=1)], count[count.any(axis=1)]
        if not frames.size:
            break
        amount = (deviation[frames] * off[frames]).sum(axis=2)
        score = count + 0.5 * suspect[frames] * (count > 0) + 0.1 * amount / amount.max(axis=1, keepdims=True)
        worst = score.argmax(axis=1)
        gone[frames, worst] = True
        off[frames, worst], off[frames, :, worst] = False, False
    return gone


def _edges(deviation: Array, tolerance: Array, wrong: Flags, rate: float) -> Flags:
    """Return (F, M) with the runs of wrong frames longer by those in which the marker is on its way."""
    count = wrong.shape[1]
    if count < 3:
        return wrong
    apart = (deviation > EDGE * tolerance) & ~wrong[:, None, :]
    leaning = apart.sum(axis=2) * 2 > count - 1
    wider = wrong.copy()
    for _ in range(int(LONGEST_EDGE * rate)):
        beside = np.zeros_like(wider)
        beside[1:] |= wider[:-1]
        beside[:-1] |= wider[1:]
        more = beside & leaning & ~wider
        if not more.any():
            break
        wider |= more
    return wider
