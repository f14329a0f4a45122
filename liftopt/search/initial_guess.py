"""Where the solver starts: pairs of static postures joined by a smooth motion, and the paper's naive guess.

Random seeds spread over the ranges of motion. They find different arm configurations that hold the object at the start.
Each leads to one at the end, and that back to another at the start. Every agent's moves between them are ranked apart
(``moves.py``). The first guess joins the best move of each agent. Each of the others has another move of one agent; the
agents take turns. What they lead to tells which moves to combine (``recombined``).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.deadline import Deadline
from liftopt.collocation.solvers.result import SolverResult
from liftopt.search.moves import Move, blend_all, combinations, find_moves
from liftopt.search.postures import Posture, PostureSolver, distinct, seed_coordinates
from liftopt.types import Array, Progress

# Postures nearer than this in every joint [rad] lead to the same ones.
SAME_POSTURE = 0.03
# At least so many seeds are tried at once; after so many rounds an end without a posture is given up. There are as many
# seeds as starts, for many starts need different postures. Fewer lead to worse optima (docs/tuning.md).
SEEDS, ROUNDS = 12, 3
NAIVE_FORCE = 10.0
# A joint presses against a limit if it is nearer than PRESSED [rad] to it for this share of the time. Turned back, it
# may miss its range by MISSED [rad].
PRESSED_SHARE, PRESSED, MISSED = 0.2, 0.01, 0.6


@dataclass(frozen=True)
class InitialGuess:
    """Where a solver starts.

    Attributes:
        name: ``"naive"`` or ``"posture pair 1"``, ...
        x: unknowns of the problem it was made for.
        moves: which of its moves each agent makes; empty where that is not known.
        agent: whose move it is meant to try; None: nobody's in particular.
    """

    name: str
    x: Array
    moves: tuple[int, ...] = ()
    agent: int | None = None


def naive_guess(problem: Problem) -> InitialGuess:
    """Return the paper's guess: every control point 0, every force component 10 N (clipped to the bounds)."""
    layout = problem.layout
    return InitialGuess("naive", problem.pack(np.zeros(layout.control.shape), np.full(layout.force.shape, NAIVE_FORCE)))


@dataclass(frozen=True)
class InitialGuessSet:
    """Postures at both ends of a lift and what each agent may do between them, the most promising first.

    Attributes:
        first, last: postures at the start and at the end, at least one each.
        moves: of each agent.
    """

    first: tuple[Posture, ...]
    last: tuple[Posture, ...]
    moves: tuple[tuple[Move, ...], ...]

    def starts(self, problem: Problem, count: int) -> list[InitialGuess]:
        """Return up to ``count`` starts of the lift, on any mesh, the most promising first."""
        return [
            InitialGuess(f"posture pair {i + 1}", blend(problem, *self._joined(problem, moves)), moves, agent)
            for i, (agent, moves) in enumerate(combinations(self.moves, count))
        ]

    def _joined(self, problem: Problem, chosen: tuple[int, ...]) -> tuple[Posture, Posture]:
        """Return the ends of a combination of moves: the object and the forces are means of the agents'."""
        moves = [self.moves[agent][move] for agent, move in enumerate(chosen)]
        first, last = [self.first[move.first] for move in moves], [self.last[move.last] for move in moves]
        return _together(problem, first), _together(problem, last)


def initial_guesses(
    problem: Problem,
    most: int,
    seed: int,
    deadline: Deadline,
    progress: Progress | None = None,
    postures: PostureSolver | None = None,
    seeds: int = 0,
    rounds: int = ROUNDS,
) -> InitialGuessSet | None:
    """Return what postures allow; None if none was found at one end.

    Args:
        problem: the lift.
        most: moves of one agent.
        seed: of the random seeds; equal seeds give equal starts where the deadline does not cut the search short.
        deadline: past which the search stops.
        progress: called with one line at a time about what is going on.
        postures: solver for the problem's team, to be used again; None: one is made.
        seeds: for the posture search, at least so many, and at least ``most`` and ``SEEDS``.
        rounds: of seeds, after which an end without a posture is given up.
    """
    task, rng = problem.task, np.random.default_rng(seed)
    postures = postures or PostureSolver(problem.team, task, progress)
    count = max(SEEDS, most, seeds)
    for attempt in range(rounds):
        if deadline.passed:
            break
        if progress:
            progress(f"postures at both ends, from {count} seeds" + (" more" if attempt else ""))
        scattered = [seed_coordinates(problem, task.start, rng if attempt or i else None) for i in range(count)]
        first, last = _ends(postures, problem, scattered, deadline)
        if first and last:
            return InitialGuessSet(tuple(first), tuple(last), find_moves(problem, postures, first, last, most))
    return None


