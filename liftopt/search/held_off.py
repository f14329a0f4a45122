"""Held off: the same lift with the hands kept farther ahead, where the cheapest way leads through whoever lifts.

Nothing costs less than a load on the axis of the body, and where bodies may overlap the optimum has it there. Planes do
not lead out of so deep an overlap. Hands that must stay ahead of a limit take the object out first, with legs and trunk
at ease with that; the limit is that of the workspace, moved ahead step by step.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from liftopt.collocation.batch import Batch
from liftopt.collocation.problem import Problem
from liftopt.multibody.agent import HalfSpace
from liftopt.search.candidate import Candidate
from liftopt.search.make_clear import Clearer
from liftopt.types import Array

# The limit moves by so much, so many times [m].
STEP, STEPS = 0.08, 5
BEFORE_ENDS = 0.001  # it stays so far behind where the task places the hands [m]
ITERATIONS = 60  # of each solve


def held_off(clearer: Clearer, candidate: Candidate) -> Iterator[Candidate]:
    """Yield optima of the problem with the hands farther and farther ahead, as motions to start from.

    Args:
        clearer: gives solvers and the deadline.
        candidate: an optimum in which somebody has the object where the body is.
    """
    problem = replace(candidate.problem, planes=None) if candidate.problem.planes else candidate.problem
    nearest, farthest = _hands(problem, candidate.result.x)
    if not np.isfinite(nearest):
        return
    x = candidate.result.x
    for step in range(1, STEPS + 1):
        ahead = min(nearest + STEP * step, farthest - BEFORE_ENDS)
        limited = _limited(problem, ahead)
        result = clearer.solver(limited).solve(x, deadline=clearer.deadline, problem=limited, most=ITERATIONS)
        if result.converged:
            x = result.x
            yield replace(candidate, problem=problem, result=replace(result, converged=False))
        if ahead < nearest + STEP * step or clearer.deadline.passed:
            return


def _limited(problem: Problem, ahead: float) -> Problem:
    """Return the problem with the hands of those with a workspace so far within it [m]; only bounds differ."""
    agents = tuple(
        replace(agent, workspace=HalfSpace(agent.workspace.normal, agent.workspace.offset + ahead))
        if agent.workspace
        else agent
        for agent in problem.team.agents
    )
    return replace(problem, team=replace(problem.team, agents=agents))


def _hands(problem: Problem, x: Array) -> tuple[float, float]:
    """Return how far within its workspace a hand is at least, and where the task places it at the ends at least [m].

    Infinite where nobody has a workspace, or where the task leaves both ends free.
    """
    blocks = [block for block in problem.constraints.blocks if block.name == "workspace"]
    if not blocks:
        return np.inf, np.inf
    g = Batch(problem).rows(x[None])[0]
    within = np.min([g[block.rows] - block.lower for block in blocks], axis=0)
    fixed = [within[k] for k, pose in ((0, problem.task.start), (-1, problem.task.end)) if not np.isnan(pose[:2]).all()]
    return float(within.min()), float(min(fixed, default=np.inf))
