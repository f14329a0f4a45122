"""Coarse search: many starts on a coarse mesh, of which the best optima are taken to the mesh that was asked for.

The coarse mesh has half as many intervals, or half of that again until they are few (``meshes_below``). A solve costs
less there, its optimum is a warm start on a finer mesh, and it tells good motions from bad ones far better than their
ranking does (``moves.py``). ``docs/tuning.md`` has the figures behind the constants.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.result import SolverResult
from liftopt.collocation.spline import FEWEST, RestToRestSpline
from liftopt.errors import SolverError
from liftopt.search.cache import BANDED
from liftopt.search.candidate import Candidate
from liftopt.search.initial_guess import InitialGuess, InitialGuessSet
from liftopt.search.keep_clear import keep_clear
from liftopt.search.mesh_refinement import meshes_below
from liftopt.search.multistart import follow_up, solve_all
from liftopt.search.optima import each_once, same_optimum
from liftopt.search.optimum_on_mesh import MESH
from liftopt.search.session import Session
from liftopt.search.variations import vary

# A start is given up where it promises nothing below so many times the optimum of the first. A margin finds more: in
# heavy or long lifts the objective falls late.
MARGIN = 1.2
# Variations end after so many without a gain, for each try: the first times the chance that a start leads to an optimum
# not known yet (``_unseen``), at most the second. Where that chance is small, variations gain little.
IDLE, MOST_IDLE = 6.0, 2.0
# Variations in all, for each try: where gain follows gain, more would take longer than all the rest.
MOST_VARIED = 8
# Share of the objective that KKT errors may reach here: optima need only be compared.
ROUGH = 1e-5


def coarse_search(
    session: Session, spline: RestToRestSpline, guesses: InitialGuessSet, tries: int, most: int | None = None
) -> list[Candidate]:
    """Return the optima on a coarse mesh that may lead to the best one, the best first; none if none was found.

    Args:
        session: of the search.
        spline: the mesh that was asked for.
        guesses: where to start from.
        tries: starts to be tried.
        most: iterations of each start; None: as many as the solver takes.
    """
    options, intervals = session.scenario.solver, meshes_below(spline.intervals)[0]
    if intervals < FEWEST or not tries:
        return []
    coarse = spline.on(intervals)
    problem = session.problem(coarse)
    starts = guesses.starts(problem, tries)
    session.progress(f"trying {len(starts)} starts on {intervals} intervals")
    try:
        solvers = [session.solver(problem, BANDED, i, ROUGH) for i in range(min(options.workers, len(starts)))]
    except SolverError:  # an extension that is missing: the search goes on without
        return []
    deadline = session.deadline
    results = list(solve_all(solvers, starts, deadline, problem, MARGIN, most))
    tried = list(zip(starts, results, strict=True)) + list(follow_up(solvers[0], starts, results, deadline, problem))
    optima, plain = _optima(session, problem, coarse, tried), len(tried)
    if optima:
        session.progress(f"varying the best of {len(optima)} optima")
        results = [candidate.result for candidate in optima]
        # A wider search, of more tries than the scenario's, is for lifts that nothing was found for: any will do.
        share = min(tries, options.tries)
        idle, varied = min(IDLE * _unseen(tried), MOST_IDLE) * share, MOST_VARIED * share
        tried += vary(solvers, problem, session.postures, results, idle, options.seed, deadline, varied)
        optima = _optima(session, problem, coarse, tried)
    chosen = keep_clear(session, optima, ROUGH)
    session.notes.append(
        f"{plain} starts and {len(tried) - plain} variations on {intervals} intervals led to {len(optima)} optima; "
        f"the best {len(chosen)} were taken to {spline.intervals}"
    )
    return chosen


def _optima(
    session: Session, problem: Problem, spline: RestToRestSpline, tried: Sequence[tuple[InitialGuess, SolverResult]]
) -> list[Candidate]:
    """Return the optima found, the best first, each once."""
    mesh = f"{MESH}{spline.intervals}"
    return each_once(
        [
            Candidate(session.scenario, problem, spline, f"{start.name}{mesh}", result)
            for start, result in tried
            if result.converged
        ]
    )


def _unseen(tried: Sequence[tuple[InitialGuess, SolverResult]]) -> float:
    """Return the chance that one more start leads to an optimum that none has led to so far.

    It is about the share of the starts that led where no other did (Good, Biometrika 40, 237-264, 1953).
    """
    found = sorted(result.objective for _, result in tried if result.converged)
    apart = [True, *(not same_optimum(high, low) for low, high in pairwise(found)), True]
    return sum(before and after for before, after in pairwise(apart)) / max(1, len(found))
