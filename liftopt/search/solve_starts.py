"""Starts solved on the mesh that was asked for, until one is verified or it is known why none is.

If none is verified, the elastic mode finds the motion that breaks least. If it breaks nothing, it is one more start. If
it does, it says why there is no lift. If it cannot tell either, IPOPT takes over from the scenario's own solver.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.result import STOPPED, Solver, SolverResult
from liftopt.collocation.spline import RestToRestSpline
from liftopt.search.blocked import explain_blocked
from liftopt.search.cache import IPOPT
from liftopt.search.candidate import Candidate
from liftopt.search.found import Found
from liftopt.search.infeasibility import find_least_violation, infeasible_candidate
from liftopt.search.initial_guess import InitialGuess
from liftopt.search.keep_clear import first_clear
from liftopt.search.multistart import follow_up, solve_all
from liftopt.search.optimum_on_mesh import IPOPT_ITERATIONS
from liftopt.search.session import Session, start_record
from liftopt.solution.solution import StartRecord

IPOPT_STARTS = 2  # tried by IPOPT where the scenario's solver found nothing
Tried = list[tuple[InitialGuess, SolverResult]]


def solve_starts(session: Session, spline: RestToRestSpline, starts: Sequence[InitialGuess]) -> Found:
    """Return the best verified lift that the starts lead to, or the best iterate and why it is no lift.

    Args:
        session: of the search; it records every solve.
        spline: the mesh.
        starts: on that mesh, at least one, the most promising first.
    """
    problem, name = session.problem(spline), session.scenario.solver.name
    solvers = session.solvers(problem)
    tried = list(_solved(session, solvers, problem, starts))
    if len(starts) > 1:
        session.progress(f"solving on {spline.intervals} intervals: what comes of these")
        tried += follow_up(solvers[0], starts, [result for _, result in tried], session.deadline, problem)
    records = [start_record(start.name, result) for start, result in tried]
    found = _pick(session, problem, spline, tried)
    if not found.best.usable and (blocked := explain_blocked(session, spline)) is not None:
        session.records += records
        return blocked
    if not found.best.usable:
        found, more = _from_least_violation(session, found, starts, solvers[0])
        records += more
        stopped = any(record.status == STOPPED for record in records)
        if not (name == IPOPT or stopped or found.best.usable or found.best.infeasible):
            return _by_ipopt(session, found, starts, records)
    session.records += records
    return found


def _solved(
    session: Session,
    solvers: list[Solver],
    problem: Problem,
    starts: Sequence[InitialGuess],
    most: int | None = None,
) -> Iterator[tuple[InitialGuess, SolverResult]]:
    """Yield every start with its result, after ``most`` iterations of each at the latest."""
    results, intervals = solve_all(solvers, starts, session.deadline, problem, most=most), len(problem.mesh.phase) - 1
    for i, start in enumerate(starts):
        which = f" ({i + 1} of {len(starts)})" if len(starts) > 1 else ""
        session.progress(f"solving on {intervals} intervals: {start.name}{which}")
        yield start, next(results)


def _pick(session: Session, problem: Problem, spline: RestToRestSpline, tried: Tried) -> Found:
    """Verify candidates, the best first; return the first that is a lift, or the one that violates its limits least."""
    session.progress("verifying with Pinocchio")
    candidates = [Candidate(session.scenario, problem, spline, start.name, result) for start, result in tried]
    candidates = first_clear(session, sorted(candidates, key=_rank))
    candidates.sort(key=_rank)
    best = next((candidate for candidate in candidates if candidate.usable), None)
    if best is None:
        best = min(candidates, key=lambda candidate: candidate.verification.max_violation)
    return Found(best, tuple(candidates))


def _rank(candidate: Candidate) -> tuple[bool, float]:
    return not candidate.result.converged, candidate.result.objective


def _from_least_violation(
    session: Session, found: Found, starts: Sequence[InitialGuess], solver: Solver
) -> tuple[Found, list[StartRecord]]:
    """Return what was found with the reasons why it is no lift, or what the motion that breaks least leads to.

    The record of that start comes with it, if it led to a lift.
    """
    session.progress("looking for what is in the way")
    best = found.best
    problem, (first, *others) = best.problem, [start.x for start in starts]
    least = find_least_violation(problem, [first, best.result.x, *others], session.deadline)
    if least is None:
        return found, []
    start = InitialGuess("elastic", least.x)
    found = replace(found, reasons=least.reasons, near=(least.x,))
    if least.reasons:
        sure = infeasible_candidate(session.scenario, problem, best.spline, start, least.reasons)
        return (replace(found, best=sure) if least.sure else found), []
    result = solver.solve(start.x, deadline=session.deadline, problem=problem)
    candidate = Candidate(session.scenario, problem, best.spline, start.name, result)
    if not candidate.usable:
        return found, []
    return replace(found, best=candidate), [start_record(start.name, result)]


def _by_ipopt(session: Session, found: Found, starts: Sequence[InitialGuess], records: Sequence[StartRecord]) -> Found:
    """Return what IPOPT finds from the first starts; ``records`` tell what the scenario's solver made of them."""
    name, problem = session.scenario.solver.name, found.best.problem
    session.progress(f"the {name} solver found no solution ({records[0].status}): IPOPT takes over")
    ipopt = session.solver(problem, IPOPT)
    tried = list(_solved(session, [ipopt], problem, starts[:IPOPT_STARTS], IPOPT_ITERATIONS))
    session.records += [
        start_record(start.name, result, f" (IPOPT, after {name}: {record.status})")
        for (start, result), record in zip(tried, records, strict=False)
    ]
    return replace(_pick(session, problem, found.spline, tried), reasons=found.reasons, near=found.near)
