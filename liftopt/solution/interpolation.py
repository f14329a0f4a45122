"""The motion between the knots: a solution on a finer grid, exactly as the collocation meant it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from liftopt.multibody.trajectory import agent_trajectory, object_trajectory
from liftopt.scenario.build import agents_of, object_of
from liftopt.solution.checks import FINER
from liftopt.solution.solution import Solution
from liftopt.types import Array


def between_knots(solution: Solution) -> Solution:
    """Return ``solution`` on the grid on which all peaks are taken, ten times as fine as its mesh.

    Limits hold at the knots only, so that a peak between them can be larger than any at them.
    """
    return resample(solution, FINER)


def resample(solution: Solution, factor: int) -> Solution:
    """Return ``solution`` at ``factor`` times as many intervals; the knots stay among the times.

    Accelerations and grasp forces are linear between knots, so that velocities and positions follow exactly; torques
    and ground reaction are RNEA's on that motion. Objective and verification stay those of the knots.
    """
    time = _finer(solution.time, factor)
    agents, forces, moments = [], [], []
    for model, agent in zip(agents_of(solution.scenario, solution.urdfs), solution.agents, strict=True):
        q, v, a = motion_between(solution.time, agent.q, agent.v, agent.a, time)
        force, moment = (
            linear(solution.time, each.reshape(len(each), -1), time) for each in (agent.grasp_force, agent.grasp_moment)
        )
        moving, model = agent.moving, replace(model, remarks=agent.remarks)
        agents.append(agent_trajectory(model, q[:, moving], v[:, moving], a[:, moving], force, moment))
        forces.append(force)
        moments.append(moment)
    lifted = solution.object
    motion = motion_between(solution.time, lifted.pose, lifted.pose_velocity, lifted.pose_acceleration, time)
    return replace(
        solution,
        time=time,
        agents=tuple(agents),
        object=object_trajectory(
            object_of(solution.scenario, solution.urdfs), *motion, np.hstack(forces), np.hstack(moments)
        ),
    )


def motion_between(knots: Array, q: Array, v: Array, a: Array, time: Array) -> tuple[Array, Array, Array]:
    """Return q, v, a (T, n) at ``time`` (T,) from their values (K, n) at ``knots`` (K,), a linear between them."""
    left = np.clip(np.searchsorted(knots, time, side="right") - 1, 0, len(knots) - 2)
    s = (time - knots[left])[:, None]
    jerk = (a[left + 1] - a[left]) / (knots[left + 1] - knots[left])[:, None]
    return (
        q[left] + s * (v[left] + s * (a[left] / 2 + s * jerk / 6)),
        v[left] + s * (a[left] + s * jerk / 2),
        a[left] + s * jerk,
    )


def linear(knots: Array, values: Array, time: Array) -> Array:
    """Return values (T, n) at ``time`` (T,), linear between theirs (K, n) at ``knots`` (K,), constant outside."""
    return np.stack([np.interp(time, knots, column) for column in values.T], axis=1)


def _finer(knots: Array, factor: int) -> Array:
    steps = np.linspace(0.0, 1.0, factor, endpoint=False)
    inner = (knots[:-1, None] + steps * np.diff(knots)[:, None]).ravel()
    return np.append(inner, knots[-1])
