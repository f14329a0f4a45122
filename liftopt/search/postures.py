"""Static postures: the object held at a pose within every limit, at the least squared torque.

Inverse kinematics from many seeds at once brings the grasps to the object; what it cannot close is dropped before a
solve is spent on it. The others go to the banded solver, on the equations of the lift for one knot at rest.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.solvers.banded import Banded, BandedOptions
from liftopt.collocation.solvers.deadline import Deadline
from liftopt.collocation.solvers.ipopt import Ipopt, IpoptOptions
from liftopt.collocation.solvers.parallel_map import parallel_map
from liftopt.collocation.solvers.result import Solver
from liftopt.collocation.spline import Mesh
from liftopt.collocation.task import LiftTask
from liftopt.errors import SolverError
from liftopt.multibody.agent import Agent
from liftopt.search.inverse_kinematics import CLOSED, CLOSING_ITERATIONS, InverseKinematics
from liftopt.types import Array, Progress

POSTURE_WEIGHT = 1e-2
# Seeds spread by this share of each joint's range about the comfortable posture.
SPREAD = 0.35
MAX_ITERATIONS = 100
TOLERANCE = 1e-7
# Starts are rounded to so many digits after the point. The last digits differ from processor to processor, and every
# step of a solver makes the difference larger.
DIGITS = 4
# Postures are compared, not kept: with these more seeds converge, in fewer iterations (docs/tuning.md).
SCALING, ROUGH = 0.01, 1e-4


@dataclass(frozen=True)
class Posture:
    """A static posture that holds the object.

    Attributes:
        coordinates: (n,) joints of every agent, then the object's six coordinates.
        force: grasp forces on the object [N], and moments [Nm], as the layout has them.
        cost: objective of holding still for the task's duration.
    """

    coordinates: Array
    force: Array
    cost: float

    def rounded(self) -> Posture:
        """Return it as something to start from; see ``DIGITS``."""
        return Posture(rounded(self.coordinates), rounded(self.force), float(rounded(np.array(self.cost))))


class PostureSolver:
    """Static postures of a team with the object at a given pose."""

    def __init__(
        self,
        team: Team,
        task: LiftTask,
        progress: Progress | None = None,
        like: PostureSolver | None = None,
        workers: int = 1,
    ) -> None:
        """Build the solver.

        Args:
            team: who holds what.
            task: its limits and weights; poses are given to ``solve``.
            progress: called when kernels must be compiled first.
            like: another one, whose solvers are used again if they fit.
            workers: postures solved at a time.
        """
        self.problem: Problem = Problem(team, task, like.problem.mesh if like else Mesh.at_rest(), POSTURE_WEIGHT)
        self.kinematics = InverseKinematics(self.problem)
        self._workers = workers
        self._at_pose: dict[bytes, Problem] = {}
        fitting = like if like and self.problem.interchangeable(like.problem) else None
        self._solvers: list[Solver] = [*fitting._solvers] if fitting else []
        options = BandedOptions(TOLERANCE, MAX_ITERATIONS, SCALING, ROUGH)
        try:
            while len(self._solvers) < workers:
                self._solvers.append(Banded(self.problem, options, progress))
        except SolverError:  # IPOPT's linear solver takes one solve at a time
            self._solvers = self._solvers or [Ipopt(self.problem, IpoptOptions(TOLERANCE, MAX_ITERATIONS))]

    def solve(self, pose: Array, seed: Array, deadline: Deadline) -> Posture | None:
        """Return the posture found from ``seed`` (coordinates), or None; NaN in ``pose`` (6,) leaves that free."""
        return next(self.search(pose, [seed], deadline))

    def search(self, pose: Array, seeds: Sequence[Array], deadline: Deadline) -> Iterator[Posture | None]:
        """Yield what is found from each seed: all are brought to the object at once, and then solved one by one."""
        if not seeds:
            return iter(())
        reach = self.kinematics.reach(pose, np.array(seeds), deadline, most=CLOSING_ITERATIONS)
        key = pose.tobytes()
        if key not in self._at_pose:
            self._at_pose[key] = self.problem.at_pose(pose)
        problem = self._at_pose[key]

        def job(coordinates: Array, shortfall: float) -> Callable[[Solver], Posture | None]:
            return lambda solver: _held(solver, problem, coordinates, deadline) if shortfall < CLOSED else None

        return parallel_map(
            self._solvers[: self._workers], [job(*end) for end in zip(reach.coordinates, reach.shortfall, strict=True)]
        )


def _held(solver: Solver, problem: Problem, coordinates: Array, deadline: Deadline) -> Posture | None:
    """Return the static posture found from coordinates that close on the object; None if there is none in time."""
    if deadline.passed:
        return None
    start = resting(problem, coordinates)
    result = solver.solve(start, deadline=deadline, problem=problem)
    if not result.converged:
        return None
    control, force = problem.unpack(result.x)
    return Posture(control[0], force[0], result.objective)


def resting(problem: Problem, coordinates: Array) -> Array:
    """Return the unknowns (n_x,) of a problem of one knot where each grasp bears its share of the weight."""
    model = problem.team.object.model
    weight = model.inertias[1].mass * float(np.linalg.norm(model.gravity.linear))
    share, layout = np.zeros(problem.layout.force.shape), problem.layout
    share[:, [layout.force_columns(g).start + 2 for g in range(len(layout.grasps))]] = weight / len(layout.grasps)
    return problem.pack(rounded(coordinates)[None, :], share)


def rounded(x: Array) -> Array:
    """Return what a solver is to start from, angles [rad] and forces [N], to ``DIGITS``."""
    return np.asarray(np.round(x, DIGITS))


def seed_coordinates(problem: Problem, pose: Array, rng: np.random.Generator | None) -> Array:
    """Return coordinates to search a posture from: the comfortable ones, or spread about them by ``rng``.

    Where the object's place is free it is 0, or with ``rng``, every other time, where one agent's hand is.
    """
    task = problem.task
    guess = np.where(np.isnan(pose), np.clip(0.0, task.pose_lower, task.pose_upper), pose)
    blocks: list[Array] = []
    for agent in problem.team.agents:
        comfortable = np.clip(agent.posture, agent.limits.q_lower, agent.limits.q_upper)
        blocks.append(comfortable if rng is None else scattered(agent, rng))
    free = np.isnan(pose[:3])
    if rng is not None and free.any() and (leader := int(rng.integers(2 * len(blocks)))) < len(blocks):
        place = _place_in_hand(problem.team, leader, blocks[leader])
        guess[:3][free] = np.clip(place, task.pose_lower[:3], task.pose_upper[:3])[free]
    return np.concatenate([*blocks, guess])


def scattered(agent: Agent, rng: np.random.Generator) -> Array:
    """Return a random posture (n,) of an agent, about its comfortable one and within its limits."""
    lower, upper = agent.limits.q_lower, agent.limits.q_upper
    return np.clip(agent.posture + SPREAD * (upper - lower) * rng.standard_normal(len(lower)), lower, upper)


def _place_in_hand(team: Team, which: int, q: Array) -> Array:
    """Return where the object's centre (3,) is if it is level and an agent with posture ``q`` holds it, world [m]."""
    agent, lifted = team.agents[which], team.object.model
    model = agent.reduced()
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    first = sum(len(each.grasps) for each in team.agents[:which])
    places = []
    for grasp, frame in zip(agent.grasps, team.object.grasp_frames[first:], strict=False):
        p_world_hand = data.oMf[model.getFrameId(grasp.frame)].translation
        places.append(p_world_hand - lifted.frames[lifted.getFrameId(frame)].placement.translation)
    return np.asarray(np.mean(places, axis=0))


def distinct(postures: Iterable[Posture | None], apart: float) -> list[Posture]:
    """Return the postures that differ by more than ``apart`` [rad] in some joint, the first of each kind."""
    kept: list[Posture] = []
    for posture in postures:
        if posture and all(np.abs(posture.coordinates - other.coordinates).max() > apart for other in kept):
            kept.append(posture)
    return kept
