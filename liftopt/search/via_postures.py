"""Via postures: a motion by way of a posture in which it costs little to hold the object, wherever that may be.

A slow lift may gain by passing where the object is easily held. Its ends tell nothing of that.
"""

from __future__ import annotations

import numpy as np

from liftopt.collocation.batch import Batch
from liftopt.collocation.layout import OBJECT_SIZE
from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.deadline import Deadline
from liftopt.collocation.transfer import nearest_controls
from liftopt.search.initial_guess import InitialGuess
from liftopt.search.inverse_kinematics import FOLLOWING_ITERATIONS, InverseKinematics
from liftopt.search.moves import apart, further, keep_different, quintic
from liftopt.search.postures import Posture, PostureSolver, seed_coordinates
from liftopt.types import Array

# Postures searched from so many seeds, and so many kept whose links are further apart than this [m].
SEEDS, MOST, APART = 16, 8, 0.1
# Share of the time to get there, and to come back.
THERE = 0.4
# A motion is dropped if its objective is above so many times that of the motion as it is: such ones led to nothing.
TOO_HIGH = 16.0


def low_cost_postures(
    problem: Problem, postures: PostureSolver, rng: np.random.Generator, deadline: Deadline
) -> list[Posture]:
    """Return postures that hold the object anywhere within the task's limits, what costs least first.

    Args:
        problem: the lift.
        postures: finds them.
        rng: of the seeds.
        deadline: past which no more is tried.
    """
    anywhere = np.full(OBJECT_SIZE, np.nan)
    seeds = [seed_coordinates(problem, anywhere, rng if n else None) for n in range(SEEDS)]
    found = [posture.rounded() for posture in postures.search(anywhere, seeds, deadline) if posture]
    found.sort(key=lambda posture: posture.cost)
    if not found:
        return []
    q, agents = np.array([posture.coordinates for posture in found]), problem.team.agents
    between = np.max([apart(agent, q[:, problem.layout.columns(i)]) for i, agent in enumerate(agents)], axis=0)
    kept = keep_different(range(len(found)), further(between, APART), MOST)
    return [found[n] for n in kept]


def via_postures(
    problem: Problem, kinematics: InverseKinematics, x: Array, by: list[Posture], deadline: Deadline
) -> list[InitialGuess]:
    """Return motions in which one agent takes the object by way of a posture, and the others follow.

    Args:
        problem: the lift.
        kinematics: of its team.
        x: the motion (n_x,).
        by: the postures; the way by each of them for each agent, those of the first posture first.
        deadline: past which inverse kinematics stops.
    """
    if not by:
        return []
    layout, agents = problem.layout, problem.team.agents
    here = np.einsum("kc,cn->kn", problem.mesh.basis[0], x[layout.control])
    share = quintic(np.minimum(1.0, np.minimum(problem.mesh.phase, 1.0 - problem.mesh.phase) / THERE))
    jobs = [(n, leader) for n in range(len(by)) for leader in range(len(agents))]
    leads = np.zeros((len(jobs), here.shape[1]), dtype=bool)
    leads[:, -OBJECT_SIZE:] = True
    for job, (_, leader) in enumerate(jobs):
        leads[job, layout.columns(leader)] = True
    target = np.array([by[n].coordinates for n, _ in jobs])
    way = here[:, None] + share[:, None, None] * (target - here[:, None])
    last = np.tile(here[0], (len(jobs), 1))
    for there in way:
        seeds = np.where(leads, there, last)
        last = kinematics.reach(seeds[:, -OBJECT_SIZE:], seeds, deadline, most=FOLLOWING_ITERATIONS).coordinates
        there[:] = np.where(leads, there, last)
    changed, batch = np.tile(x, (len(jobs), 1)), Batch(problem)
    changed[:, layout.control] = nearest_controls(problem, way)
    objective, most = batch.objective(changed), TOO_HIGH * batch.objective(x[None])[0]
    return [
        InitialGuess(f"{agents[leader].name} by way of posture {n + 1}", changed[job])
        for job, (n, leader) in enumerate(jobs)
        if objective[job] < most
    ]
