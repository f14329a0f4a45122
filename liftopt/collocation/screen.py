"""What makes a lift impossible before any solve: out of reach, too weak, or too fast, by name and amount."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import pinocchio as pin
from scipy.optimize import least_squares

from liftopt.collocation.guess import Posture, PostureSolver, seed_coordinates
from liftopt.collocation.layout import FORCE_SIZE, OBJECT_SIZE
from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.task import OBJECT_COORDINATES, LiftTask
from liftopt.trajectory import free_flyer_state

Array = npt.NDArray[np.float64]
REACHED = 1e-4  # [m]
SEEDS = 4
MAX_EVALUATIONS = 200
STEP = 1e-6
# Pulls the search toward the seed, too weakly to matter where the grasp can be reached.
REGULARISATION = 1e-4
STRONGEST = 64.0


@dataclass(frozen=True)
class Obstacle:
    """What is in the way.

    Attributes:
        constraint: ``"closure"``, ``"torque"``, ``"grasp_force"`` or ``"velocity"``.
        who: agent, joint or object.
        amount: how far it is from being met, in ``unit``.
        unit: of ``amount``; ``"times the limit"`` for strength.
        message: one sentence.
    """

    constraint: str
    who: str
    amount: float
    unit: str
    message: str


def too_fast(problem: Problem) -> Obstacle | None:
    """Return how much longer the lift must last for the object's speed limit, or None if it lasts long enough."""
    task = problem.task
    intervals = len(problem.mesh.phase) - 1
    # From rest to rest on N intervals the control points move on N - 2 of them.
    needed = np.abs(task.end - task.start) / task.pose_velocity * intervals / (intervals - 2)
    shortest = float(np.nanmax(needed))
    if shortest <= task.duration:
        return None
    which, held = OBJECT_COORDINATES[int(np.nanargmax(needed))], problem.team.held.name
    text = (
        f"too fast: the {held} would exceed its speed limit along {which}; "
        f"the lift must last at least {shortest:.2f} s, not {task.duration:g} s"
    )
    return Obstacle("velocity", held, shortest - task.duration, "s", text)


def screen(problem: Problem, seed: int, deadline: float) -> tuple[list[Obstacle], list[Posture]]:
    """Return what is in the way at the start and at the end, and the nearest posture of each end.

    Args:
        problem: the lift.
        seed: of the random seeds.
        deadline: ``time.monotonic`` value past which the search stops.
    """
    obstacles: list[Obstacle] = []
    postures: list[Posture] = []
    for name, pose in (("start", problem.task.start), ("end", problem.task.end)):
        obstacle, posture = _screen_end(problem, name, pose, np.random.default_rng(seed), deadline)
        postures.append(posture)
        if obstacle is not None:
            obstacles.append(obstacle)
    return obstacles, postures


def _screen_end(
    problem: Problem, name: str, pose: Array, rng: np.random.Generator, deadline: float
) -> tuple[Obstacle | None, Posture]:
    team = problem.team
    force = np.zeros(FORCE_SIZE * len(team.agents))
    nearest, gaps = np.zeros(0), np.full(len(team.agents), np.inf)
    for attempt in range(SEEDS):
        coordinates, left = _reach(team, problem.task, pose, seed_coordinates(problem, pose, rng if attempt else None))
        if left.max() < gaps.max():
            nearest, gaps = coordinates, left
        if gaps.max() < REACHED or time.monotonic() > deadline:
            break
    near = Posture(nearest, force, np.inf)
    if gaps.max() >= REACHED:
        worst = int(np.argmax(gaps))
        who = team.agents[worst].name
        text = f"out of reach at the {name} of the lift: the {who}'s grasp stays {gaps[worst]:.3f} m short"
        return Obstacle("closure", who, float(gaps[worst]), "m", text), near
    seeds = [nearest, *(seed_coordinates(problem, pose, rng) for _ in range(SEEDS - 1))]
    return _strength(problem, name, pose, seeds, deadline) or (None, near)


def _reach(team: Team, task: LiftTask, pose: Array, seed: Array) -> tuple[Array, Array]:
    """Return the coordinates that bring all grasps nearest, and the gap left to each agent [m]."""
    gaps = _Gaps(team, pose)
    lower = np.concatenate([*(agent.limits.q_lower for agent in team.agents), task.pose_lower[gaps.free]])
    upper = np.concatenate([*(agent.limits.q_upper for agent in team.agents), task.pose_upper[gaps.free]])
    start = np.clip(np.concatenate([seed[: gaps.n], seed[gaps.n :][gaps.free]]), lower, upper)
    found = least_squares(
        lambda z: np.concatenate([gaps(z), REGULARISATION * (z - start)]),
        start,
        lambda z: np.vstack([gaps.slope(z), REGULARISATION * np.eye(len(z))]),
        bounds=(lower, upper),
        max_nfev=MAX_EVALUATIONS,
    )
    return gaps.coordinates(found.x), np.linalg.norm(gaps(found.x).reshape(-1, 3), axis=1)


