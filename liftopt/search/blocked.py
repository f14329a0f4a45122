"""Where no optimum can be made clear: which bodies are in each other's way, and by how much."""

from __future__ import annotations

import numpy as np

from liftopt.collocation.spline import RestToRestSpline
from liftopt.collocation.transfer import transfer
from liftopt.search.candidate import Candidate
from liftopt.search.found import Found
from liftopt.search.infeasibility import find_least_violation, infeasible_candidate
from liftopt.search.initial_guess import InitialGuess, blend
from liftopt.search.make_clear import Attempt, planes_along
from liftopt.search.session import Session

START, POSTURES = "elastic, kept clear", "postures that come least too near"


def explain_blocked(session: Session, spline: RestToRestSpline) -> Found | None:
    """Return the motion that comes least too near on a mesh, with what is in the way; a lift if nothing is.

    The optimum that was the most promising one is taken, with planes on the sides that its overlaps ask for.

    Returns:
        None where there was no such optimum, or no time.
    """
    if not session.blocked or session.deadline.passed:
        return None
    session.progress("looking for what is in the way")
    if reasons := tuple(reason for end in session.held for reason in end.reasons):
        problem = session.problem(spline)
        x = blend(problem, *(end.postures[0] for end in session.held))
        best = infeasible_candidate(session.scenario, problem, spline, InitialGuess(POSTURES, x), reasons)
        return Found(best, reasons=reasons, near=(x,))
    attempt = session.blocked[0]
    free, problem = attempt.origin, session.problem(spline)
    x = transfer(free.problem, free.spline, free.result.x, problem, spline)
    clearer = session.clearer(problem)
    if clearer is None:
        return None
    pairs = np.array(sorted(attempt.deep), dtype=np.int64)
    planes = planes_along(clearer.solids, problem, x, pairs, clearer.clearance, 0.0, attempt.deep)
    apart = problem.apart(planes)
    least = find_least_violation(apart, [x], session.deadline)
    if least is None:
        return None
    start = InitialGuess(START, least.x)
    if least.reasons:
        best = infeasible_candidate(session.scenario, apart, spline, start, least.reasons)
        return Found(best, reasons=least.reasons, near=(least.x,))
    result = session.solver(apart, session.scenario.solver.name).solve(x, deadline=session.deadline)
    session.record(START, result)
    found = _cleared(session, Candidate(session.scenario, apart, spline, START, result))
    return Found(found) if found is not None else None


def _cleared(session: Session, candidate: Candidate) -> Candidate | None:
    clearer = session.clearer(candidate.problem)
    if clearer is None or not candidate.result.converged:
        return None
    attempt: Attempt = clearer.make_clear(candidate)
    return attempt.candidate if attempt.clear else None
