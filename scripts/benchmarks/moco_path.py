"""Moco's motion on our models: are they the same lift, and what is its objective here?"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.case import Case
from liftopt.collocation.layout import FORCE_SIZE, OBJECT_SIZE
from liftopt.collocation.motion import objective_weights
from liftopt.collocation.task import OBJECT_COORDINATES
from liftopt.multibody.trajectory import AgentTrajectory, ObjectTrajectory, agent_trajectory, object_trajectory
from liftopt.types import Array

RATES = ("q", "v", "a")


@dataclass(frozen=True)
class OnOurModels:
    """What Pinocchio makes of Moco's coordinates, rates and torques at its knots and midway between them.

    Attributes:
        objective: ours, by Simpson's rule, as Moco's is.
        closure: widest gap between a grasp point and the object's [m].
        torque: largest difference from Moco's torques with the grasp forces that fit best [Nm].
        balance: largest force or moment on the object that these leave, on the rows that point grasps serve [N, Nm].
        excess: largest over a torque limit [Nm], the cap on the grasp force [N] or the border in front of the body [m].
    """

    objective: float
    closure: float
    torque: float
    balance: float
    excess: float


def on_our_models(case: Case, found: dict[str, Any]) -> OnOurModels:
    """Evaluate ``found``, which ``moco_child.py`` writes.

    Moco's multipliers are not read: which grasp forces belong to its torques follows from the equations of motion,
    which are linear in them and leave no choice.
    """
    problem = case.problem
    agents, time = problem.team.agents, np.array(found["time"])
    served = np.ones(OBJECT_SIZE, bool)
    row = problem.team.object.unserved_row()
    if row is not None:
        served[row] = False
    wanted = [_columns(found["torques"], agent.moving_joints) for agent in agents]

    def move(force: Array) -> tuple[list[AgentTrajectory], ObjectTrajectory]:
        forces = force.reshape(len(time), len(agents), FORCE_SIZE)
        moved = [
            agent_trajectory(agent, *(_columns(found[kind], agent.moving_joints) for kind in RATES), forces[:, i])
            for i, agent in enumerate(agents)
        ]
        names = [f"{problem.team.object.name}_{name}" for name in OBJECT_COORDINATES]
        return moved, object_trajectory(problem.team.object, *(_columns(found[kind], names) for kind in RATES), forces)

    def off(force: Array) -> Array:
        moved, lifted = move(force)
        torques = [agent.tau[:, agent.moving] - own for agent, own in zip(moved, wanted, strict=True)]
        return np.hstack([*torques, lifted.wrench[:, served]])

    force = _fitted(off, len(time), FORCE_SIZE * len(agents))
    moved, lifted = move(force)
    left, joints = np.abs(off(force)), sum(own.shape[1] for own in wanted)
    gaps = [np.linalg.norm(agent.p_world_hold - lifted.grasp_position[:, i], axis=1) for i, agent in enumerate(moved)]
    return OnOurModels(
        objective=_objective(case, time, moved, lifted),
        closure=float(np.max(gaps)),
        torque=float(left[:, :joints].max()),
        balance=float(left[:, joints:].max()),
        excess=max(0.0, *(float(np.max(excess)) for excess in _excesses(case, moved))),
    )


def as_answer(lift: dict[str, Any]) -> dict[str, Any]:
    """Return the motion of a described lift as Moco's answer would have it."""
    named = {joint["name"]: joint for agent in lift["agents"] for joint in agent["joints"]}
    torques = {name: joint["tau"] for name, joint in named.items()}
    lifted = lift["object"]
    named |= {f"{lifted['name']}_{coordinate['name']}": coordinate for coordinate in lifted["coordinates"]}
    answer: dict[str, Any] = {kind: {name: state[kind] for name, state in named.items()} for kind in RATES}
    time = np.linspace(0.0, lift["duration"], 2 * lift["intervals"] + 1).tolist()
    return answer | {"torques": torques, "time": time}


def _excesses(case: Case, moved: list[AgentTrajectory]) -> Iterator[Array]:
    for model, agent in zip(case.problem.team.agents, moved, strict=True):
        tau, limits = agent.tau[:, agent.moving], agent.limits
        yield np.maximum(limits.tau_lower - tau, tau - limits.tau_upper)
        yield np.linalg.norm(agent.load, axis=1) - case.problem.task.max_grasp_force
        if model.workspace is not None:
            yield model.workspace.offset - agent.p_world_hold @ model.workspace.normal


def _fitted(off: Any, times: int, size: int) -> Array:
    """Return the forces (times, size) that make ``off`` smallest at every time; it is linear in them."""
    constant = off(np.zeros((times, size)))
    slopes = np.stack([off(np.tile(unit, (times, 1))) - constant for unit in np.eye(size)], axis=2)
    return np.array([np.linalg.lstsq(a, -b, rcond=None)[0] for a, b in zip(slopes, constant, strict=True)])


def _objective(case: Case, time: Array, moved: list[AgentTrajectory], lifted: ObjectTrajectory) -> float:
    weights = objective_weights(case.problem)
    accelerations = [lifted.pose_acceleration, *(agent.a[:, agent.moving] for agent in moved)]
    integrand = weights["acceleration"] * sum(np.sum(a**2, axis=1) for a in accelerations)
    for agent in moved:
        integrand = integrand + weights[agent.name] * np.sum(agent.tau[:, agent.moving] ** 2, axis=1)
        integrand = integrand + weights["force"] * np.sum(agent.load**2, axis=1)
    simpson = np.ones(len(time))
    simpson[1:-1:2], simpson[2:-1:2] = 4.0, 2.0
    return float((time[1] - time[0]) / 3.0 * simpson @ integrand)


def _columns(values: dict[str, list[float]], names: Any) -> Array:
    """Return (K, len(names)) of what is known by name; what Moco has no coordinate for, the roll, is 0."""
    length = len(next(iter(values.values())))
    return np.array([values.get(name, [0.0] * length) for name in names]).T
