"""Moves: what each agent may do between the postures at both ends, ranked for each agent apart.

Who holds one object hardly feels how the others get there: the best optimum is nearly always the best move of each
agent (docs/tuning.md). So moves are ranked and tried by agent, and a few of each stand for all their combinations.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from liftopt.collocation.batch import Batch
from liftopt.collocation.layout import OBJECT_SIZE
from liftopt.collocation.problem import Problem
from liftopt.multibody.agent import Agent
from liftopt.search.postures import Posture, PostureSolver
from liftopt.types import Array

# Peak speed of the quintic blend over its mean speed.
QUINTIC_PEAK = 1.875
# Weight of holding still at both ends for the whole time, beside the objective of the blend between them: what costs
# much to hold is no good end, however cheap the way there.
STATIC_WEIGHT = 1.0
TOO_FAST_WEIGHT = 1e3
# A blend along which a hand turns too far on the object joins arm configurations that seldom meet.
TURNED_WEIGHT = 1e4
# Moves whose links all begin and end nearer to each other than this [m] mostly lead to the same optimum. Angles would
# not tell: turning the last joint about its own axis moves nothing.
SAME_MOVE = 0.06
# What an agent's move does to the others counts by what it takes them to hold the object where the move has it at both
# ends: at best, in one of the postures found, which needs so many times more for each distance [m] from there. Where
# the object may stand anywhere, one agent's best place is often out of the other's comfort.
OTHERS_WEIGHT, ELSEWHERE = 0.75, 0.1
# Moves of several agents that begin or end so far apart [m] count double.
FAR = 1.0
# Blends at a time: hundreds of postures make tens of thousands of pairs.
CHUNK = 512


@dataclass(frozen=True)
class Move:
    """One agent's way from a posture at the start to one at the end.

    Attributes:
        first, last: which of the postures.
        promise: what it seems to lead to: its part of the blend's objective, of holding still, and what is too fast.
        places: where the object is at both ends, x, y, z in the world, one after the other [m].
    """

    first: int
    last: int
    promise: float
    places: tuple[float, ...]


def find_moves(
    problem: Problem, postures: PostureSolver, first: Sequence[Posture], last: Sequence[Posture], most: int
) -> tuple[tuple[Move, ...], ...]:
    """Return up to ``most`` moves of each agent that differ, the most promising first.

    Args:
        problem: the lift.
        postures: what the postures were found with.
        first: postures at the start, at least one.
        last: postures at the end, at least one.
        most: moves of one agent.
    """
    pairs = np.array(list(product(range(len(first)), range(len(last)))))
    blended, turned = _blended(problem, [(first[i], last[j]) for i, j in pairs])
    still = Batch(postures.problem)
    holding = [
        still.terms(np.array([postures.problem.pack(p.coordinates[None], p.force[None]) for p in ends]))
        for ends in (first, last)
    ]
    promise = blended + STATIC_WEIGHT * (holding[0][:, pairs[:, 0]] + holding[1][:, pairs[:, 1]])
    places = [np.array([p.coordinates[-OBJECT_SIZE : -OBJECT_SIZE + 3] for p in ends]) for ends in (first, last)]
    there = [_least_there(cost, place) for cost, place in zip(holding, places, strict=True)]
    needed = there[0][:, pairs[:, 0]] + there[1][:, pairs[:, 1]]
    found = []
    for i, agent in enumerate(problem.team.agents):
        columns = problem.layout.columns(i)
        q = [np.array([posture.coordinates[columns] for posture in ends]) for ends in (first, last)]
        travel = np.abs(q[1][pairs[:, 1]] - q[0][pairs[:, 0]])
        excess = np.maximum(0.0, QUINTIC_PEAK * travel / problem.task.duration - agent.limits.velocity).sum(axis=1)
        here = promise[i] + TOO_FAST_WEIGHT * excess + TURNED_WEIGHT * turned[i]
        others = needed[: len(problem.team.agents)].sum(axis=0) - needed[i]
        kept = _different(pairs, here + OTHERS_WEIGHT * others, [apart(agent, postures_) for postures_ in q], most)
        found.append(tuple(_move(places, here, pairs, n) for n in kept))
    return tuple(found)


def _move(places: Sequence[Array], promise: Array, pairs: npt.NDArray[np.int64], n: int) -> Move:
    first, last = (int(i) for i in pairs[n])
    return Move(first, last, float(promise[n]), (*places[0][first].tolist(), *places[1][last].tolist()))


def _least_there(cost: Array, place: Array) -> Array:
    """Return what each part needs, ``cost`` (parts, B) in each posture, with the object at each ``place`` (B, 3)."""
    away = np.linalg.norm(place[:, None] - place[None], axis=2) / ELSEWHERE
    return np.asarray((cost[:, None, :] * (1 + away)).min(axis=2))


def combinations(moves: Sequence[Sequence[Move]], count: int) -> list[tuple[int | None, tuple[int, ...]]]:
    """Return up to ``count`` combinations of a move of each agent, each with the agent that it is for.

    The first combination, for none in particular, is the most promising one. Then the agents take turns, each from its
    most promising move to its least, with those moves of the others that go best with it.
    """
    promise = [np.array([move.promise for move in own]) for own in moves]
    places = [np.array([move.places for move in own]) for own in moves]
    led: list[list[tuple[float, tuple[int, ...]]]] = []
    for agent, own in enumerate(moves):
        mine = []
        for m in range(len(own)):
            away = [np.linalg.norm((p - places[agent][m]).reshape(-1, 2, 3), axis=2).mean(axis=1) for p in places]
            joined = [(p + promise[agent][m]) * (1 + off / FAR) for p, off in zip(promise, away, strict=True)]
            chosen = tuple(m if k == agent else int(np.argmin(total)) for k, total in enumerate(joined))
            total = sum(p[n] for p, n in zip(promise, chosen, strict=True))
            farthest = max(off[n] for off, n in zip(away, chosen, strict=True))
            mine.append((float(total * (1 + farthest / FAR)), chosen))
        led.append(sorted(mine))
    found: dict[tuple[int, ...], int | None] = {min(own[0] for own in led)[1]: None}
    for n in range(max(map(len, led))):
        for agent, combined in enumerate(led):
            if n < len(combined):
                found.setdefault(combined[n][1], agent)
    return [(agent, chosen) for chosen, agent in found.items()][:count]


def _blended(problem: Problem, pairs: Sequence[tuple[Posture, Posture]]) -> tuple[Array, Array]:
    """Return what every part adds to the objective of each pair's blend (parts, B), and how far hands turn (agents, B).

    The latter is by how much the cosine of an agent's hands on the object is beyond its limit, a mean over time.
    """
    batch, terms, turned = Batch(problem), [], []
    blocks = [block for block in problem.constraints.blocks if block.name == "grasp_turn"]
    for n in range(0, len(pairs), CHUNK):
        blends = blend_all(problem, pairs[n : n + CHUNK])
        terms.append(batch.terms(blends))
        g = batch.rows(blends) if blocks else np.zeros((len(blends), 0))
        missed = np.zeros((len(problem.team.agents), len(blends)))
        for i, agent in enumerate(problem.team.agents):
            names = [grasp.name for grasp in agent.grasps]
            own = [np.maximum(0.0, block.lower - g[:, block.rows]) for block in blocks if block.who in names]
            missed[i] = np.hstack(own).mean(axis=1) if own else 0.0
        turned.append(missed)
    return np.hstack(terms), np.hstack(turned)


def blend_all(problem: Problem, pairs: Sequence[tuple[Posture, Posture]]) -> Array:
    """Return the unknowns (B, n_x) that join each pair by the quintic of minimum jerk, within their bounds."""

    def join(phase: Array, ends: Array) -> Array:
        return np.asarray(ends[:, :1] + (ends[:, 1:] - ends[:, :1]) * quintic(phase)[:, None])

    x = np.empty((len(pairs), problem.layout.n_x))
    coordinates = np.array([[posture.coordinates for posture in pair] for pair in pairs])
    forces = np.array([[posture.force for posture in pair] for pair in pairs])
    # The phase at which a control point acts is where it is sampled.
    x[:, problem.layout.control] = join(problem.mesh.control_phase, coordinates)
    x[:, problem.layout.force] = join(problem.mesh.phase, forces)
    return np.asarray(np.clip(x, *problem.bounds()))


def quintic(phase: Array) -> Array:
    """Return the share of the way that minimum jerk from rest to rest has covered at each ``phase`` from 0 to 1."""
    return np.asarray(10 * phase**3 - 15 * phase**4 + 6 * phase**5)


def apart(agent: Agent, q: Array) -> Array:
    """Return how far apart an agent's postures ``q`` (B, n) are, (B, B): the most that a link's centre moves [m]."""
    model = agent.reduced()
    data, levers = model.createData(), [inertia.lever for inertia in model.inertias]
    places = np.empty((len(q), model.njoints - 1, 3))
    for place, row in zip(places, q, strict=True):
        pin.forwardKinematics(model, data, row)
        place[:] = [data.oMi[j].act(levers[j]) for j in range(1, model.njoints)]
    return np.asarray(np.linalg.norm(places[:, None] - places[None], axis=3).max(axis=2))


def _different(pairs: npt.NDArray[np.int64], rank: Array, between: list[Array], most: int) -> list[int]:
    """Return the moves that rank first, no two of them the same; ``between``: how far the postures are apart."""

    def differs(n: int, kept: list[int]) -> bool:
        (i, j), (first, last) = pairs[n], pairs[kept].T
        return bool((np.maximum(between[0][i, first], between[1][j, last]) > SAME_MOVE).all())

    return keep_different(np.argsort(rank, kind="stable"), differs, most)


def keep_different(order: Iterable[int], differs: Callable[[int, list[int]], bool], most: int) -> list[int]:
    """Return up to ``most`` of ``order``, each of which ``differs`` from all that were kept before it."""
    kept: list[int] = []
    for n in order:
        if len(kept) == most:
            break
        if differs(n, kept):
            kept.append(int(n))
    return kept


def further(between: Array, same: float) -> Callable[[int, list[int]], bool]:
    """Return the test whether one is further than ``same`` from all others; ``between`` (B, B): distances."""
    return lambda n, others: bool((between[n, others] > same).all())
