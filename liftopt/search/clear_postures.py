"""Static postures with bodies apart, where no motion was found that keeps them so.

One knot is solved in a few milliseconds, with planes too, so many postures can be tried at both ends of a lift. If none
holds the object clear at an end, the one that comes least too near says which bodies are in the way. If some do, they
are good ends of a motion: between them much less is in the way than between the cheapest ones, in which a person folds
around the object.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.deadline import Deadline
from liftopt.errors import SolverError
from liftopt.search.clear_end import ClearEnd
from liftopt.search.clear_still import ClearStill, posture_of
from liftopt.search.held_off import led_ahead
from liftopt.search.infeasibility import LeastViolation, find_least_violation
from liftopt.search.initial_guess import SAME_POSTURE, InitialGuess, InitialGuessSet
from liftopt.search.inverse_kinematics import CLOSED, CLOSING_ITERATIONS, Reach
from liftopt.search.make_clear import CLEAR, WATCHED, Clearer, Pairs
from liftopt.search.moves import find_moves
from liftopt.search.postures import Posture, distinct, resting, seed_coordinates
from liftopt.search.session import Session
from liftopt.solution.infeasibility_report import InfeasibilityReason
from liftopt.types import Array

SEEDS = 96
# Of the postures found at an end so many are to be made clear, and so many are tried, the cheapest first.
WANTED, MOST = 6, 32
AT_ONCE = 32  # seeds that get planes from the first solve on, where none of these postures can be made clear
ROUNDS = 4  # solves of one posture, each with new planes
# What is in the way at rest is in the way of every motion where it is more than this [m, deg, share of a limit].
DECISIVE = {"m": 0.01, "deg": 5.0}
DECISIVE_SHARE = 0.1
EXPLAINED = 4  # postures for which it is looked what is in the way; the least of that is told
EASINGS = 4  # of one, each with planes for the pairs that overlapped after the last
UNHELD = 12  # so many more where no posture holds the object: what is in the way differs much from one to the next
AT_REST = " at 0.00 s"  # as reasons have it of a problem of one knot


def clear_ends(session: Session, clearer: Clearer, problem: Problem, known: Sequence[Array]) -> tuple[ClearEnd, ...]:
    """Return clear postures at both ends; nothing where they cannot be searched for, or there was no time.

    Args:
        session: of the search.
        clearer: of the team.
        problem: the lift, on any mesh.
        known: motions (n_x,) of it whose ends are tried first.
    """
    task, ends = problem.task, []
    for name, pose, at in (("start", task.start, 0), ("end", task.end, -1)):
        try:
            end = _End(session, clearer, pose).searched([problem.unpack(x)[0][at] for x in known])
        except SolverError:  # an extension that is missing
            return ()
        if not end.postures or session.deadline.passed:
            return ()
        when = 0.0 if at == 0 else task.duration
        told = [replace(r, time=when, static=True, message=_at_end(r.message, name)) for r in end.reasons]
        ends.append(replace(end, reasons=tuple(told)))
    return tuple(ends)


def starts_between(session: Session, problem: Problem, count: int) -> list[InitialGuess]:
    """Return up to ``count`` motions of a problem between clear postures, the most promising first; none without."""
    if not session.held or session.blocked_at_rest:
        return []
    first, last = (end.postures for end in session.held)
    moves = find_moves(problem, session.postures, first, last, count)
    return InitialGuessSet(first, last, moves).starts(problem, count)


def _at_end(message: str, name: str) -> str:
    """Return what is in the way of one posture as what is in the way at an end."""
    return message.replace(AT_REST, f" at the {name} of the lift, in every posture found")


class _End:
    """The search at one end."""

    def __init__(self, session: Session, clearer: Clearer, pose: Array) -> None:
        self.session, self.pose = session, pose
        self.still = session.postures.problem.at_pose(pose)
        self.at_rest = ClearStill(clearer, session.postures.problem)
        self.problem = self.at_rest.postures.problem.at_pose(pose)
        self.clearer = self.at_rest.clearer

    def searched(self, known: Sequence[Array]) -> ClearEnd:
        """Return clear postures, from the coordinates that are ``known`` and from random seeds."""
        rng = np.random.default_rng(self.session.scenario.solver.seed)
        seeds = [*known, *(seed_coordinates(self.problem, self.pose, rng if i else None) for i in range(SEEDS))]
        found = [p.rounded() for p in self.at_rest.postures.search(self.pose, seeds, self._deadline) if p]
        reach = self.at_rest.postures.kinematics.reach(
            self.pose, np.array(seeds), self._deadline, most=CLOSING_ITERATIONS
        )
        if not found:
            nearest = reach.coordinates[np.argsort(reach.shortfall, kind="stable")[:UNHELD]]
            return self._explained([self._without_force(q) for q in [*known[:EXPLAINED], *nearest]])
        blocked: list[tuple[float, Array]] = []
        cheapest = sorted(distinct(found, SAME_POSTURE), key=_cost)[:MOST]
        clear = self._made_clear_of(cheapest, blocked) or self._clear_at_once(reach)
        if clear:
            return ClearEnd(tuple(sorted(distinct(clear, SAME_POSTURE), key=_cost)))
        return self._explained([x for _, x in sorted(blocked, key=lambda entry: entry[0])[:EXPLAINED]])

    def _made_clear_of(self, postures: Sequence[Posture], blocked: list[tuple[float, Array]]) -> list[Posture]:
        """Return clear postures that others lead to; what leads to none is added to those blocked, with its depth."""
        clear: list[Posture] = []
        for posture in postures:
            if len(clear) == WANTED or self._deadline.passed:
                break
            for x in self._starts(posture):
                after, depth = self._made_clear(x, posture.cost)
                if after:
                    clear.append(after)
                    break
                blocked.append((depth, x))
        return clear

    def _clear_at_once(self, reach: Reach) -> list[Posture]:
        """Return clear postures that seeds lead to with planes from the first solve on.

        The cheapest postures are few, and what is far from all of them is not found from there.
        """
        clear: list[Posture] = []
        for coordinates in reach.coordinates[reach.shortfall < CLOSED][:AT_ONCE]:
            if len(clear) == WANTED or self._deadline.passed:
                break
            after, _ = self.at_rest.cleared(self.problem, resting(self.problem, coordinates))
            clear += [after] if after else []
        return clear

    def _without_force(self, coordinates: Array) -> Array:
        return self.problem.pack(coordinates[None], np.zeros((1, self.problem.layout.force.shape[1])))

    @property
    def _deadline(self) -> Deadline:
        return self.session.deadline

    def _starts(self, posture: Posture) -> Iterator[Array]:
        """Yield a posture, and then others with the object farther from whoever holds it."""
        x = self.problem.pack(posture.coordinates[None], posture.force[None])
        yield x
        deep = np.flatnonzero(self.at_rest.look(self.problem, x).distance[0] < self.clearer.asked - CLEAR)
        for result in led_ahead(self.clearer, self.problem, x, deep.tolist()):
            yield result.x

    def _made_clear(self, x: Array, cost: float) -> tuple[Posture | None, float]:
        """Return the clear posture that one of a cost leads to, or None and how deep its deepest overlap is [m]."""
        room = self.at_rest.look(self.problem, x).distance[0] - self.clearer.asked
        if room.min() >= -CLEAR:
            return posture_of(self.problem, x, cost), 0.0
        return self.at_rest.cleared(self.problem, x, WATCHED, ROUNDS)

    def _explained(self, starts: Sequence[Array]) -> ClearEnd:
        """Return the posture that breaks least with bodies apart, of those that the starts lead to, and what it breaks.

        Nothing is told if that is too little to be in the way of every motion.
        """
        eased = self._least(self.problem, starts)
        if eased is None:
            return ClearEnd(())
        nearest = (posture_of(self.problem, eased.x, np.inf),)
        if not any(map(_is_decisive, eased.reasons)):
            return ClearEnd(nearest)
        least = self._least(self.still, [eased.x])
        return ClearEnd(nearest, (least or eased).reasons)

    def _least(self, problem: Problem, starts: Sequence[Array]) -> LeastViolation | None:
        found = [self._least_from(problem, x) for x in starts]
        known = [least for least in found if least is not None]
        return min(known, key=lambda least: (not least.sure, least.price), default=None)

    def _least_from(self, problem: Problem, x: Array) -> LeastViolation | None:
        """Return the posture that breaks least of those near one; None if bodies without planes overlap in it."""
        watched: Pairs = np.array([], dtype=np.int64)
        for _ in range(EASINGS):
            look = self.at_rest.look(problem, x)
            room = look.distance[0] - self.clearer.asked
            watched = np.union1d(watched, np.flatnonzero(room < WATCHED))
            least = find_least_violation(problem.apart(self.at_rest.planes(look, watched, 0.0)), [x], self._deadline)
            if least is None:
                return None
            x = least.x
            deep = np.flatnonzero(self.at_rest.look(problem, x).distance[0] < self.clearer.asked - CLEAR)
            if np.isin(deep, watched).all():
                return least
        return None


def _is_decisive(reason: InfeasibilityReason) -> bool:
    """Whether what is in the way at rest is in the way of every motion."""
    if reason.unit in DECISIVE:
        return reason.amount > DECISIVE[reason.unit]
    return reason.share > DECISIVE_SHARE


def _cost(posture: Posture) -> float:
    return posture.cost
