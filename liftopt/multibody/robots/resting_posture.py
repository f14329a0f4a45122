"""A comfortable posture for a robot that comes with none: where a search for postures begins.

The middle of a robot's ranges is often its worst posture. There a UR stands stretched, its three joints in one plane
useless for one of the directions. Here the tool points level ahead, at a share of the reach at which an arm is half
bent, and of many such postures that one is taken that moves best in all directions with room left in every joint.

The candidates are spread evenly over the ranges, so that equal robots have equal postures. Each of the best is led to
where the tool should be by damped least squares, and judged there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from liftopt.multibody.agent import JointLimits, slides
from liftopt.multibody.robots.evenly_spread import evenly_spread
from liftopt.multibody.trajectory import cross
from liftopt.types import Array

CANDIDATES, LED, KEPT = 256, 16, 2
STEPS, LONGEST_SHARE = 32, 0.3
ITERATIONS, DAMPING, LONGEST_STEP = 25, 1e-3, 0.4
# Where the tip should be, from the shoulder, in shares of the reach: ahead, to the side, up.
BOX = np.array([[0.5, -0.1, -0.3], [0.7, 0.1, 0.1]])
ROOM = 1.0  # [rad]: a joint further than this from both ends of its range has all the room it needs
NEAR = 0.1  # a miss of this share of the reach, or of so many rad, costs a posture about two thirds of its rank
UPRIGHT = 0.5  # an axis with a smaller level part counts as upright
END = 0.01  # share of a range at either end that no posture is in
DIGITS = 4  # the last ones differ from processor to processor
# What an elbow below the line from shoulder to tip by a share of the reach costs: an arm on a stand that reaches over
# is clear of its stand and of what it holds, one that hangs is not. Where the first axis is level, arms hang as ours.
BELOW, STANDING = 3.0, 0.9
ROWS = 5  # position and where the tool points; how it is turned about itself is for the grasp to say


@dataclass(frozen=True)
class _Aim:
    """Where the tip should be.

    Attributes:
        shoulder: (3,) in the world, the point on the first turning axis that is nearest to the second joint.
        axes: (3, 3) rows ahead, left and up, in the world.
        reach: of the tip from the shoulder, the farthest of all candidates [m].
        below: what it costs where the elbow is below the line from shoulder to tip, see ``BELOW``.
    """

    shoulder: Array
    axes: Array
    reach: float
    below: float

    def elbow(self, points: Array, tip: Array) -> float:
        """Return how far joints (k, 3) are above the line from shoulder to tip in the mean, a share of the reach."""
        ahead, up = self.axes[0], self.axes[2]
        share = np.clip((points - self.shoulder) @ ahead / max(float((tip - self.shoulder) @ ahead), 1e-3), 0.0, 1.0)
        line = self.shoulder + share[:, None] * (tip - self.shoulder)
        return float(np.mean((points - line) @ up)) / self.reach

    def place(self, tip: Array) -> Array:
        """Return the place (3,) within the box that is nearest to a tip."""
        share = self.axes @ (tip - self.shoulder) / self.reach
        return np.asarray(self.shoulder + self.reach * np.clip(share, *BOX) @ self.axes)


def resting_posture(
    model: pin.Model, frame: str, limits: JointLimits, ahead: Array, given: Array | None = None
) -> Array:
    """Return a posture (n,) within the limits, its tool level and ahead as far as the robot can [rad, m].

    Args:
        model: of the robot, all of whose joints move, and turn about their z axes.
        frame: name of the frame at the tool's tip, whose z axis points away from the robot.
        limits: of its joints.
        ahead: (3,) which way is ahead, level, in the world.
        given: (n,) positions of joints that are chosen already, NaN of the others.
    """
    lower, upper = _usual(limits)
    if given is not None:
        chosen = np.isfinite(given)
        lower, upper = np.where(chosen, given, lower), np.where(chosen, given, upper)
    data, at = model.createData(), model.getFrameId(frame)
    spread = lower + evenly_spread(CANDIDATES, model.nq) * (upper - lower)
    aim = _aim(model, data, at, spread, ahead)

    def rank(q: Array) -> float:
        return _rank(model, data, at, q, lower, upper, aim)

    def led(q: Array) -> Array:
        return _led(model, data, at, q, lower, upper, aim)

    candidates = sorted(spread, key=rank, reverse=True)[:LED]
    best = sorted((led(q) for q in candidates), key=rank, reverse=True)[:KEPT]
    found = max((_bettered(q, led, rank, upper - lower) for q in best), key=rank)
    return np.asarray(np.clip(np.round(found, DIGITS), lower, upper))


def heading(T_world_base: Array) -> Array:
    """Return which way (3,) a base faces, level: along its x axis, or its z axis where that one is upright (a wall)."""
    x, z = T_world_base[:3, 0], T_world_base[:3, 2]
    level = np.array([x[0], x[1], 0.0]) if np.hypot(x[0], x[1]) > UPRIGHT else np.array([z[0], z[1], 0.0])
    return np.asarray(level / np.linalg.norm(level))


def _bettered(q: Array, led: Callable[[Array], Array], rank: Callable[[Array], float], ways: Array) -> Array:
    """Return a posture that steps in many directions, ever shorter ones, lead to."""
    found = rank(q)
    for number, step in enumerate(evenly_spread(STEPS, len(q)) - 0.5):
        trial = led(q + LONGEST_SHARE * (1.0 - number / STEPS) * step * ways)
        if (its := rank(trial)) > found:
            q, found = trial, its
    return q


def _usual(limits: JointLimits) -> tuple[Array, Array]:
    """Return the ranges within half a turn of zero, where a joint that turns further has such a part, and no ends."""
    lower, upper = np.maximum(limits.q_lower, -np.pi), np.minimum(limits.q_upper, np.pi)
    usable = upper > lower
    lower, upper = np.where(usable, lower, limits.q_lower), np.where(usable, upper, limits.q_upper)
    end = END * (upper - lower)
    return lower + end, upper - end


def _aim(model: pin.Model, data: pin.Data, at: int, spread: Array, ahead: Array) -> _Aim:
    turning = (1 + np.flatnonzero(~slides(model))).tolist()
    first, second = (turning[0], turning[min(1, len(turning) - 1)]) if turning else (1, 1)
    pin.forwardKinematics(model, data, spread.mean(axis=0))
    start, axis = data.oMi[first].translation.copy(), data.oMi[first].rotation[:, 2].copy()
    shoulder = start + axis * float(axis @ (data.oMi[second].translation - start))
    tips = []
    for q in spread:
        pin.framesForwardKinematics(model, data, q)
        tips.append(data.oMf[at].translation.copy())
    up = np.array([0.0, 0.0, 1.0])
    reach = float(np.linalg.norm(np.array(tips) - shoulder, axis=1).max())
    below = BELOW if abs(float(axis @ up)) > STANDING else 0.0
    return _Aim(shoulder, np.array([ahead, np.cross(up, ahead), up]), max(reach, 1e-3), below)


def _seen(model: pin.Model, data: pin.Data, at: int, q: Array, aim: _Aim) -> tuple[Array, Array]:
    """Return what is missing (6,) [shares of the reach, rad], and its slopes (6, n), in the aim's axes.

    The last row is the turn of the tool about itself where it points ahead, of which nothing is asked.
    """
    # Of a single joint it is a vector.
    slopes = pin.computeFrameJacobian(model, data, q, at, pin.LOCAL_WORLD_ALIGNED).reshape(6, -1)
    tip, tool = data.oMf[at].translation, data.oMf[at].rotation[:, 2]
    away = cross(tool, aim.axes[0])
    sine, cosine = float(np.linalg.norm(away)), float(tool @ aim.axes[0])
    # Where it points ahead there is nothing to turn, where it points straight back any way round will do.
    turn = away * (np.arctan2(sine, cosine) / sine) if sine > 1e-9 else aim.axes[2] * np.arctan2(sine, cosine)
    missing = np.concatenate([aim.axes @ (aim.place(tip) - tip) / aim.reach, aim.axes @ turn])
    turned = np.concatenate([aim.axes @ slopes[:3] / aim.reach, aim.axes @ slopes[3:]])
    order = [0, 1, 2, 4, 5, 3]
    return missing[order], turned[order]


def _led(model: pin.Model, data: pin.Data, at: int, q: Array, lower: Array, upper: Array, aim: _Aim) -> Array:
    """Return the posture that a candidate leads to."""
    q = np.clip(q, lower, upper)
    for _ in range(ITERATIONS):
        missing, slopes = (part[:ROWS] for part in _seen(model, data, at, q, aim))
        if np.abs(missing).max() < 1e-3:
            break
        step = slopes.T @ np.linalg.solve(slopes @ slopes.T + DAMPING * np.eye(ROWS), missing)
        longest = np.abs(step).max()
        q = np.clip(q + step * min(1.0, LONGEST_STEP / max(longest, 1e-9)), lower, upper)
    return q


def _rank(model: pin.Model, data: pin.Data, at: int, q: Array, lower: Array, upper: Array, aim: _Aim) -> float:
    """Return how good a posture is, from 0 on.

    The least that the tip moves for a given motion of the joints, in the direction in which it moves least, times the
    least room of a joint; less far from the middle of the ranges, where the tool is not where it should be, and where
    the elbow of an arm on a stand hangs.
    """
    missing, slopes = _seen(model, data, at, q, aim)
    moves = np.linalg.svd(slopes[:ROWS], compute_uv=False)[-1 if len(q) >= ROWS else len(q) - 1]
    free = upper > lower
    half = (upper - lower)[free] / 2.0
    low, high = (q - lower)[free], (upper - q)[free]
    room = float((np.minimum(low, high) / np.minimum(half, ROOM)).min(initial=1.0))
    off = float(np.mean((low / half - 1.0) ** 2)) if free.any() else 0.0
    miss = float(np.abs(missing[:ROWS]).max()) / NEAR
    points = np.array([data.oMi[i].translation for i in range(2, model.njoints)])
    elbow = min(0.0, aim.elbow(points, data.oMf[at].translation)) if aim.below and len(points) else 0.0
    return float((1e-3 + moves) * (0.05 + room) / (1.0 + off + 2.0 * miss) * np.exp(aim.below * elbow))
