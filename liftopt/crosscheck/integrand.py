"""The objective's integrand at many points, as a CasADi expression, written apart from the NLP of the solve."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np

from liftopt.collocation.task import TILT, LiftTask
from liftopt.crosscheck.instant import FORCE_SIZE, Coordinates
from liftopt.multibody.agent import Agent, Comfort

ROLL, PITCH = 3, 4


def integrand(agents: Sequence[Agent], task: LiftTask, at: Coordinates, points: Any, tilts: Any) -> Any:
    """Return what the objective integrates (1, K) at points (n_y, K), unknowns as in ``Coordinates.sizes``.

    ``tilts`` (agents with a trunk that leans, K) are as ``Instant.tilt`` gives them.
    """
    q, _, a, force, moment, tau = ca.vertsplit(points, np.cumsum([0, *at.sizes]).tolist())
    total = task.acceleration_weight * task.pace * ca.sum1(a**2) + task.force_weight * ca.sum1(force**2)
    # A moment takes a pair of contact forces, the hand's breadth apart.
    twists: Any = ca.vertsplit(moment, FORCE_SIZE)
    turning = [grasp for agent in agents for grasp in agent.grasps if grasp.moments]
    for grasp, twist in zip(turning, twists, strict=True):
        total += task.force_weight / grasp.breadth**2 * ca.sum1(twist**2)
    first = 0
    for agent, weight, n in zip(agents, task.agent_weights, at.joints, strict=True):
        own, limits = slice(first, first + n), agent.limits
        used = _shares(tau[own, :], -limits.tau_lower, limits.tau_upper) if task.shares else tau[own, :]
        if agent.joint_weights is not None:
            used *= ca.repmat(ca.sqrt(ca.DM(agent.joint_weights)), 1, used.size2())
        total += weight * ca.sum1(used**2)
        if agent.spine is not None and task.spine_weight:
            below, above = (ca.repmat(ca.DM(side), 1, tau.size2()) for side in agent.spine)
            borne = tau[own, :] * ca.if_else(tau[own, :] > 0, above, below)
            total += task.spine_weight * ca.sum1(borne**2)
        if agent.comfort is not None and task.range_weight:
            total += task.range_weight * _discomfort(agent.comfort, q[own, :])
        first += n
    for row, lean in enumerate(agent.lean for agent in agents if agent.lean is not None):
        total += task.range_weight * (tilts[row, :] / (1.0 - np.cos(lean.room))) ** 2
    tilting = [at.n_joints + k for k, coordinate in enumerate(at.unlocked) if coordinate in (ROLL, PITCH)]
    return total + task.tilt_weight * ca.sum1((q[tilting, :] / TILT) ** 2) if tilting else total


def _discomfort(comfort: Comfort, q: Any) -> Any:
    away = q - ca.repmat(ca.DM(comfort.neutral), 1, q.size2())
    squared = _shares(away, comfort.room_lower, comfort.room_upper) ** 2
    return ca.mtimes(ca.DM(comfort.weight).T, squared**2) + ca.mtimes(ca.DM(comfort.square_weight).T, squared)


def _shares(values: Any, lower: Any, upper: Any) -> Any:
    """Return values (n, K) as shares of what there is on their side (n,) of zero."""
    below, above = (ca.repmat(ca.DM(1.0 / side), 1, values.size2()) for side in (lower, upper))
    return values * ca.if_else(values > 0, above, below)
