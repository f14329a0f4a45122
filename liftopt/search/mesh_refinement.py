"""Mesh refinement: optima on meshes of twice the intervals, until they are verified and as accurate as asked for.

The order of optima may change from mesh to mesh. So each refinement starts from all optima that the coarse mesh cannot
tell from the best one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Protocol, TypeVar

from liftopt.collocation.solvers.deadline import Deadline
from liftopt.collocation.spline import FINEST, RestToRestSpline
from liftopt.collocation.transfer import transfer
from liftopt.search.cache import IPOPT
from liftopt.search.candidate import Candidate
from liftopt.search.elastic_clearing import cleared_elastically
from liftopt.search.found import Found
from liftopt.search.initial_guess import InitialGuess
from liftopt.search.make_clear import pairs_in
from liftopt.search.mesh_accuracy import TELLING, compared, estimate, unmet
from liftopt.search.optima import PROMISING, each_once, indistinguishable, is_known, objective_of
from liftopt.search.optimum_on_mesh import optimum_on_mesh
from liftopt.search.session import Session
from liftopt.search.solve_starts import solve_starts
from liftopt.solution.accuracy import Accuracy
from liftopt.solution.verify import CLOSURE_BETWEEN_KNOTS

# A mesh that starts are tried on is halved while so many intervals are left: a coarser one leads to worse optima, a
# finer one takes longer (docs/tuning.md).
COARSE = 20
KEPT_CLEAR = ", kept clear"  # after the name of a start


class _OnMesh(Protocol):
    @property
    def spline(self) -> RestToRestSpline: ...


T = TypeVar("T", bound=_OnMesh)


def refine_while(
    coarse: T,
    too_coarse: Callable[[T], object],
    refine: Callable[[T, int], T | None],
    deadline: Deadline,
    finest: int = FINEST,
) -> T:
    """Double the intervals of a mesh, again and again, while what stands on it is too coarse; return what comes out.

    Args:
        coarse: what stands on the first mesh.
        too_coarse: whether it needs a finer mesh.
        refine: makes it anew on so many intervals; None where that fails, which ends the refinement.
        deadline: past which no other mesh is begun.
        finest: intervals of the finest mesh.
    """
    while too_coarse(coarse) and 2 * coarse.spline.intervals <= finest and not deadline.passed:
        fine = refine(coarse, 2 * coarse.spline.intervals)
        if fine is None:
            break
        coarse = fine
    return coarse


def refine_mesh(session: Session, candidates: Sequence[Candidate], intervals: int) -> Found | None:
    """Return the best verified optimum on so many intervals that candidates of another mesh lead to; None without one.

    Meshes between, each twice as fine, are solved on the way: that takes fewer iterations in all.
    """
    for between in meshes_below(intervals):
        if candidates and between > candidates[0].spline.intervals:
            candidates = continue_on_mesh(session, candidates, between, PROMISING) or candidates
    optima = continue_on_mesh(session, candidates, intervals)
    session.progress("verifying with Pinocchio")
    best = next((candidate for candidate in optima if candidate.usable), None)
    return Found(best, tuple(optima)) if best is not None else None


def meshes_below(intervals: int) -> list[int]:
    """Return meshes of half as many intervals, again and again, the coarsest first."""
    meshes = [(intervals + 1) // 2]
    while meshes[0] >= 2 * COARSE:
        meshes.insert(0, (meshes[0] + 1) // 2)
    return meshes


def continue_on_mesh(
    session: Session, candidates: Sequence[Candidate], intervals: int, margin: float = 1.0
) -> list[Candidate]:
    """Return the optima on so many intervals that candidates of another mesh lead to, each once, the best first.

    One optimum of a coarse mesh may be two on a finer one. Its multipliers then lead to the one that presses against
    the same limits. So the solver starts once more from the motion of the best, without them.

    Args:
        session: of the search; it records every solve.
        candidates: on another mesh, the best first.
        intervals: of the mesh they are taken to.
        margin: how many times the best objective is still of interest; a solve that promises none below is given up.
    """
    found: list[Candidate] = []
    solvers = tuple(dict.fromkeys((session.scenario.solver.name, IPOPT)))

    def solve(candidate: Candidate, without_multipliers: bool = False) -> None:
        incumbent = None
        if found:
            best = min(found, key=objective_of).result
            incumbent = replace(best, objective=margin * best.objective)
        apart = candidate.problem.planes is not None
        there = optimum_on_mesh(
            session.cache, candidate, intervals, solvers[:1] if apart else solvers, session.deadline,
            session.progress, incumbent, session.record, without_multipliers,
        )  # fmt: skip
        if there is None and apart and incumbent is None:
            there = elastic_on_mesh(session, candidate, intervals)
        if there is not None and not (without_multipliers and is_known(there.result.objective, found)):
            found.extend(made_clear(session, there))

    for candidate in candidates:
        session.progress(f"solving on {intervals} intervals: {candidate.start}")
        solve(candidate)
    origin = min(found, key=objective_of).origin if found else None
    if origin is not None:
        session.progress(f"solving on {intervals} intervals from the motion alone: {origin.start}")
        solve(origin, without_multipliers=True)
    return each_once(found)


def elastic_on_mesh(session: Session, candidate: Candidate, intervals: int) -> Candidate | None:
    """Return the clear optimum on so many intervals that the elastic mode leads to from a clear candidate, or None."""
    spline = candidate.spline.on(intervals)
    problem = session.problem(spline)
    clearer = session.clearer(problem)
    if clearer is None or session.deadline.passed:
        return None
    x = transfer(candidate.problem, candidate.spline, candidate.result.x, problem, spline)
    start = Candidate(session.scenario, problem, spline, candidate.start, replace(candidate.result, x=x))
    watched = frozenset(pairs_in(clearer.solids, candidate.problem.planes).tolist())
    attempt = cleared_elastically(clearer, start, watched)
    if attempt is None or not attempt.clear:
        return None
    session.record(f"{candidate.start}{KEPT_CLEAR}", attempt.candidate.result)
    return replace(attempt.candidate, origin=candidate)


def made_clear(session: Session, candidate: Candidate) -> list[Candidate]:
    """Return the clear optimum that a candidate leads to, itself where solids may overlap; none if there is none."""
    clearer = session.clearer(candidate.problem)
    if clearer is None:
        return [candidate]
    attempt = clearer.make_clear(candidate)
    if attempt.clear and attempt.candidate is not candidate:
        session.record(f"{candidate.start}{KEPT_CLEAR}", attempt.candidate.result)
    return [attempt.candidate] if attempt.clear else []


def refine_until_verified(session: Session, found: Found) -> Found:
    """Return what was found, refined until the grasps also close between the knots."""

    def refine(coarse: Found, intervals: int) -> Found:
        candidate = coarse.best
        gap = candidate.verification.check("grasp closure between knots").value
        fine = refine_mesh(session, [candidate], intervals)
        if fine is None:
            spline = candidate.spline.on(intervals)
            x = transfer(candidate.problem, candidate.spline, candidate.result.x, session.problem(spline), spline)
            fine = solve_starts(session, spline, [InitialGuess("refined", x)])
        session.notes.append(
            f"mesh refined from N = {candidate.spline.intervals} to {intervals}: "
            f"grasp closure between knots was {1e3 * gap:.2f} mm, {1e3 * CLOSURE_BETWEEN_KNOTS:g} mm is allowed"
        )
        return fine

    return refine_while(found, lambda coarse: coarse.best.refinable, refine, session.deadline)


def refine_to_tolerance(session: Session, found: Found) -> Found:
    """Return a solved lift with its accuracy, refined until it is what the scenario asks for (``Refine``).

    It ends earlier where time is over or the mesh is the finest there may be. The notes say how it ended. What is not
    solved is returned as it is.
    """
    if not found.best.solved:
        return found
    wanted = session.scenario.refine
    found = replace(found, accuracy=_accuracy(session, found.best, found.best.origin))

    def missing(known: Found) -> str:
        return unmet(known.accuracy, wanted) if known.accuracy else ""

    first = missing(found)
    if not wanted.on or not first:
        return found

    def refine(coarse: Found, intervals: int) -> Found | None:
        best = coarse.best
        among = indistinguishable(coarse.others, best, coarse.accuracy) if coarse.accuracy else [best]
        fine = refine_mesh(session, among, intervals)
        if fine is None or not fine.best.solved:
            session.notes.append(f"no solution was found on {intervals} intervals")
            return None
        origin = fine.best.origin or best
        if origin is not best:
            session.notes.append(
                f"on {intervals} intervals another local optimum is the best, with J = "
                f"{fine.best.result.objective:.5g}; on {best.spline.intervals} it had "
                f"{origin.result.objective:.5g} where {best.result.objective:.5g} was the best"
            )
        return replace(fine, accuracy=_accuracy(session, fine.best, origin))

    fine = refine_while(found, missing, refine, session.deadline)
    coarse, intervals = found.spline.intervals, fine.spline.intervals
    if intervals > coarse:
        session.notes.append(f"mesh refined from N = {coarse} to {intervals}: {first}")
    if left := missing(fine):
        session.notes.append(f"not as accurate as asked for on {intervals} intervals: {left}")
    return fine


def _accuracy(session: Session, candidate: Candidate, origin: Candidate | None) -> Accuracy:
    """Return the accuracy of a candidate by the one it came from, or by another mesh where that tells too little."""
    if origin is not None and origin.spline.intervals >= TELLING and (known := compared(candidate, origin)).estimated:
        return known
    return estimate(session.cache, candidate, session.deadline, session.progress)
