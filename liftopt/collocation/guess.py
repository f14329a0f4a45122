"""Where the solver starts: the paper's naive guess and pairs of static postures joined by a smooth motion.

Postures come from inverse kinematics with statics: the same kernels on a mesh of one knot at rest, so that a posture
holds the object within every limit at the least squared torque. Random seeds spread over the ranges of motion find
different arm configurations; pairs are ranked by the torques they take and whether the joints are fast enough.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np
import numpy.typing as npt

from liftopt.collocation.layout import FORCE_SIZE, OBJECT_SIZE
from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.solvers.ipopt import Ipopt, IpoptOptions
from liftopt.collocation.spline import Mesh
from liftopt.collocation.task import LiftTask

Array = npt.NDArray[np.float64]
# Seeds spread by this share of each joint's range about the comfortable posture.
SPREAD = 0.25
# Peak speed of the quintic blend over its mean speed.
QUINTIC_PEAK = 1.875
POSTURE_WEIGHT = 1e-2
# Over eight varied scenarios, 95 % of the postures found took at most 93 iterations.
MAX_ITERATIONS = 100
# Holding still at each end for half the time, halved again: as much as the objective of the blend on average.
STATIC_WEIGHT = 0.25
# Seeds after which an end that no posture was found for is given up.
HOPELESS = 4
# Pairs nearer than this in every joint [rad] mostly lead to the same optimum.
DIFFERENT = 0.3
SEEDS_A_START = 3
TOO_FAST_WEIGHT = 1e3
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


@dataclass(frozen=True)
class Posture:
    """A static posture that holds the object.

    Attributes:
        coordinates: (n,) joints of every agent, then the object's six coordinates.
        force: (3 agents,) grasp forces on the object [N].
        cost: objective of holding still for the task's duration.
    """

    coordinates: Array
    force: Array
    cost: float


class PostureSolver:
    """Static postures of a team with the object at a given pose."""

    def __init__(self, team: Team, task: LiftTask) -> None:
        self._problem = Problem(team, task, Mesh.at_rest(), POSTURE_WEIGHT)
        self._solver = Ipopt(self._problem, IpoptOptions(max_iterations=MAX_ITERATIONS))
        self._at_pose: dict[bytes, Problem] = {}

    def solve(self, pose: Array, seed: Array, deadline: float) -> Posture | None:
        """Return the posture found from ``seed`` (coordinates), or None; NaN in ``pose`` (6,) leaves that free."""
        key = pose.tobytes()
        if key not in self._at_pose:
            self._at_pose[key] = replace(self._problem, task=replace(self._problem.task, start=pose, end=pose))
        problem = self._at_pose[key]
        model = problem.team.held.model
        weight = model.inertias[1].mass * float(np.linalg.norm(model.gravity.linear))
        share = np.zeros(problem.layout.force.shape)
        share[:, 2::FORCE_SIZE] = weight / len(problem.team.agents)
        result = self._solver.solve(problem.pack(seed[None, :], share), deadline=deadline, problem=problem)
        if not result.converged:
            return None
        control, force = problem.unpack(result.x)
        return Posture(control[0], force[0], result.objective)


def naive_start(problem: Problem) -> Start:
    """Return the paper's guess: every control point 0, every force component 10 N (clipped to the bounds)."""
    layout = problem.layout
    return Start("naive", problem.pack(np.zeros(layout.control.shape), np.full(layout.force.shape, NAIVE_FORCE)))


def posture_starts(
    problem: Problem, count: int, seed: int, deadline: float, say: Callable[[str], None] | None = None
) -> list[Start]:
    """Return up to ``count`` starts from the best posture pairs, best first; fewer if fewer can be found.

    Args:
        problem: the lift.
        count: how many are wanted.
        seed: of the random seeds; equal seeds give equal starts where the deadline does not cut the search short.
        deadline: ``time.monotonic`` value past which the search stops.
        say: hears of progress.
    """
    task, rng, rate = problem.task, np.random.default_rng(seed), _Ranking(problem)
    postures = PostureSolver(problem.team, task)
    pairs: list[tuple[float, Posture, Posture]] = []
    for attempt in range(SEEDS_A_START * count + HOPELESS):
        if time.monotonic() > deadline or (attempt == HOPELESS and not pairs):
            break
        if say:
            say(f"postures at both ends: {len(pairs)} pairs after {attempt} seeds")
        first = postures.solve(task.start, seed_coordinates(problem, task.start, rng if attempt else None), deadline)
        last = first and postures.solve(task.end, first.coordinates, deadline)
        if first and last:
            pairs.append((rate(first, last), first, last))
            # The way back finds a start posture nearer to the end posture.
            again = postures.solve(task.start, last.coordinates, deadline)
            if again:
                pairs.append((rate(again, last), again, last))
    pairs.sort(key=lambda pair: pair[0])
    chosen: list[tuple[float, Posture, Posture]] = []
    for pair in pairs:
        if len(chosen) < count and all(_differ(pair, other) for other in chosen):
            chosen.append(pair)
    return [Start(f"posture pair {i + 1}", blend(problem, a, b)) for i, (_, a, b) in enumerate(chosen)]


def seed_coordinates(problem: Problem, pose: Array, rng: np.random.Generator | None) -> Array:
    """Return coordinates to search a posture from: the comfortable ones, or spread about them by ``rng``."""
    task = problem.task
    guess = np.where(np.isnan(pose), np.clip(0.0, task.pose_lower, task.pose_upper), pose)
    blocks = []
    for agent in problem.team.agents:
        q, limits = agent.posture, agent.limits
        if rng is not None:
            q = q + SPREAD * (limits.q_upper - limits.q_lower) * rng.standard_normal(len(q))
        blocks.append(np.clip(q, limits.q_lower, limits.q_upper))
    return np.concatenate([*blocks, guess])


class _Ranking:
    """What a posture pair promises: the objective of its blend, its static torques, and how much it is too fast."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        nlp = problem.nlp
        self.objective = ca.Function("objective", [nlp.x, nlp.p], [nlp.f])
        self.speed = np.concatenate([agent.limits.velocity for agent in problem.team.agents])

    def __call__(self, first: Posture, last: Posture) -> float:
        travel = np.abs(last.coordinates - first.coordinates)[:-OBJECT_SIZE]
        excess = np.maximum(0.0, QUINTIC_PEAK * travel / self.problem.task.duration - self.speed)
        blended = float(self.objective(blend(self.problem, first, last), self.problem.parameters))
        return blended + STATIC_WEIGHT * (first.cost + last.cost) + TOO_FAST_WEIGHT * float(excess.sum())


def _differ(one: tuple[float, Posture, Posture], other: tuple[float, Posture, Posture]) -> bool:
    ends = [np.abs(a.coordinates - b.coordinates).max() for a, b in zip(one[1:], other[1:], strict=True)]
    return float(max(ends)) > DIFFERENT


def blend(problem: Problem, first: Posture, last: Posture) -> Array:
    """Return unknowns that join two postures by the quintic of minimum jerk, sampled where the control points act."""

    def quintic(s: Array) -> Array:
        return (10 * s**3 - 15 * s**4 + 6 * s**5)[:, None]

    control = first.coordinates + (last.coordinates - first.coordinates) * quintic(problem.mesh.control_phase)
    force = first.force + (last.force - first.force) * quintic(problem.mesh.phase)
    return problem.pack(control, force)
