"""The path of one marker: its jumps from frame to frame, the pieces between them, and which of these it follows."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import numpy.typing as npt

from liftopt.lab.mocap.gaps import runs
from liftopt.lab.mocap.rigid import were_seen
from liftopt.types import Array

Flags = npt.NDArray[np.bool_]

STEP, JERKED = 0.006, 40.0  # m and m/s^2: a step longer than STEP + JERKED dt^2 against the steps around is a jump
AROUND = 3  # steps on either side that say how fast the marker goes
FORGOTTEN, MOST_PIECES = 0.1, 100  # s after which a marker may be anywhere; pieces of a path that are looked back on


def jumps_of(points: Array, rate: float) -> Flags:
    """Return (F, M) True in the frame after a jump."""
    steps = np.diff(points, axis=0)
    padded = np.pad(steps, ((AROUND, AROUND), (0, 0), (0, 0)), constant_values=np.nan)
    around = np.lib.stride_tricks.sliding_window_view(padded, 2 * AROUND + 1, axis=0)
    usual = np.zeros_like(steps)
    known = were_seen(steps)
    usual[known] = np.nanmedian(around[known], axis=-1)
    far = np.linalg.norm(np.where(known[:, :, None], steps - usual, 0.0), axis=2) > STEP + JERKED / rate**2
    return np.concatenate([np.zeros((1, points.shape[1]), bool), far])


def aside_of(points: Array, rate: float) -> Flags:
    """Return (F, M) the frames that a marker's path goes without: the longest chain of pieces between its jumps."""
    jumps, seen = jumps_of(points, rate), were_seen(points)
    aside = np.zeros_like(seen)
    for marker in np.flatnonzero(jumps.any(axis=0)):
        pieces = pieces_of(seen[:, marker], jumps[:, marker])
        aside[:, marker] = seen[:, marker]
        for first, behind in _longest_chain(points[:, marker], pieces, rate):
            aside[first:behind, marker] = False
    return aside


def pieces_of(seen: Flags, jumps: Flags) -> list[tuple[int, int]]:
    """Return first frame and the one behind the last of each stretch without gap and jump."""
    result = []
    for start, end in runs(seen):
        cuts = [start, *(start + np.flatnonzero(jumps[start : end + 1])), end + 1]
        result += [(int(first), int(behind)) for first, behind in pairwise(cuts) if behind > first]
    return result


def _longest_chain(path: Array, pieces: list[tuple[int, int]], rate: float) -> list[tuple[int, int]]:
    """Return the pieces of a marker's path (F, 3) that follow each other without a jump and hold most frames."""
    best: list[int] = []
    before: list[int] = []
    for k, (first, behind) in enumerate(pieces):
        joined = [i for i in range(max(0, k - MOST_PIECES), k) if _follows(path, pieces[i], pieces[k], rate)]
        last = max(joined, key=lambda i: best[i], default=-1)
        best.append(behind - first + (best[last] if last >= 0 else 0))
        before.append(last)
    k, chain = int(np.argmax(best)), []
    while k >= 0:
        chain.append(pieces[k])
        k = before[k]
    return chain


def _follows(path: Array, earlier: tuple[int, int], later: tuple[int, int], rate: float) -> bool:
    """Return whether a marker may have gone from the end of one piece to the start of the other."""
    frames = later[0] - earlier[1] + 1
    if frames == 1:
        return False  # a jump is between them
    if frames > FORGOTTEN * rate:
        return True
    ends = [path[max(earlier[1] - AROUND - 1, earlier[0]) : earlier[1]], path[later[0] : later[0] + AROUND + 1]]
    speeds = [np.diff(end[: min(len(end), later[1] - later[0]) if k else None], axis=0) for k, end in enumerate(ends)]
    known = [speed.mean(axis=0) for speed in speeds if len(speed)]
    speed = np.mean(known, axis=0) if known else np.zeros(3)
    off = path[later[0]] - path[earlier[1] - 1] - frames * speed
    return bool(np.linalg.norm(off) <= STEP + JERKED * (frames / rate) ** 2)
