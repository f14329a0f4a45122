"""Alternative paths: one agent follows the object's path as it is, but from another posture.

Random postures at the start, in the middle and at the end are brought to the object by inverse kinematics. From there
they follow it to both ends. What comes of that is far from optimal but nearly closes the grasps. To change one agent at
a time is mostly enough (docs/tuning.md).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from liftopt.collocation.batch import Batch
from liftopt.collocation.layout import OBJECT_SIZE
from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.deadline import Deadline
from liftopt.collocation.transfer import nearest_controls
from liftopt.search.initial_guess import InitialGuess
from liftopt.search.inverse_kinematics import CLOSING_ITERATIONS, FOLLOWING_ITERATIONS, InverseKinematics
from liftopt.search.moves import apart, further, keep_different
from liftopt.search.postures import scattered
from liftopt.types import Array

# Postures tried at each of three times, and paths of each agent that are kept.
SEEDS, MOST = 8, 6
# Gap [m] that inverse kinematics may leave: the solver closes it.
GAP = 0.02
# Paths whose links are nearer than this [m] at all three times are the same.
SAME_PATH = 0.06


def alternative_paths(
    problem: Problem, kinematics: InverseKinematics, x: Array, rng: np.random.Generator, deadline: Deadline
) -> list[InitialGuess]:
    """Return a motion with one agent on another path, for a few paths of each; the agents take turns.

    Args:
        problem: the lift.
        kinematics: of its team.
        x: the motion (n_x,).
        rng: where the postures come from.
        deadline: past which inverse kinematics stops.
    """
    layout, agents = problem.layout, problem.team.agents
    here = np.einsum("kc,cn->kn", problem.mesh.basis[0], x[layout.control])
    middle = len(here) // 2
    paths = _followed(problem, kinematics, here, np.repeat([0, middle, len(here) - 1], SEEDS), rng, deadline)
    if not paths.size:
        return []
    control, batch, found = nearest_controls(problem, paths), Batch(problem), []
    for i, agent in enumerate(agents):
        own = layout.control[:, layout.columns(i)]
        changed = np.tile(x, (len(control), 1))
        changed[:, own] = control[:, :, layout.columns(i)]
        speed = np.abs(np.einsum("sc,bcn->bsn", problem.mesh.slope, changed[:, own])) / problem.task.duration
        excess = np.maximum(0.0, speed - agent.limits.velocity).max(axis=1).sum(axis=1)
        # The first row is the motion as it is, which is no other path.
        q = np.concatenate([here[:, None], paths], axis=1)[:, :, layout.columns(i)]
        between = np.max([apart(agent, q[k]) for k in (0, middle, -1)], axis=0)
        order = np.argsort(batch.terms(changed)[i] * (1 + excess), kind="stable") + 1
        kept = keep_different([0, *order], further(between, SAME_PATH), MOST + 1)
        found.append([InitialGuess(f"{agent.name} another way {n}", changed[k - 1]) for n, k in enumerate(kept[1:], 1)])
    return [own[n] for n in range(MOST) for own in found if n < len(own)]


def _followed(
    problem: Problem,
    kinematics: InverseKinematics,
    here: Array,
    at: npt.NDArray[np.int64],
    rng: np.random.Generator,
    deadline: Deadline,
) -> Array:
    """Return coordinates (K, B, n) along the object's path in ``here`` (K, n), from scattered postures at knots ``at``.

    Those that do not reach the object, or lose it on the way, are left out.
    """
    seeds, layout = here[at], problem.layout
    for i, agent in enumerate(problem.team.agents):
        seeds[:, layout.columns(i)] = [scattered(agent, rng) for _ in at]
    reach = kinematics.reach(here[at, -OBJECT_SIZE:], seeds, deadline, most=CLOSING_ITERATIONS)
    closed = reach.shortfall < GAP
    at, first = at[closed], reach.coordinates[closed]
    way = np.empty((len(here), len(at), here.shape[1]))
    way[at, np.arange(len(at))] = first
    # From there each is followed in both directions at once.
    follows, last = np.full(len(at), True), np.tile(first, (2, 1))
    who, sign = np.tile(np.arange(len(at)), 2), np.repeat([1, -1], len(at))
    for step in range(1, len(here)):
        knot = at[who] + sign * step
        inside = (knot >= 0) & (knot < len(here))
        who, sign, last, knot = who[inside], sign[inside], last[inside], knot[inside]
        if len(who):
            reach = kinematics.reach(here[knot, -OBJECT_SIZE:], last, deadline, most=FOLLOWING_ITERATIONS)
            last = way[knot, who] = reach.coordinates
            follows[who[~(reach.shortfall < GAP)]] = False
    return way[:, follows]
