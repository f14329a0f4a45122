"""Hands that may turn farther on the object at first, and then step by step no farther than the scenario allows.

Where a grip that serves the one end hardly serves the other, clear postures within the limit are on branches that no
solver follows: an arm stretches and the trunk leans, which costs far more than a few degrees of a wrist do. With some
degrees more there are easy ones all the way, and the optimum that they lead to follows the limit as it closes.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from liftopt.collocation.problem import Problem
from liftopt.search.candidate import Candidate
from liftopt.search.make_clear import Clearer, pairs_in

FARTHER = np.radians(10.0)  # at first
STEP, SHORTEST = 0.25, 1.0 / 64.0  # shares of it by which the limit closes: the first, and one at which it is given up


def limits_turns(problem: Problem) -> bool:
    """Whether the angle of somebody's hand on the object is limited."""
    return any(block.name == "grasp_turn" for block in problem.constraints.blocks)


def with_turn(problem: Problem, farther: float) -> Problem:
    """Return the problem with hands that may turn farther on the object by so much [rad]; only bounds differ."""
    if not farther:
        return problem
    agents = []
    for agent in problem.team.agents:
        grasps = tuple(replace(g, max_turn=min(g.max_turn + farther, np.pi)) for g in agent.grasps)
        agents.append(replace(agent, grasps=grasps))
    return replace(problem, team=replace(problem.team, agents=tuple(agents)))


def turned_back(clearer: Clearer, problem: Problem, candidate: Candidate) -> Candidate | None:
    """Return the clear optimum within the limits that one with hands turned farther leads to, or None.

    Args:
        clearer: of the team.
        problem: the lift, without planes.
        candidate: clear, with hands that may turn ``FARTHER``.
    """
    left, step = 1.0, STEP
    while left and step > SHORTEST and not clearer.deadline.passed:
        share = max(left - step, 0.0)
        motion = replace(
            candidate,
            problem=with_turn(problem, share * FARTHER),
            result=replace(candidate.result, converged=False),
        )
        also = frozenset(pairs_in(clearer.solids, candidate.problem.planes).tolist())
        attempt = clearer.make_clear(motion, also=also)
        if attempt.clear:
            candidate, left = attempt.candidate, share
        else:
            step /= 2.0
    return None if left else candidate
