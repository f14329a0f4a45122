"""The main job, a scenario in and a verified optimal lift out, told on one page.

1. Postures at both ends of the lift give initial guesses (``initial_guesses``). Where a little strength is missing to
   hold still there, those of somewhat more strength do (``begun_falling``).
2. Many of them are solved on a coarse mesh, and the best optima are varied (``coarse_search``). Where bodies overlap in
   them they are kept apart (``keep_clear``); where that cannot be done, ``explain_blocked`` says which are in the way.
3. The best of these are taken to the mesh that was asked for and verified there (``refine_mesh``).
4. If nothing is verified, a few guesses are solved on that mesh itself (``solve_starts``), then many more on the coarse
   one (``search_wider``).
5. A verified lift is refined until it is as accurate as asked for (``refine_to_tolerance``).
6. If there is none, the solution carries the reasons, and changes of the scenario that would help
   (``suggest_changes``).
"""

from __future__ import annotations

from dataclasses import replace

from liftopt.assessment.assess import assessed
from liftopt.collocation.problem import Problem
from liftopt.scenario.model import Scenario
from liftopt.search.begun_falling import begun_falling
from liftopt.search.blocked import explain_blocked
from liftopt.search.cache import SolverCache
from liftopt.search.coarse_search import coarse_search
from liftopt.search.feasibility_screen import too_fast
from liftopt.search.found import Found
from liftopt.search.infeasibility import infeasible_candidate, nearest_motion
from liftopt.search.initial_guess import InitialGuessSet, initial_guesses, naive_guess
from liftopt.search.mesh_refinement import refine_mesh, refine_to_tolerance, refine_until_verified
from liftopt.search.session import Session
from liftopt.search.solve_starts import solve_starts
from liftopt.search.standing import standing_overlaps
from liftopt.search.suggested_changes import suggest_changes
from liftopt.solution.solution import Solution
from liftopt.types import Progress

# Seeds of the posture search for each start tried on a coarse mesh: with one, some lifts miss the best motion
# (docs/tuning.md).
SEEDS_A_TRY = 2
# Before a lift with postures at both ends counts as impossible, so many times as many starts are tried, each for so
# many iterations: half of those that converge take fewer.
WIDER, LEAN = 2, 60


def solve(scenario: Scenario, *, progress: Progress | None = None, cache: SolverCache | None = None) -> Solution:
    """Solve a scenario from several starts and return the best verified solution.

    Where there is none, the solution says why in ``status`` and holds the best iterate.

    Args:
        scenario: what to lift.
        progress: called with one line at a time about what is going on.
        cache: keeps what the next lift can use again; None keeps nothing.

    Raises:
        InputError: a value of the scenario cannot be used.
        SolverError: the solver cannot run at all.
    """
    session = Session(scenario, cache or SolverCache(), progress)
    found = find_lift(session)
    return assessed(solution_of(session, found) if found.best.solved else explain(session, found))


def find_lift(session: Session) -> Found:
    """Return the best verified lift, on a mesh as fine as it takes, or the best iterate and why it is no lift."""
    return refine_to_tolerance(session, refine_until_verified(session, search(session)))


def search(session: Session) -> Found:
    """Return the best lift on the scenario's own mesh, or the best iterate and why it is no lift."""
    spline, problem, options = session.spline, session.problem(session.spline), session.scenario.solver
    if reasons := standing_overlaps(session, problem):
        best = infeasible_candidate(session.scenario, problem, spline, naive_guess(problem), reasons)
        return Found(best, reasons=reasons)
    tries = max(options.starts, options.tries) if options.tries else 0
    guesses = _guesses(session, problem, tries or options.starts, options.seed, tries)
    if guesses is None or too_fast(problem):
        session.progress("looking for what is in the way")
        nearest, reasons = nearest_motion(problem, options.seed, session.deadline, session.postures)
        if reasons:
            if (found := begun_falling(session, spline, reasons, tries, SEEDS_A_TRY * tries)) is not None:
                return found
            best = infeasible_candidate(session.scenario, problem, spline, nearest, reasons)
            return Found(best, reasons=reasons)
        starts = [nearest]
    else:
        session.begin_solving()
        optima = coarse_search(session, spline, guesses, tries)
        session.finish()
        if optima and (found := refine_mesh(session, optima, spline.intervals)) is not None:
            return found
        if (found := explain_blocked(session, spline)) is not None:
            return found if found.best.usable or session.detoured else search_wider(session) or found
        starts = guesses.starts(problem, options.starts)
    session.finish()
    session.begin_solving()
    found = solve_starts(session, spline, [*starts, naive_guess(problem)][: options.starts])
    return found if found.best.usable or session.detoured or guesses is None else search_wider(session) or found


def search_wider(session: Session) -> Found | None:
    """Return the best lift that many more starts lead to; None if they lead to none.

    Where postures hold the object at both ends there may be a lift, even if no start has led to one so far.
    """
    tries, seed = WIDER * session.scenario.solver.tries, session.scenario.solver.seed + 1
    if not tries or session.deadline.passed:
        return None
    problem, blocked = session.problem(session.spline), bool(session.blocked)
    guesses = _guesses(session, problem, tries, seed, tries)
    if guesses is None:
        return None
    optima = coarse_search(session, session.spline, guesses, tries, LEAN)
    if optima:
        return refine_mesh(session, optima, session.spline.intervals)
    if blocked and not session.blocked:  # there is no coarser mesh; other postures may be clear
        found = solve_starts(session, session.spline, guesses.starts(problem, tries))
        return found if found.best.usable else None
    return None


def _guesses(session: Session, problem: Problem, most: int, seed: int, tries: int) -> InitialGuessSet | None:
    """Return initial guesses from postures at both ends, enough of them for so many tries on a coarse mesh."""
    postures = session.postures
    return initial_guesses(problem, most, seed, session.deadline, session.progress, postures, SEEDS_A_TRY * tries)


def explain(session: Session, found: Found) -> Solution:
    """Return the best iterate as a solution, with the reasons why it is no lift and changes that would help."""
    session.progress(found.best.outcome)
    changes = suggest_changes(session, found)
    return replace(solution_of(session, found), reasons=found.reasons, suggested_changes=changes)


def solution_of(session: Session, found: Found) -> Solution:
    """Return the best candidate as a solution, with the records, notes and times of its session."""
    best = found.best
    best.verification  # noqa: B018  (its time belongs to the total)
    session.note_time()
    solution = best.solution(session.records, session.seconds, tuple(session.notes))
    if session.cut and not best.solved:
        solution = replace(solution, outcome=f"{solution.status}; {session.cut}")
    return replace(solution, accuracy=found.accuracy)
