"""Mirrored joints: a motion with one joint bent the other way, as an elbow may be, that carries the object alike."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pinocchio as pin

from liftopt.collocation.problem import Problem
from liftopt.multibody.agent import Agent
from liftopt.search.initial_guess import MISSED, InitialGuess
from liftopt.types import Array

# A joint that is nearly straight [rad] has no other way to bend; axes with less than this between them are parallel.
STRAIGHT, PARALLEL = 0.15, 1e-6
HALF_TURN, WHOLE_TURN = (np.pi, -np.pi), (0.0, 2 * np.pi, -2 * np.pi)


def mirrored_joints(problem: Problem, x: Array) -> Iterator[InitialGuess]:
    """Yield a motion with one joint bent the other way and its neighbours half a turn on, where their ranges allow.

    That leaves the orientation of what they carry as it is, and its place but for the offsets between the axes: another
    way to hold much the same, as of an elbow or a wrist.
    """
    for i, agent in enumerate(problem.team.agents):
        columns = problem.layout.control[:, problem.layout.columns(i)]
        lower, upper = agent.limits.q_lower, agent.limits.q_upper
        between = neighbours(agent)
        for j, straight in enumerate(in_line(agent)):
            q = x[columns]
            if not np.abs(q[:, j] - straight).mean() >= STRAIGHT:  # a NaN is not
                continue
            q[:, j] = 2 * straight - q[:, j]
            before, after = between[j]
            for k, turns in ((before, HALF_TURN), (j, WHOLE_TURN), (after, HALF_TURN)):
                q[:, k] = min((q[:, k] + turn for turn in turns), key=lambda c: _outside(c, lower[k], upper[k]))
            if max(_outside(*joint) for joint in zip(q.T, lower, upper, strict=True)) > MISSED:
                continue
            y = x.copy()
            y[columns] = np.clip(q, lower, upper)
            yield InitialGuess(f"{agent.name} mirrored at joint {j + 1}", y)


def in_line(agent: Agent) -> Array:
    """Return the angle (n,) of each joint at which the axes of its neighbours are parallel; NaN where there is none."""
    model, found = agent.reduced(), np.full(len(agent.posture), np.nan)
    axes = pin.computeJointJacobians(model, model.createData(), np.zeros(model.nq)).reshape(6, -1)[3:].T
    for j, ends in neighbours(agent).items():
        before, after = (axes[k] - axes[j] * (axes[k] @ axes[j]) for k in ends)
        if min(np.linalg.norm(before), np.linalg.norm(after)) > PARALLEL:
            found[j] = np.arctan2(axes[j] @ np.cross(after, before), after @ before)
    return found


def neighbours(agent: Agent) -> dict[int, tuple[int, int]]:
    """Return which joints come before and after each joint; of those with a joint before and just one after."""
    parents, found = agent.reduced().parents.tolist(), {}
    for joint in range(1, len(parents)):
        after = [j for j, parent in enumerate(parents) if parent == joint]
        if parents[joint] and len(after) == 1:
            found[joint - 1] = (parents[joint] - 1, after[0] - 1)
    return found


def _outside(q: Array, lower: float, upper: float) -> float:
    """Return how far a joint is outside its range [rad], a mean over time."""
    return float(np.maximum(0.0, np.maximum(q - upper, lower - q)).mean())
