"""Mesh refinement: how far an answer is from the lift in continuous time, and finer meshes until that is near enough.

The objective falls at second order in the step, J(h) = J(0) + c h**2, by the trapezoid rule and as forces are linear
between knots. With zero acceleration at both ends (eq. 19) it falls at first order: that costs a ramp over one
interval, and nothing in continuous time. The optima on two meshes of steps h and r h give, for the order p,
J(0) = J(h) - (J(r h) - J(h)) / (r**p - 1) (Richardson). On coarse meshes higher orders count as well, so the other mesh
is the finer one where it can be had (``TELLING``). The residuals between knots fall at second order (balance, torques)
and faster (closure).

Two optima can be compared only if they are the same motion: from one, the other is solved on its own mesh, and if it
ends elsewhere there is no estimate. For the same reason each refinement starts not from the best optimum alone but
from all that the coarse mesh cannot tell from it: their order may change.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from liftopt.collocation.solvers.result import PRUNED, STOPPED, SolverResult
from liftopt.collocation.spline import FEWEST
from liftopt.collocation.transfer import transfer, transfer_multipliers
from liftopt.errors import SolverError
from liftopt.scenario.settings import Refine
from liftopt.search.cache import SolverCache
from liftopt.search.candidate import Candidate
from liftopt.solution.accuracy import OTHER_MOTION, Accuracy

if TYPE_CHECKING:
    from liftopt.search.solve import Search

Progress = Callable[[str], None]
FINEST = 400
# Of 16 lifts optima on N = 10, 20 and 40 were up to 0.3 apart in one basin, and in two from 0.6 to 6.
SAME_MOTION = 0.4  # [rad, m]
SURE = "ipopt"  # where another solver finds nothing; then it gets so many iterations from each start
SURE_ITERATIONS = 200
QUICKEST = ("banded", SURE)
MESH = ", N = "  # between the name of a start and the mesh its motion was taken to
# A mesh that starts are tried on is halved while so many intervals are left. Of 26 widely varied lifts on 80 intervals
# the optimum found from 10, 20 and 40 was 1.4, 0.7 and 0.7 % above the best of the three in the geometric mean, in 2.7,
# 3.5 and 6.1 s.
SCOUTED = 20
# A coarser mesh than this tells little of the limit: of 40 lifts on 20 intervals it was 0.6 % off in the median and
# 2.0 % at most with the mesh of half the intervals, 0.08 % and 0.27 % with that of twice as many.
TELLING = 20
# Optima further above the best one than this are not worth a solve on a finer mesh.
PROMISING = 1.1
AFRESH = ", afresh on "  # before the mesh to which the motion of a start was taken without its multipliers
SAME_OPTIMUM = 1e-4  # relative difference of two objectives


def estimate(cache: SolverCache, candidate: Candidate, deadline: float, progress: Progress) -> Accuracy:
    """Return the accuracy of a verified plan, from its optimum on twice as many intervals, or on half as many.

    Args:
        cache: where solvers come from.
        candidate: solved.
        deadline: ``time.monotonic`` value past which the objective is not estimated.
        progress: hears of it.
    """
    known, n = Accuracy.between_knots(candidate.verification), candidate.spline.intervals
    for intervals in (2 * n, n // 2):
        if FEWEST <= intervals <= FINEST and time.monotonic() < deadline:
            progress(f"estimating the error of the objective on {intervals} intervals")
            other = neighbour(cache, candidate, intervals, QUICKEST, deadline, progress)
            known = compared(candidate, other) if other is not None else known
            if known.estimated:
                break
    return known


def neighbour(
    cache: SolverCache,
    candidate: Candidate,
    intervals: int,
    solvers: Sequence[str],
    deadline: float,
    progress: Progress,
    incumbent: SolverResult | None = None,
    told: Callable[[str, SolverResult], None] | None = None,
    afresh: bool = False,
) -> Candidate | None:
    """Return the optimum that another one leads to on another mesh; None if no solver converges in time.

    Args:
        cache: where solvers come from.
        candidate: a converged one.
        intervals: of the other mesh.
        solvers: names, the first to be tried first.
        deadline: ``time.monotonic`` value past which solvers stop.
        progress: hears of kernels that are compiled.
        incumbent: an optimum on the other mesh; where nothing lower is in sight, or the solver fails, none is left.
        told: hears of the optimum, or that the rival stays the best, with the name of the start.
        afresh: start from the motion alone, not from its multipliers as well.
    """
    spline, scenario = candidate.spline.on(intervals), candidate.scenario
    problem = cache.problem(scenario, spline, progress)
    start = transfer(candidate.problem, candidate.spline, candidate.result.x, problem, spline)
    warm = None if afresh else transfer_multipliers(candidate.problem, candidate.result.multipliers, problem)
    origin, asked = candidate.start.partition(MESH)[0], scenario.solver.intervals
    origin += f"{AFRESH}{intervals}" if afresh else ""
    start_name = origin if intervals == asked else f"{origin}{MESH}{intervals}"
    for name in solvers:
        try:
            solver = cache.solver(problem, scenario, name, progress)
        except SolverError:  # an extension that is missing: the next one does
            continue
        most = None if name == solvers[0] else SURE_ITERATIONS
        result = solver.solve(start, deadline=deadline, warm=warm, problem=problem, incumbent=incumbent, most=most)
        if told and (result.converged or result.status == PRUNED):
            told(start_name, result)
        if result.converged:
            return Candidate(scenario, problem, spline, start_name, result, origin=candidate)
        if incumbent is not None or result.status in (STOPPED, PRUNED):
            break
    return None


def compared(candidate: Candidate, other: Candidate) -> Accuracy:
    """Return the accuracy of a verified plan, whose optimum on another mesh is ``other``."""
    known, apart = Accuracy.between_knots(candidate.verification), distance(candidate, other)
    known = replace(known, intervals=other.spline.intervals, apart=apart)
    here, there = candidate.result.objective, other.result.objective
    ratio = candidate.spline.intervals / other.spline.intervals
    limit = here - (there - here) / (ratio**candidate.spline.order - 1)
    if apart > SAME_MOTION or limit <= 0:
        return replace(known, remark=OTHER_MOTION.format(intervals=other.spline.intervals))
    finer = here if ratio > 1 else there
    return replace(
        known, objective_limit=limit, objective_error=here / limit - 1, objective_bar=abs(finer - limit), remark=""
    )


def distance(one: Candidate, other: Candidate) -> float:
    """Return how far two motions are apart: root mean square over time, of what differs most [rad, m]."""
    phase = np.linspace(0.0, 1.0, 4 * max(one.spline.intervals, other.spline.intervals) + 1)
    first, second = (
        candidate.spline.basis(phase) @ candidate.problem.unpack(candidate.result.x)[0] for candidate in (one, other)
    )
    return float(np.sqrt(np.mean((first - second) ** 2, axis=0)).max())


def unmet(accuracy: Accuracy, wanted: Refine) -> str:
    """Return what is not accurate enough, how much it is and how much is asked for, in one line; empty if all is."""
    figures = (
        ("estimated error of the objective", accuracy.objective_error, wanted.objective_error, 100.0, " %"),
        ("closure between knots", accuracy.closure, wanted.closure, 1e3, " mm"),
        ("balance between knots", accuracy.balance, wanted.balance, 1.0, " N, Nm"),
        ("torque above its limit between knots", accuracy.torque_excess, wanted.torque_excess, 1.0, " Nm"),
    )
    # A NaN is not met.
    return "; ".join(
        f"{name} {'unknown' if np.isnan(value) else f'{factor * value:.2g}{unit}'} ({factor * most:g}{unit} asked)"
        for name, value, most, factor, unit in figures
        if not value <= most
    )


def rivals(candidates: Sequence[Candidate], best: Candidate, accuracy: Accuracy) -> list[Candidate]:
    """Return the plans on one mesh that it cannot tell from the best one, this first, each optimum once.

    Their objectives are within the estimated error of the best one's; where there is no estimate, all are.
    """
    within = best.result.objective * (1 + (accuracy.objective_error if accuracy.estimated else np.inf))
    chosen = [best]
    for candidate in candidates:
        here = candidate.result.objective
        if candidate.result.converged and here <= within and not is_known(here, chosen):
            chosen.append(candidate)
    return chosen


def is_known(objective: float, candidates: Sequence[Candidate]) -> bool:
    """Return whether an optimum with that objective is among those on the same mesh."""
    return any(same_optimum(objective, candidate.result.objective) for candidate in candidates)


def each_once(candidates: Sequence[Candidate]) -> list[Candidate]:
    """Return the different optima among those on one mesh, the best first."""
    distinct: list[Candidate] = []
    for candidate in sorted(candidates, key=_objective):
        distinct += [] if is_known(candidate.result.objective, distinct) else [candidate]
    return distinct


def same_optimum(objective: float, other: float) -> bool:
    """Return whether two objectives on one mesh are of the same optimum."""
    return abs(objective - other) <= SAME_OPTIMUM * objective


def taken(search: Search, candidates: Sequence[Candidate], intervals: int, margin: float = 1.0) -> list[Candidate]:
    """Return the optima that others lead to on so many intervals, each once, the best first.

    Where an optimum of the coarse mesh is two on the finer one, its multipliers lead to that which presses against the
    same limits. So the solver starts once more from the motion of the best, without them: of 101 widely varied lifts 10
    gained by it from 10 to 20 intervals, up to 9 %.

    Args:
        search: hears of every solve.
        candidates: on another mesh, the best first.
        intervals: of the mesh they are taken to.
        margin: how many times the best objective is still of interest; what promises none below is left.
    """
    found: list[Candidate] = []
    solvers = tuple(dict.fromkeys((search.scenario.solver.name, SURE)))

    def solve(candidate: Candidate, afresh: bool = False) -> None:
        incumbent = None
        if found:
            best = min(found, key=_objective).result
            incumbent = replace(best, objective=margin * best.objective)
        there = neighbour(
            search.cache,
            candidate,
            intervals,
            solvers,
            search.deadline,
            search.progress,
            incumbent,
            search.record,
            afresh,
        )
        if there is not None and not (afresh and is_known(there.result.objective, found)):
            found.append(there)

    for candidate in candidates:
        search.progress(f"solving on {intervals} intervals: {candidate.start}")
        solve(candidate)
    origin = min(found, key=_objective).origin if found else None
    if origin is not None:
        search.progress(f"solving on {intervals} intervals afresh: {origin.start}")
        solve(origin, afresh=True)
    return each_once(found)


def finer(search: Search, candidates: Sequence[Candidate], intervals: int) -> Candidate | None:
    """Return the best verified optimum that others lead to on so many intervals; None if there is none.

    Meshes between, each twice as fine, are solved on the way: from the one before, an optimum takes a third of the
    iterations it takes from a motion alone.
    """
    for between in meshes_below(intervals):
        if candidates and between > candidates[0].spline.intervals:
            candidates = taken(search, candidates, between, PROMISING) or candidates
    search.candidates = taken(search, candidates, intervals)
    search.progress("verifying with Pinocchio")
    return next((candidate for candidate in search.candidates if candidate.solved or candidate.refinable), None)


def meshes_below(intervals: int) -> list[int]:
    """Return meshes of half as many intervals, again and again, the coarsest first."""
    meshes = [(intervals + 1) // 2]
    while meshes[0] >= 2 * SCOUTED:
        meshes.insert(0, (meshes[0] + 1) // 2)
    return meshes


def _objective(candidate: Candidate) -> float:
    return candidate.result.objective


def _accuracy(search: Search, candidate: Candidate, origin: Candidate | None) -> Accuracy:
    """Return the accuracy of a plan beside where it came from, or where that tells little beside another mesh."""
    if origin is not None and origin.spline.intervals >= TELLING and (known := compared(candidate, origin)).estimated:
        return known
    return estimate(search.cache, candidate, search.deadline, search.progress)


def sharpened(search: Search, candidate: Candidate) -> tuple[Candidate, Accuracy]:
    """Return a solved plan and its accuracy, on a mesh as fine as its scenario asks for.

    The search goes from mesh to mesh, each twice as fine, until ``Refine`` is met, its time is over or the mesh is the
    finest there may be; what came of it is among its notes.
    """
    accuracy = _accuracy(search, candidate, candidate.origin)
    wanted, coarse = search.scenario.refine, candidate.spline.intervals
    if not wanted.on or not (first := unmet(accuracy, wanted)):
        return candidate, accuracy
    missing = first
    while missing and 2 * candidate.spline.intervals <= FINEST and time.monotonic() < search.deadline:
        intervals = 2 * candidate.spline.intervals
        best = finer(search, rivals(search.candidates, candidate, accuracy), intervals)
        if best is None or not best.solved:
            search.notes.append(f"no solution was found on {intervals} intervals")
            break
        origin = best.origin or candidate
        if origin is not candidate:
            search.notes.append(
                f"on {best.spline.intervals} intervals another local optimum is the best, with J = "
                f"{best.result.objective:.5g}; on {candidate.spline.intervals} it had "
                f"{origin.result.objective:.5g} where "
                f"{candidate.result.objective:.5g} was the best"
            )
        candidate, accuracy = best, _accuracy(search, best, origin)
        missing = unmet(accuracy, wanted)
    if candidate.spline.intervals > coarse:
        search.notes.append(f"mesh refined from N = {coarse} to {candidate.spline.intervals}: {first}")
    if missing:
        search.notes.append(f"not as accurate as asked for on {candidate.spline.intervals} intervals: {missing}")
    return candidate, accuracy
