"""Where the solver starts: the paper's naive guess and pairs of static postures joined by a smooth motion.

Random seeds spread over the ranges of motion find different arm configurations that hold the object at the start;
each leads to one at the end, and that back to another at the start. All pairs are ranked by the objective of the
motion between them, the torques they take and whether the joints are fast enough.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import numpy as np
import numpy.typing as npt

from liftopt.collocation.batch import Batch
from liftopt.collocation.layout import OBJECT_SIZE
from liftopt.collocation.postures import Posture, PostureSolver, distinct, seed_coordinates
from liftopt.collocation.problem import Problem
from liftopt.collocation.task import LiftTask

Array = npt.NDArray[np.float64]
# Peak speed of the quintic blend over its mean speed.
QUINTIC_PEAK = 1.875
# Holding still at each end for half the time, halved again: as much as the objective of the blend on average.
STATIC_WEIGHT = 0.25
# Postures nearer than this in every joint [rad] lead to the same ones.
SAME = 0.03
# Pairs that share a posture to this [rad], or take the same torques to this share, mostly lead to the same optimum.
DIFFERENT, SAME_COST = 0.3, 0.01
# Seeds tried at once, and rounds of them after which an end that no posture was found for is given up.
SEEDS, ROUNDS = 16, 3
TOO_FAST_WEIGHT = 1e3
# A blend along which a hand turns too far on the object joins arm configurations that seldom meet.
TURNED_WEIGHT = 1e4
NAIVE_FORCE = 10.0


@dataclass(frozen=True)
class Start:
    """A start of the solver.

    Attributes:
        name: ``"naive"`` or ``"posture pair 1"``, ...
        x: unknowns of the problem it was made for.
    """

    name: str
    x: Array


def naive_start(problem: Problem) -> Start:
    """Return the paper's guess: every control point 0, every force component 10 N (clipped to the bounds)."""
    layout = problem.layout
    return Start("naive", problem.pack(np.zeros(layout.control.shape), np.full(layout.force.shape, NAIVE_FORCE)))


def posture_starts(
    problem: Problem,
    count: int,
    seed: int,
    deadline: float,
    say: Callable[[str], None] | None = None,
    postures: PostureSolver | None = None,
) -> list[Start]:
    """Return up to ``count`` starts from the best posture pairs, best first; fewer if fewer can be found.

    Args:
        problem: the lift.
        count: how many are wanted.
        seed: of the random seeds; equal seeds give equal starts where the deadline does not cut the search short.
        deadline: ``time.monotonic`` value past which the search stops.
        say: hears of progress.
        postures: solver for the problem's team, to be used again; None: one is made.
    """
    task, rng = problem.task, np.random.default_rng(seed)
    if postures is None:
        # Its kernels may have to be compiled, once: that is no part of the search.
        began = time.monotonic()
        postures = PostureSolver(problem.team, task, say)
        deadline += time.monotonic() - began
    pairs: list[tuple[Posture, Posture]] = []
    for attempt in range(ROUNDS):
        if time.monotonic() > deadline or pairs:
            break
        if say:
            say(f"postures at both ends, from {SEEDS} seeds" + (" more" if attempt else ""))
        seeds = [seed_coordinates(problem, task.start, rng if attempt or i else None) for i in range(SEEDS)]
        pairs = _pairs(postures, task, seeds, deadline)
    chosen = choose([pairs[i] for i in np.argsort(_promise(problem, pairs), kind="stable")], count)
    return [Start(f"posture pair {i + 1}", blend(problem, *pair)) for i, pair in enumerate(chosen)]


def _pairs(
    postures: PostureSolver, task: LiftTask, seeds: list[Array], deadline: float
) -> list[tuple[Posture, Posture]]:
    """Return all pairs of the postures found at the start, at the end from these, and at the start from those."""
    first = distinct(postures.search(task.start, seeds, deadline), SAME)
    last = distinct(postures.search(task.end, [p.coordinates for p in first], deadline), SAME)
    again = postures.search(task.start, [p.coordinates for p in last], deadline)
    return list(product(distinct([*first, *again], SAME), last))


def _promise(problem: Problem, pairs: list[tuple[Posture, Posture]]) -> Array:
    """Return what each pair seems to lead to: the objective of its blend, its static torques, and what is too fast."""
    if not pairs:
        return np.zeros(0)
    speed = np.concatenate([agent.limits.velocity for agent in problem.team.agents])
    travel = np.array([np.abs(last.coordinates - first.coordinates)[:-OBJECT_SIZE] for first, last in pairs])
    excess = np.maximum(0.0, QUINTIC_PEAK * travel / problem.task.duration - speed).sum(axis=1)
    held = np.array([first.cost + last.cost for first, last in pairs])
    blends = _blends(problem, pairs)
    blended = Batch(problem).objective(blends)
    promise: Array = blended + STATIC_WEIGHT * held + TOO_FAST_WEIGHT * excess
    turns = [block for block in problem.constraints.blocks if block.name == "grasp_turn"]
    if turns:
        rows = np.concatenate([np.arange(block.rows.start, block.rows.stop) for block in turns])
        missed = np.concatenate([block.lower for block in turns]) - Batch(problem, rows).rows(blends)
        promise += TURNED_WEIGHT * np.maximum(0.0, missed).mean(axis=1)
    return promise


def choose(pairs: list[tuple[Posture, Posture]], count: int) -> list[tuple[Posture, Posture]]:
    """Return the first ``count`` pairs that mostly lead to different optima."""
    chosen: list[tuple[Posture, Posture]] = []
    # Pairs that share a posture come after all those that share none.
    for alike in (lambda one, other: _share(one, other) or _as_heavy(one, other), _as_heavy):
        for pair in pairs:
            if len(chosen) < count and not any(alike(pair, other) for other in chosen):
                chosen.append(pair)
    return chosen


def _share(one: tuple[Posture, Posture], other: tuple[Posture, Posture]) -> bool:
    return any(np.abs(a.coordinates - b.coordinates).max() < DIFFERENT for a, b in zip(one, other, strict=True))


def _as_heavy(one: tuple[Posture, Posture], other: tuple[Posture, Posture]) -> bool:
    return all(abs(a.cost - b.cost) < SAME_COST * b.cost for a, b in zip(one, other, strict=True))


def blend(problem: Problem, first: Posture, last: Posture) -> Array:
    """Return unknowns that join two postures by the quintic of minimum jerk, sampled where the control points act."""
    x: Array = _blends(problem, [(first, last)])[0]
    return x


def _blends(problem: Problem, pairs: list[tuple[Posture, Posture]]) -> Array:
    """Return the unknowns (B, n_x) of the blend of each pair, within their bounds."""

    def join(phase: Array, ends: Array) -> Array:
        share = (10 * phase**3 - 15 * phase**4 + 6 * phase**5)[:, None]
        return np.asarray(ends[:, :1] + (ends[:, 1:] - ends[:, :1]) * share)

    x = np.empty((len(pairs), problem.layout.n_x))
    coordinates = np.array([[posture.coordinates for posture in pair] for pair in pairs])
    forces = np.array([[posture.force for posture in pair] for pair in pairs])
    x[:, problem.layout.control] = join(problem.mesh.control_phase, coordinates)
    x[:, problem.layout.force] = join(problem.mesh.phase, forces)
    return np.asarray(np.clip(x, *problem.bounds()))
