"""Moves: what each agent may do between the postures at both ends, ranked for each agent apart.

Who holds one object hardly feels how the other gets there: of 200 starts of each of 40 varied lifts, the best optimum
was nearly always the best move of one agent beside the best of the other. So moves are ranked and tried by agent, and
a few of each stand for all their combinations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from liftopt.collocation.batch import Batch
from liftopt.collocation.postures import Posture, PostureSolver
from liftopt.collocation.problem import Problem
from liftopt.multibody.agent import Agent

Array = npt.NDArray[np.float64]
# Peak speed of the quintic blend over its mean speed.
QUINTIC_PEAK = 1.875
# Holding still at both ends for the whole time, beside the objective of the blend between them: of the weights tried
# (0.25, 1, 3, 10) the one with the best optima.
STATIC_WEIGHT = 1.0
TOO_FAST_WEIGHT = 1e3
# A blend along which a hand turns too far on the object joins arm configurations that seldom meet.
TURNED_WEIGHT = 1e4
# Moves whose links all begin and end nearer to each other than this [m] mostly lead to the same optimum. Angles would
# not tell: turning the last joint about its own axis moves nothing.
SAME = 0.06
# Blends at a time: hundreds of postures make tens of thousands of pairs.
CHUNK = 512


@dataclass(frozen=True)
class Move:
    """One agent's way from a posture at the start to one at the end.

    Attributes:
        first, last: which of the postures.
        promise: what it seems to lead to: its part of the blend's objective, of holding still, and what is too fast.
    """

    first: int
    last: int
    promise: float


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
    held = [
        still.terms(np.array([postures.problem.pack(p.coordinates[None], p.force[None]) for p in ends]))
        for ends in (first, last)
    ]
    promise = blended + STATIC_WEIGHT * (held[0][:, pairs[:, 0]] + held[1][:, pairs[:, 1]])
    found = []
    for i, agent in enumerate(problem.team.agents):
        columns = problem.layout.columns(i)
        q = [np.array([posture.coordinates[columns] for posture in ends]) for ends in (first, last)]
        travel = np.abs(q[1][pairs[:, 1]] - q[0][pairs[:, 0]])
        excess = np.maximum(0.0, QUINTIC_PEAK * travel / problem.task.duration - agent.limits.velocity).sum(axis=1)
        here = promise[i] + TOO_FAST_WEIGHT * excess + TURNED_WEIGHT * turned[i]
        found.append(_different(pairs, here, [apart(agent, postures_) for postures_ in q], most))
    return tuple(found)


def _blended(problem: Problem, pairs: Sequence[tuple[Posture, Posture]]) -> tuple[Array, Array]:
    """Return what every part adds to the objective of each pair's blend (parts, B), and how far hands turn (agents, B).

    The latter is by how much the cosine of an agent's hand on the object is beyond its limit, a mean over time.
    """
    batch, terms, turned = Batch(problem), [], []
    blocks = [block for block in problem.constraints.blocks if block.name == "grasp_turn"]
    for n in range(0, len(pairs), CHUNK):
        blends = blend_all(problem, pairs[n : n + CHUNK])
        terms.append(batch.terms(blends))
        g = batch.rows(blends) if blocks else np.zeros((len(blends), 0))
        missed = np.zeros((len(problem.team.agents), len(blends)))
        for i, agent in enumerate(problem.team.agents):
            own = [np.maximum(0.0, block.lower - g[:, block.rows]) for block in blocks if block.who == agent.name]
            missed[i] = np.hstack(own).mean(axis=1) if own else 0.0
        turned.append(missed)
    return np.hstack(terms), np.hstack(turned)


def blend_all(problem: Problem, pairs: Sequence[tuple[Posture, Posture]]) -> Array:
    """Return the unknowns (B, n_x) that join each pair by the quintic of minimum jerk, within their bounds."""

    def join(phase: Array, ends: Array) -> Array:
        share = (10 * phase**3 - 15 * phase**4 + 6 * phase**5)[:, None]
        return np.asarray(ends[:, :1] + (ends[:, 1:] - ends[:, :1]) * share)

    x = np.empty((len(pairs), problem.layout.n_x))
    coordinates = np.array([[posture.coordinates for posture in pair] for pair in pairs])
    forces = np.array([[posture.force for posture in pair] for pair in pairs])
    # The phase at which a control point acts is where it is sampled.
    x[:, problem.layout.control] = join(problem.mesh.control_phase, coordinates)
    x[:, problem.layout.force] = join(problem.mesh.phase, forces)
    return np.asarray(np.clip(x, *problem.bounds()))


def apart(agent: Agent, q: Array) -> Array:
    """Return how far apart an agent's postures ``q`` (B, n) are, (B, B): the most that a link's centre moves [m]."""
    model = agent.reduced()
    data, levers = model.createData(), [inertia.lever for inertia in model.inertias]
    places = np.empty((len(q), model.njoints - 1, 3))
    for place, row in zip(places, q, strict=True):
        pin.forwardKinematics(model, data, row)
        place[:] = [data.oMi[j].act(levers[j]) for j in range(1, model.njoints)]
    return np.asarray(np.linalg.norm(places[:, None] - places[None], axis=3).max(axis=2))


def _different(pairs: npt.NDArray[np.int64], promise: Array, between: list[Array], most: int) -> tuple[Move, ...]:
    """Return the most promising moves of which no two are the same; ``between``: how far the postures are apart."""
    kept: list[Move] = []
    first, last = np.zeros(0, np.int64), np.zeros(0, np.int64)
    for n in np.argsort(promise, kind="stable"):
        i, j = pairs[n]
        if (np.maximum(between[0][i, first], between[1][j, last]) > SAME).all():
            kept.append(Move(int(i), int(j), float(promise[n])))
            first, last = np.append(first, i), np.append(last, j)
        if len(kept) == most:
            break
    return tuple(kept)
