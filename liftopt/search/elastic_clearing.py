"""A motion far from feasible made clear by way of the elastic mode.

Solvers seldom find their way from a motion that is only led past what it ran into: neither torques nor grasps are right
there. The elastic mode first brings it to where nothing is broken, with planes on the sides on which it passes.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from liftopt.search.candidate import Candidate
from liftopt.search.infeasibility import find_least_violation
from liftopt.search.make_clear import CLEAR, ITERATIONS, MARGIN, Attempt, Clearer, planes_along


def cleared_elastically(clearer: Clearer, candidate: Candidate, also: frozenset[int]) -> Attempt | None:
    """Return what comes of a motion that no solver made clear; None if what it breaks cannot be mended.

    Args:
        clearer: of its team.
        candidate: the motion, without planes.
        also: pairs that get planes though they may be apart.
    """
    problem, x = candidate.problem, candidate.result.x
    _, least = clearer.look(problem, candidate.spline, x)
    deep = frozenset(np.flatnonzero(least < clearer.asked - CLEAR).tolist())
    pairs = np.array(sorted(deep | also), dtype=np.int64)
    apart = problem.apart(planes_along(clearer.solids, problem, x, pairs, clearer.clearance, MARGIN, deep | also))
    near = find_least_violation(apart, [x], clearer.deadline)
    if near is None or near.reasons:
        return None
    result = clearer.solver(apart).solve(near.x, deadline=clearer.deadline, problem=apart, most=ITERATIONS)
    if not result.converged:
        return None
    return clearer.make_clear(replace(candidate, problem=apart, result=result), polish=False)
