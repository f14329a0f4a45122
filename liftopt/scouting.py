"""Scouting: many starts on half the intervals, of which the best optima are taken to the mesh that was asked for.

The coarse mesh costs half as much a solve, and an optimum of it is a warm start on the fine one. It tells good motions
from bad ones: of 24 starts of each of 53 widely varied lifts, the four with the best optima on eight intervals led to
within 5 % of the best of all 24 in 50 lifts, the four most promising ones (``moves.py``) in 32.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import TYPE_CHECKING

from liftopt.collocation.guess import Repertoire, Start
from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.result import Solver, SolverResult
from liftopt.collocation.spline import FEWEST, RestToRestSpline
from liftopt.errors import SolverError
from liftopt.multistart import bent_otherwise, follow_up, solve_all
from liftopt.plan import Plan
from liftopt.refinement import MESH, QUICKEST, is_known

if TYPE_CHECKING:
    from liftopt.lift import Search

# Of the time that is left for solving.
SCOUTING_SHARE = 0.5
# Optima further above the best one than this are not worth a solve on the fine mesh.
PROMISING = 1.1
# A scout is given up where it promises nothing below so many times the optimum of the first. A margin finds more: of
# heavy or long lifts the objective falls late.
MARGIN = 1.2
# For so many scouts one of their optima, the best first, within so many times the best is tried with joints bent
# otherwise: of 101 widely varied lifts 78 came within 5 % of the best known with 24 scouts and four optima so tried,
# 68 without, 79 with 48 scouts without.
SCOUTS_A_MIRROR, NEAR = 6, 1.2
# Share of the objective that scouts' KKT errors may reach: the iterations that are saved are a fifth.
ROUGH = 1e-5


def scout(search: Search, found: Repertoire, tries: int) -> list[Plan]:
    """Return the optima on half the intervals that may lead to the best one, the best first; none if none was found.

    Args:
        search: on the mesh that was asked for.
        found: where to start from.
        tries: starts to be tried.
    """
    scenario, intervals = search.scenario, (search.spline.intervals + 1) // 2
    if intervals < FEWEST or not tries:
        return []
    spline = RestToRestSpline(intervals)
    problem = search.workshop.problem(scenario, spline, search.say)
    starts = found.starts(problem, tries)
    search.say(f"trying {len(starts)} starts on {intervals} intervals")
    try:
        solvers: list[Solver] = [
            search.workshop.solver(problem, scenario, QUICKEST[0], search.say, i, ROUGH)
            for i in range(min(scenario.solver.workers, len(starts)))
        ]
    except SolverError:  # an extension that is missing: the search goes on without
        return []
    until = time.monotonic() + SCOUTING_SHARE * (search.deadline - time.monotonic())
    results = list(solve_all(solvers, starts, until, problem, MARGIN))
    tried = list(zip(starts, results, strict=True)) + list(follow_up(solvers[0], starts, results, until, problem))
    optima = _distinct(search, problem, spline, tried)
    best = [plan.result for plan in optima if plan.result.objective <= NEAR * optima[0].result.objective]
    tried += bent_otherwise(solvers[0], best[: tries // SCOUTS_A_MIRROR], until, problem)
    optima = _distinct(search, problem, spline, tried)
    near = [plan for plan in optima if plan.result.objective <= PROMISING * optima[0].result.objective]
    chosen = near[: scenario.solver.starts]
    search.notes.append(
        f"{len(tried)} starts on {intervals} intervals led to {len(optima)} optima; "
        f"the best {len(chosen)} were taken to {search.spline.intervals}"
    )
    return chosen


def _distinct(
    search: Search, problem: Problem, spline: RestToRestSpline, tried: Sequence[tuple[Start, SolverResult]]
) -> list[Plan]:
    """Return the optima found, the best first, each once."""
    optima: list[Plan] = []
    for start, result in sorted(tried, key=lambda pair: pair[1].objective):
        if result.converged and not is_known(result.objective, optima):
            name = f"{start.name}{MESH}{spline.intervals}"
            optima.append(Plan(search.scenario, problem, spline, name, result))
    return optima
