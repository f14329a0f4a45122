"""The promising ones of the optima found, each made clear where bodies overlap in it.

Planes only raise an objective, so optima are taken in the order of theirs as long as they promise to lead below what is
clear already. The side on which a body passes another is chosen by the overlap; where that leads nowhere, others are
tried.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from liftopt.search.candidate import Candidate
from liftopt.search.clear_paths import paths_between
from liftopt.search.clear_postures import clear_ends, starts_between
from liftopt.search.elastic_clearing import cleared_elastically
from liftopt.search.held_off import held_off
from liftopt.search.make_clear import Attempt, Clearer
from liftopt.search.optima import PROMISING, each_once, is_known, objective_of
from liftopt.search.passing_paths import passing_paths
from liftopt.search.session import Session
from liftopt.search.turned_farther import FARTHER, limits_turns, turned_back, with_turn

# Optima that are tried for each that is wanted, where many cannot be made clear.
FAILING = 4
# Of those that failed, so many are led past what they ran into, or taken to its other sides.
PASSED = 2
# Pairs whose other side is tried, each alone: where many overlap, one of them decides little.
AVOIDED = 6
BETWEEN = 4  # motions between clear postures that are tried
ELASTIC = 3  # times that the elastic mode clears one of them, each with the pairs that the last one led into each other
HELD_OFF = 2  # clear optima that are wanted where the object is held off: the first may pass on a worse side


def keep_clear(session: Session, optima: Sequence[Candidate], rough: float) -> list[Candidate]:
    """Return the most promising optima, clear where the scenario asks for it, the best first.

    Args:
        session: of the search.
        optima: on one mesh, the best first, each once.
        rough: of the solvers, see ``SolverCache.solver``.
    """
    wanted = session.scenario.solver.starts
    clearer = session.clearer(optima[0].problem, rough) if optima else None
    session.blocked = []
    if clearer is None:
        return [c for c in optima if c.result.objective <= PROMISING * optima[0].result.objective][:wanted]
    found: list[Candidate] = []
    failed: list[Attempt] = []
    held_off_before = False
    for candidate in optima[: FAILING * wanted]:
        best = min(map(objective_of, found), default=None)
        if best is not None and (candidate.result.objective > PROMISING * best or len(found) == wanted):
            break
        if session.deadline.passed:
            break
        attempt = clearer.make_clear(candidate, polish=False)
        if attempt.clear:
            found += [] if is_known(attempt.candidate.result.objective, found) else [attempt.candidate]
        else:
            failed.append(attempt)
        if not found and len(failed) == wanted:
            held_off_before = True
            found = _out_of_the_lap(clearer, failed[:PASSED])
            if found:
                break
    if not found:
        session.blocked = failed
        found = _anyhow(session, clearer, failed[:PASSED], held_off_before)
        session.detoured = bool(failed) and not found
    if not found:
        return []
    return [c for c in each_once(found) if c.result.objective <= PROMISING * min(map(objective_of, found))]


def first_clear(session: Session, candidates: Sequence[Candidate]) -> list[Candidate]:
    """Return candidates of one mesh with the first of them made clear that can be, where the scenario asks for it.

    Args:
        session: of the search; it notes what cannot be made clear.
        candidates: those that converged first, the best first.
    """
    clearer = session.clearer(candidates[0].problem)
    if clearer is None:
        return list(candidates)
    session.blocked = []
    for n, candidate in enumerate(candidates):
        if not candidate.result.converged or session.deadline.passed:
            break
        attempt = clearer.make_clear(candidate)
        if attempt.clear:
            session.blocked = []
            return [*candidates[:n], attempt.candidate, *candidates[n + 1 :]]
        session.blocked.append(attempt)
    if session.detoured:  # what led nowhere on the coarse mesh leads nowhere here either
        return list(candidates)
    return [*_anyhow(session, clearer, session.blocked[:PASSED]), *candidates]


def _anyhow(
    session: Session, clearer: Clearer, failed: Sequence[Attempt], held_off_before: bool = False
) -> list[Candidate]:
    """Return clear optima that a detour leads to, from what the overlaps alone did not lead to any.

    Args:
        session: of the search.
        clearer: of the team.
        failed: what to start from.
        held_off_before: whether the object was held off in these before, to no avail.
    """
    if failed and not session.held:
        motions = [attempt.origin.result.x for attempt in failed]
        session.held = clear_ends(session, clearer, failed[0].origin.problem, motions)
    if session.blocked_at_rest:
        # What no posture was found for at one end, a path from the other one may lead to.
        found = _along_clear_postures(session, clearer, failed)
        session.held = () if found else session.held
        return found
    return (
        _passing(session, clearer, failed)
        or (not held_off_before and _out_of_the_lap(clearer, failed))
        or _other_sides(clearer, failed)
        or _between_clear_postures(session, clearer, failed)
        or _along_clear_postures(session, clearer, failed)
    )


def _between_clear_postures(session: Session, clearer: Clearer, failed: Sequence[Attempt]) -> list[Candidate]:
    """Return clear optima that motions between clear postures lead to."""
    found: list[Candidate] = []
    for first in failed[:1]:
        for start in starts_between(session, first.origin.problem, BETWEEN):
            if len(found) == HELD_OFF or session.deadline.passed:
                break
            result = replace(first.origin.result, x=start.x, converged=False)
            motion, also = replace(first.origin, start=start.name, result=result), first.deep
            attempt: Attempt | None = clearer.make_clear(motion, polish=False, also=also)
            for turn in range(ELASTIC):
                if attempt is None or attempt.clear or (turn and attempt.deep <= also):
                    break
                also |= attempt.deep
                attempt = cleared_elastically(clearer, motion, also)
            found += [attempt.candidate] if attempt is not None and attempt.clear else []
    return found


def _along_clear_postures(session: Session, clearer: Clearer, failed: Sequence[Attempt]) -> list[Candidate]:
    """Return clear optima that motions along clear postures, from one end to the other, lead to."""
    found: list[Candidate] = []
    for first in failed[:1]:
        origin = first.origin
        for start in paths_between(session, clearer, origin.problem, origin.spline):
            motion = replace(origin, start=start.name, result=replace(origin.result, x=start.x, converged=False))
            attempt = clearer.make_clear(motion, polish=False, also=first.deep)
            found += [attempt.candidate] if attempt.clear else []
            if len(found) == HELD_OFF:
                break
        if not found and limits_turns(origin.problem) and not session.blocked_at_rest:
            found = _turned_farther(session, session.clearer(origin.problem) or clearer, origin)
    return found


def _turned_farther(session: Session, clearer: Clearer, origin: Candidate) -> list[Candidate]:
    """Return the first clear optimum that paths lead to where hands may turn farther on the object at first."""
    eased = with_turn(origin.problem, FARTHER)
    for start in paths_between(session, clearer, eased, origin.spline, FARTHER):
        result = replace(origin.result, x=start.x, converged=False)
        attempt = clearer.make_clear(replace(origin, problem=eased, start=start.name, result=result), polish=False)
        found = turned_back(clearer, origin.problem, attempt.candidate) if attempt.clear else None
        if found is not None:
            return [found]
    return []


def _out_of_the_lap(clearer: Clearer, failed: Sequence[Attempt]) -> list[Candidate]:
    """Return clear optima with the object held off from whoever holds it."""
    found: list[Candidate] = []
    for first in failed:
        starts = held_off(clearer, first.origin, first.deep)
        for start in sorted(starts, key=lambda start: -_least(clearer, start)):
            attempt = clearer.make_clear(start, also=first.deep)
            found += [attempt.candidate] if attempt.clear else []
            if len(found) == HELD_OFF or clearer.deadline.passed:
                return found
    return found


def _least(clearer: Clearer, candidate: Candidate) -> float:
    """Return by how much the deepest overlap of a motion is from being clear [m]; negative where it is not."""
    _, least = clearer.look(candidate.problem, candidate.spline, candidate.result.x)
    return float((least - clearer.asked).min())


def _passing(session: Session, clearer: Clearer, failed: Sequence[Attempt]) -> list[Candidate]:
    """Return clear optima in which the object is led past what it ran into."""
    found: list[Candidate] = []
    kinematics = session.postures.kinematics
    for first in failed:
        origin = first.origin
        for x in passing_paths(origin.problem, kinematics, clearer.solids, origin.result.x, clearer.deadline):
            if clearer.deadline.passed:
                break
            start = replace(origin, result=replace(origin.result, x=x, converged=False))
            attempt = clearer.make_clear(start, polish=False, also=first.deep)
            if not attempt.clear and not found:
                # To the end: a rough optimum that touches all sides is a bad start for more rounds.
                exact = session.clearer(origin.problem) or clearer
                attempt = cleared_elastically(exact, start, first.deep) or attempt
            found += [attempt.candidate] if attempt.clear else []
        if found:
            break
    return found


def _other_sides(clearer: Clearer, failed: Sequence[Attempt]) -> list[Candidate]:
    """Return clear optima that pass on another side than the one that led nowhere."""
    found: list[Candidate] = []
    for first in failed:
        if clearer.deadline.passed:
            break
        pairs = [frozenset({pair}) for pair in sorted(first.deep)]
        for avoided in dict.fromkeys((first.deep, *pairs[:AVOIDED])):
            attempt = clearer.make_clear(first.origin, polish=False, avoided=avoided)
            if attempt.clear:
                found.append(attempt.candidate)
                break
    return found
