"""Held off: the same lift with the hands kept farther ahead, where the cheapest way leads through whoever lifts.

Nothing costs less than a load on the axis of the body, and where bodies may overlap the optimum has it there. Planes do
not lead out of so deep an overlap. Hands that must stay ahead of a limit take the object out first, with legs and trunk
at ease with that; the limit is that of the workspace, moved ahead step by step. Who folds so far that the chest is in
the thighs has less and less of the ranges of the joints between them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from liftopt.collocation.batch import Batch
from liftopt.collocation.problem import Problem
from liftopt.collocation.separating_planes import WORLD
from liftopt.collocation.solvers.result import SolverResult
from liftopt.multibody.agent import Agent, HalfSpace
from liftopt.search.candidate import Candidate
from liftopt.search.holder_sides import is_of_an_arm
from liftopt.search.make_clear import Clearer
from liftopt.search.team_solids import TeamSolids
from liftopt.types import Array

# The limit moves by so much, so many times [m]; each time joints lose such a share of how far they go.
STEP, STEPS, NARROWER = 0.08, 5, 0.1
BEFORE_ENDS = 0.001  # it stays so far behind where the task places the hands [m]
ITERATIONS = 60  # of each solve


def held_off(clearer: Clearer, candidate: Candidate, deep: Iterable[int]) -> Iterator[Candidate]:
    """Yield optima of the problem with hands farther and farther ahead, as motions to start from.

    Args:
        clearer: gives solvers and the deadline.
        candidate: an optimum without planes.
        deep: numbers of the pairs that overlap in it; none come where nobody has the object, or folds, in the body.
    """
    for result in led_ahead(clearer, candidate.problem, candidate.result.x, deep):
        yield replace(candidate, result=replace(result, converged=False))


def led_ahead(clearer: Clearer, problem: Problem, x: Array, deep: Iterable[int]) -> Iterator[SolverResult]:
    """Yield optima of a problem with hands farther and farther ahead, and less room to fold.

    Args:
        clearer: gives solvers and the deadline.
        problem: without planes.
        x: (n_x,) an optimum of it.
        deep: as for ``held_off``.
    """
    free, pairs = x, list(deep)
    folding = _folding(clearer.solids, pairs)
    nearest, farthest = _hands(problem, x) if _in_the_lap(clearer.solids, pairs) else (np.inf, np.inf)
    aside = not np.isfinite(nearest)
    for step in range(1, STEPS + 1):
        ahead = min(nearest + STEP * step, farthest - BEFORE_ENDS)
        limited = _limited(problem, 0.0 if aside else ahead, free, folding, 1.0 - NARROWER * step)
        if (not folding and (aside or ahead <= nearest + STEP * (step - 1))) or clearer.deadline.passed:
            return
        result = clearer.solver(limited).solve(x, deadline=clearer.deadline, problem=limited, most=ITERATIONS)
        if result.converged:
            x = result.x
            yield result


def _limited(problem: Problem, ahead: float, x: Array, folding: Sequence[tuple[int, int]], share: float) -> Problem:
    """Return the problem with less room, so that only bounds differ.

    Args:
        problem: the lift.
        ahead: by how much the hands of those with a workspace must be within it [m].
        x: the motion that tells how far joints go.
        folding: agent and column of joints that may go a share of that.
        share: of it.
    """
    agents = list(problem.team.agents)
    for i, agent in enumerate(agents):
        columns = [column for part, column in folding if part == i]
        q = x[problem.layout.control[:, problem.layout.columns(i)]]
        agents[i] = _with_room(agent, ahead, columns, share * q.min(axis=0), share * q.max(axis=0))
    return replace(problem, team=replace(problem.team, agents=tuple(agents)))


def _with_room(agent: Agent, ahead: float, columns: list[int], low: Array, high: Array) -> Agent:
    """Return an agent with the hands so far within its workspace, and joints no farther from zero than low and high."""
    lower, upper = agent.limits.q_lower.copy(), agent.limits.q_upper.copy()
    lower[columns] = np.maximum(lower, np.minimum(low, 0.0))[columns]
    upper[columns] = np.minimum(upper, np.maximum(high, 0.0))[columns]
    workspace = agent.workspace
    if workspace is not None:
        workspace = HalfSpace(workspace.normal, workspace.offset + ahead)
    return replace(agent, workspace=workspace, limits=replace(agent.limits, q_lower=lower, q_upper=upper))


def _in_the_lap(solids: TeamSolids, pairs: list[int]) -> bool:
    """Return whether the object overlaps with somebody among pairs by number."""
    ends = [{solids.bodies[s].part for s in solids.ends[pair]} for pair in pairs]
    return any(len(solids.team.agents) in parts and WORLD not in parts for parts in ends)


def _folding(solids: TeamSolids, pairs: list[int]) -> list[tuple[int, int]]:
    """Return agent and column of the joints between bodies of one agent that overlap, but for those of its arms."""
    found: set[tuple[int, int]] = set()
    for pair in pairs:
        one, other = (solids.bodies[s] for s in solids.ends[pair])
        if one.part != other.part or not 0 <= one.part < len(solids.team.agents):
            continue
        if is_of_an_arm(solids.team, one) or is_of_an_arm(solids.team, other):
            continue
        supports = solids.team.agents[one.part].reduced().supports
        between = np.setxor1d(supports[one.joint].tolist(), supports[other.joint].tolist())
        found |= {(one.part, int(joint) - 1) for joint in between}
    return sorted(found)


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
