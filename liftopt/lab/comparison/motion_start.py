"""Where in a recording the predicted motion begins, for recordings that do not hold the goal.

Nothing in the motion itself tells a robot that was told late from one that follows late. So a recording is laid on the
prediction where it moves as this does at its start, and what comes later than that start shows as its phase. The best
fit over the whole lift only says where to look: it would hide how late the arm becomes on its way.
"""

from __future__ import annotations

import numpy as np

from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.robot.robot_record import SHORT, RobotRecord
from liftopt.solution.interpolation import linear
from liftopt.types import Array

STEP = 0.01  # [s] between the starts that are tried
MOVED = 0.005  # rad: farther than this from where it rested, the arm has begun to move
CLEARLY = 0.1  # rad: as far from its start, it is on its way
REST, STILL = 0.2, MOVED / 2  # within STILL [rad] for REST [s], the arm rests
EARLIER = 1.0  # [s]: rest is looked for up to this before the best fit, which an arm that falls behind shifts
# A goal that comes this much after its recorder subscribed is caught [s]: if it was missed, the recorder was just late.
CONNECTED = 0.5
TOGETHER = 0.1  # [s]: trajectory and goal, sent at once


def lift_start(record: RobotRecord, time: Array, q: Array, topics: str) -> tuple[float, str, str]:
    """Return when the lift began in a record [s], how that was found, and what to know of it (may be empty).

    Args:
        record: of one trial.
        time: (T,) of the predicted lift, from 0 [s].
        q: (T, n) predicted positions [rad, m].
        topics: of the robot's states and goals, to say what to record.

    Raises:
        InputError: the record is shorter than the lift, or its arm does not move.
    """
    if record.sent and record.sent[-1] - record.sent[0] < TOGETHER:
        return record.sent[-1], record.told_by, ""
    start = motion_start(record, time, q)
    if record.sent:  # to its start, the lift, and back, it may be
        before = [sent for sent in record.sent if sent <= start + SHORT]
        return before[-1] if before else record.sent[0], record.told_by, ""
    how = "where it moves as the prediction does at its start"
    hint = f"its goal is not in the bag; start `rosbag record {topics}` before the goal is sent"
    if record.missed is not None and 0.0 <= start - record.missed <= CONNECTED:
        how = "when its recorder subscribed to the goal's topic (just too late)"
        return record.missed, how, f"the arm is at least as late as its phase says: {hint}"
    return start, how, f"a delay of the whole motion does not show: {hint}"


def motion_start(record: RobotRecord, time: Array, q: Array) -> float:
    """Return when a recorded arm began the predicted motion, as far as the motion tells [s]; see ``lift_start``."""
    if np.ptp(record.q, axis=0).max() <= MOVED:
        raise InputError(record.source, NO_VALUE, f"the arm does not move by {MOVED:g} rad")
    fit = _best_fit(record, time, q)
    away = _away(q, q[0])
    first = _crossing(time, away, MOVED)
    under_way = fit + _crossing(time, away, min(CLEARLY, float(away.max()) / 2))
    rest = _rest_before(record, under_way, fit - EARLIER)
    if rest is None:
        return fit
    resting = slice(int(np.searchsorted(record.time, record.time[rest] - REST)), rest + 1)
    moved = _away(record.q[rest:], record.q[resting].mean(axis=0))
    return _crossing(record.time[rest:], moved, MOVED) - first


def _best_fit(record: RobotRecord, time: Array, q: Array) -> float:
    """Return the start from which the record differs least from the prediction, each joint's mean left aside."""
    duration = float(time[-1])
    count = round(duration / STEP) + 1
    lasts = float(record.time[-1] - record.time[0])
    seen = linear(record.time, record.q, record.time[0] + STEP * np.arange(round(lasts / STEP) + 1, dtype=float))
    if len(seen) < count:
        raise InputError(record.source, f"{lasts:.2f} s", f"must last the lift's {duration:g} s from its beginning")
    plan = linear(time, q, STEP * np.arange(count, dtype=float))
    cost = np.zeros(len(seen) - count + 1)
    for column, planned in zip((seen - seen.mean(axis=0)).T, (plan - plan.mean(axis=0)).T, strict=True):
        total, squares = (np.concatenate([[0.0], np.cumsum(values)]) for values in (column, column**2))
        spread = (squares[count:] - squares[:-count]) - (total[count:] - total[:-count]) ** 2 / count
        cost += spread - 2.0 * np.correlate(column, planned, "valid")
    return float(record.time[0]) + STEP * int(np.argmin(cost))


def _rest_before(record: RobotRecord, until: float, earliest: float) -> int | None:
    """Return the last message at which the arm had rested for ``REST``; None if it did not."""
    last = int(np.searchsorted(record.time, until, side="right")) - 1
    for k in range(last, -1, -1):
        since = record.time[k] - REST
        if record.time[k] < earliest or since < record.time[0]:
            return None
        first = min(int(np.searchsorted(record.time, since)), k - 1)  # one message alone shows no rest
        if _away(record.q[first : k + 1], record.q[k]).max() <= STILL:
            return k
    return None


def _away(q: Array, pose: Array) -> Array:
    """Return how far postures (K, n) are from one, the largest over joints (K,) [rad]."""
    return np.asarray(np.abs(q - pose).max(axis=1))


def _crossing(time: Array, away: Array, level: float) -> float:
    """Return when ``away`` (K,) first exceeds a level that it begins below and reaches, linear between samples."""
    k = max(int(np.argmax(away > level)), 1)
    rise = float(away[k] - away[k - 1])
    share = (level - float(away[k - 1])) / rise if rise > 0.0 else 1.0
    return float(time[k - 1] + share * (time[k] - time[k - 1]))
