"""Variations: optima changed in ways that no solver takes by itself, until nothing better comes of it.

The best optimum is varied first, a few times, then the next best or the best again, as in a best-first search. Each
variation changes much of one agent's motion and leaves the rest: a joint bent the other way (``mirrored_joints.py``),
another posture along the same path (``alternative_paths.py``), a path by way of a posture (``via_postures.py``). All
three kinds pay about equally (docs/tuning.md), so they take turns.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.deadline import Deadline
from liftopt.collocation.solvers.result import Solver, SolverResult
from liftopt.search.alternative_paths import alternative_paths
from liftopt.search.initial_guess import InitialGuess
from liftopt.search.mirrored_joints import mirrored_joints
from liftopt.search.multistart import solve_each
from liftopt.search.optima import same_optimum
from liftopt.search.postures import PostureSolver, rounded
from liftopt.search.via_postures import low_cost_postures, via_postures

# Variations of one optimum that are solved before the next is chosen. All have the best optimum known before as their
# incumbent: what comes of them does not depend on how many are solved at a time.
TURN = 8
# An optimum is chosen as if it were so much worse, as a share, for each turn it had; none further above the best.
WEARY, NEAR = 0.05, 1.2
# What is lower by a smaller share is no gain.
GAIN = 1e-3


@dataclass
class _Varied:
    """An optimum and what is left of its variations."""

    result: SolverResult
    left: Iterator[InitialGuess]
    turns: int = 0
    exhausted: bool = False

    @property
    def rank(self) -> float:
        return self.result.objective * (1 + WEARY * self.turns)


def vary(
    solvers: Sequence[Solver],
    problem: Problem,
    postures: PostureSolver,
    optima: Sequence[SolverResult],
    idle: float,
    seed: int,
    deadline: Deadline,
    most: float = np.inf,
) -> Iterator[tuple[InitialGuess, SolverResult]]:
    """Solve from variations of optima, and of the optima that they lead to; yield each with its result.

    Args:
        solvers: for the problem, one for each thread.
        problem: what is solved.
        postures: static postures of the same team.
        optima: what is varied, at least one.
        idle: variations without a gain after which it ends.
        seed: of what is random.
        deadline: past which no more is tried.
        most: variations after which it ends in any case; the turn that is begun is ended.
    """
    if not idle:
        return
    rng = np.random.default_rng(seed)
    by = low_cost_postures(problem, postures, rng, deadline)

    def varied(result: SolverResult) -> _Varied:
        x, kinematics = rounded(result.x), postures.kinematics
        kinds: tuple[Callable[[], Iterable[InitialGuess]], ...] = (
            lambda: mirrored_joints(problem, x),
            lambda: via_postures(problem, kinematics, x, by, deadline),
            lambda: _again_and_again(lambda: alternative_paths(problem, kinematics, x, rng, deadline)),
        )
        return _Varied(result, _in_turns(kinds))

    known, best, since, solved = [varied(optimum) for optimum in optima], min(optima, key=_objective), 0, 0
    while since < idle and solved < most and not deadline.passed:
        highest = NEAR * best.objective
        ready = [entry for entry in known if entry.result.objective <= highest and not entry.exhausted]
        if not ready:
            return
        chosen = min(ready, key=lambda entry: entry.rank)
        starts = [start for _, start in zip(range(TURN), chosen.left, strict=False)]
        chosen.turns += 1
        chosen.exhausted = len(starts) < TURN
        results = solve_each(solvers, [(start, best) for start in starts], deadline, problem)
        for start, result in zip(starts, results, strict=True):
            yield start, result
            since, solved = since + 1, solved + 1
            is_known = any(same_optimum(result.objective, entry.result.objective) for entry in known)
            if not result.converged or is_known:
                continue
            known.append(varied(result))
            if result.objective < (1 - GAIN) * best.objective:
                since = 0
            best = min(best, result, key=_objective)


def _in_turns(kinds: Sequence[Callable[[], Iterable[InitialGuess]]]) -> Iterator[InitialGuess]:
    """Yield one of each kind after the other, each kind made when it is its turn."""
    left = [_when_needed(kind) for kind in kinds]
    while left:
        for kind_left in list(left):
            if (start := next(kind_left, None)) is None:
                left.remove(kind_left)
            else:
                yield start


def _when_needed(make: Callable[[], Iterable[InitialGuess]]) -> Iterator[InitialGuess]:
    """Yield what is made, made when the first is asked for."""
    yield from make()


def _again_and_again(make: Callable[[], list[InitialGuess]]) -> Iterator[InitialGuess]:
    """Yield what is made, and what is made next, until nothing is."""
    while starts := make():
        yield from starts


def _objective(result: SolverResult) -> float:
    return result.objective