def posture_starts(
    problem: Problem,
    count: int,
    seed: int,
    deadline: Deadline,
    progress: Progress | None = None,
    postures: PostureSolver | None = None,
    rounds: int = ROUNDS,
) -> list[InitialGuess]:
    """Return up to ``count`` starts from pairs of postures, the most promising first; see ``initial_guesses``."""
    found = initial_guesses(problem, count, seed, deadline, progress, postures, rounds=rounds)
    return found.starts(problem, count) if found else []


def _ends(
    postures: PostureSolver, problem: Problem, seeds: list[Array], deadline: Deadline
) -> tuple[list[Posture], list[Posture]]:
    """Return postures at the start, among them those found back from the end, and postures at the end."""
    task = problem.task

    def found(pose: Array, seeds: list[Array]) -> list[Posture]:
        return [posture.rounded() for posture in postures.search(pose, seeds, deadline) if posture]

    first = distinct(found(task.start, seeds), SAME_POSTURE)
    last = distinct(found(task.end, [p.coordinates for p in first]), SAME_POSTURE)
    again = found(task.start, [p.coordinates for p in last])
    return distinct([*first, *again], SAME_POSTURE), last


def _together(problem: Problem, own: Sequence[Posture]) -> Posture:
    """Return the posture in which each agent stands as in its ``own``."""
    coordinates = np.mean([posture.coordinates for posture in own], axis=0)
    for i, posture in enumerate(own):
        columns = problem.layout.columns(i)
        coordinates[columns] = posture.coordinates[columns]
    force = np.mean([posture.force for posture in own], axis=0)
    return Posture(coordinates, force, float(np.mean([posture.cost for posture in own])))


def blend(problem: Problem, first: Posture, last: Posture) -> Array:
    """Return unknowns that join two postures by the quintic of minimum jerk."""
    x: Array = blend_all(problem, [(first, last)])[0]
    return x


def recombined(
    problem: Problem, starts: Sequence[InitialGuess], results: Sequence[SolverResult]
) -> InitialGuess | None:
    """Return the start in which every agent moves as it did best.

    None if it did so in one of the starts, or if the moves are not known.
    """
    solved = [(result.objective, n) for n, result in enumerate(results) if result.converged and starts[n].moves]
    if not starts[0].moves:  # it joins no known moves
        return None
    own = []
    for agent in range(len(starts[0].moves)):
        tried = [(objective, starts[n], results[n].x) for objective, n in solved if starts[n].agent in (None, agent)]
        if not tried:
            return None
        own.append(min(tried, key=lambda entry: entry[0])[1:])
    chosen = tuple(start.moves[agent] for agent, (start, _) in enumerate(own))
    if chosen in [starts[n].moves for _, n in solved]:
        return None
    x = np.mean([optimum for _, optimum in own], axis=0)
    for agent, (_, optimum) in enumerate(own):
        columns = problem.layout.control[:, problem.layout.columns(agent)]
        x[columns] = optimum[columns]
    return InitialGuess("best moves together", x, chosen)


def turned_back(problem: Problem, x: Array) -> InitialGuess | None:
    """Return an optimum with the joints that press against a limit a full turn back; None where none can do that.

    At the other end of its range such a joint has the same posture, or nearly, and room to move on.
    """
    y, any_turned = x.copy(), False
    for i, agent in enumerate(problem.team.agents):
        columns = problem.layout.control[:, problem.layout.columns(i)]
        limits = agent.limits
        for j, (lower, upper) in enumerate(zip(limits.q_lower, limits.q_upper, strict=True)):
            q = x[columns[:, j]]
            for sign, pressed in ((-1.0, q > upper - PRESSED), (1.0, q < lower + PRESSED)):
                if upper - lower > 2 * np.pi - MISSED and pressed.mean() > PRESSED_SHARE:
                    y[columns[:, j]] = np.clip(q + sign * 2 * np.pi, lower, upper)
                    any_turned = True
    return InitialGuess("a full turn back", y) if any_turned else None