class _Gaps:
    """Vectors from the object's grasp points to the agents', as functions of joints and the pose's free coordinates."""

    def __init__(self, team: Team, pose: Array) -> None:
        self.team, self.pose, self.free = team, pose, np.flatnonzero(np.isnan(pose))
        self.models = [agent.reduced() for agent in team.agents]
        self.n = sum(model.nq for model in self.models)

    def coordinates(self, z: Array) -> Array:
        """Return joints and all six coordinates of the object."""
        whole = np.concatenate([z[: self.n], self.pose])
        whole[self.n + self.free] = z[self.n :]
        return whole

    def __call__(self, z: Array) -> Array:
        held = self.team.held
        data = held.model.createData()
        at_rest = np.zeros(OBJECT_SIZE)
        state, _, _ = free_flyer_state(self.coordinates(z)[self.n :], at_rest, at_rest)
        pin.framesForwardKinematics(held.model, data, state)
        targets = [data.oMf[held.model.getFrameId(name)].translation for name in held.grasp_frames]
        return np.concatenate([point - target for (point, _), target in zip(self._arms(z), targets, strict=True)])

    def slope(self, z: Array) -> Array:
        """Return the Jacobian (3 agents, len(z)); the free coordinates by central differences."""
        jacobian, at = np.zeros((3 * len(self.models), len(z))), 0
        for i, (_, slope) in enumerate(self._arms(z)):
            jacobian[3 * i : 3 * i + 3, at : at + slope.shape[1]] = slope
            at += slope.shape[1]
        for j in range(self.n, len(z)):
            step = np.zeros(len(z))
            step[j] = STEP
            jacobian[:, j] = (self(z + step) - self(z - step)) / (2 * STEP)
        return jacobian

    def _arms(self, z: Array) -> list[tuple[Array, Array]]:
        arms, at = [], 0
        for agent, model in zip(self.team.agents, self.models, strict=True):
            data, frame = model.createData(), model.getFrameId(agent.grasp_frame)
            q = z[at : at + model.nq]
            slope = pin.computeFrameJacobian(model, data, q, frame, pin.LOCAL_WORLD_ALIGNED)[:3].copy()
            pin.framesForwardKinematics(model, data, q)
            arms.append((data.oMf[frame].translation.copy(), slope))
            at += model.nq
        return arms


def _strength(
    problem: Problem, name: str, pose: Array, seeds: list[Array], deadline: float
) -> tuple[Obstacle | None, Posture] | None:
    """Find by bisection how many times stronger agents and grasps must be to hold still there.

    Returns the posture that holds, with an obstacle if that takes more than the limits; None if nothing helps.
    """
    weak, strong = 1.0, 1.0
    held = _hold(problem, pose, seeds, 1.0, deadline)
    if held:
        return None, held
    while held is None:
        weak, strong = strong, 2 * strong
        if strong > STRONGEST or time.monotonic() > deadline:
            return None
        held = _hold(problem, pose, seeds, strong, deadline)
    while strong / weak > 1.01 and time.monotonic() < deadline:
        middle = (weak * strong) ** 0.5
        # What holds with more strength is the best seed for less.
        posture = _hold(problem, pose, [held.coordinates, *seeds], middle, deadline)
        weak, strong, held = (weak, middle, posture) if posture else (middle, strong, held)
    if posture := _hold(problem, pose, [held.coordinates], 1.0, deadline):
        return None, posture
    constraint, who = _tightest(problem, held)
    what = "torque limit of" if constraint == "torque" else "grasp force cap of"
    text = f"too weak at the {name} of the lift: holding still needs about {strong:.2f} times the {what} {who}"
    return Obstacle(constraint, who, strong, "times the limit", text), held


def _hold(problem: Problem, pose: Array, seeds: list[Array], factor: float, deadline: float) -> Posture | None:
    """Return a posture that holds the object with ``factor`` times the strength, or None if no seed leads to one."""
    agents = []
    for agent in problem.team.agents:
        limits = agent.limits
        stronger = replace(limits, tau_lower=factor * limits.tau_lower, tau_upper=factor * limits.tau_upper)
        agents.append(replace(agent, limits=stronger))
    task = replace(problem.task, max_grasp_force=factor * problem.task.max_grasp_force)
    postures = PostureSolver(replace(problem.team, agents=tuple(agents)), task)
    return next((found for seed in seeds if (found := postures.solve(pose, seed, deadline))), None)


def _tightest(problem: Problem, posture: Posture) -> tuple[str, str]:
    """Return the constraint and who it belongs to that leaves the least room in a posture."""
    candidates, at = [], 0
    for i, agent in enumerate(problem.team.agents):
        model = agent.reduced()
        data, q = model.createData(), posture.coordinates[at : at + model.nq]
        at += model.nq
        force = posture.force[FORCE_SIZE * i : FORCE_SIZE * (i + 1)]
        frame = model.getFrameId(agent.grasp_frame)
        jacobian = pin.computeFrameJacobian(model, data, q, frame, pin.LOCAL_WORLD_ALIGNED)[:FORCE_SIZE]
        tau = pin.rnea(model, data, q, np.zeros(model.nv), np.zeros(model.nv)) + jacobian.T @ force
        share = np.where(tau > 0, tau / agent.limits.tau_upper, tau / agent.limits.tau_lower)
        candidates += [(float(s), "torque", joint) for s, joint in zip(share, agent.moving_joints, strict=True)]
        candidates.append((float(np.linalg.norm(force)) / problem.task.max_grasp_force, "grasp_force", agent.name))
    _, constraint, who = max(candidates)
    return constraint, who
