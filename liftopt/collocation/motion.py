"""A vector of unknowns as a motion: every agent and the object at any phases, by Pinocchio in double precision."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftopt.collocation.layout import FORCE_SIZE
from liftopt.collocation.problem import Problem
from liftopt.collocation.spline import RestToRestSpline, interpolate_linear
from liftopt.collocation.task import TILT
from liftopt.multibody.leaning import trunk_tilt
from liftopt.multibody.trajectory import (
    AgentTrajectory,
    ObjectTrajectory,
    agent_trajectory,
    grasps_of,
    limit_share,
    object_trajectory,
)
from liftopt.types import Array


@dataclass(frozen=True)
class Motion:
    """What everybody does at K times.

    Attributes:
        time: (K,) [s].
        agents: in the team's order.
        object: the object.
    """

    time: Array
    agents: tuple[AgentTrajectory, ...]
    object: ObjectTrajectory

    def every(self, step: int) -> Motion:
        """Return the motion at the first and every ``step``-th time after it."""
        return Motion(self.time[::step], tuple(agent.every(step) for agent in self.agents), self.object.every(step))


def motion_at(problem: Problem, spline: RestToRestSpline, x: Array, phase: Array) -> Motion:
    """Return the motion that the unknowns ``x`` stand for at ``phase`` (K,) in [0, 1]."""
    control, force = problem.unpack(x)
    period, layout = problem.task.duration, problem.layout
    q, v, a = (spline.basis(phase, order) @ control / period**order for order in range(3))
    wrenches = layout.wrenches(interpolate_linear(force, phase))
    forces, moments = wrenches[..., :FORCE_SIZE], wrenches[..., FORCE_SIZE:]
    agents = []
    for i, agent in enumerate(problem.team.agents):
        own, grasps = layout.columns(i), list(layout.grasps_of(i))
        agents.append(agent_trajectory(agent, q[:, own], v[:, own], a[:, own], forces[:, grasps], moments[:, grasps]))
    own = layout.columns(layout.n_agents)
    lifted = object_trajectory(problem.team.object, q[:, own], v[:, own], a[:, own], forces, moments)
    return Motion(phase * period, tuple(agents), lifted)


def objective_terms(problem: Problem, motion: Motion) -> dict[str, float]:
    """Return the unweighted integrals of the objective by the trapezoid rule over the times of a motion.

    Keys: each agent's name (squared torques of its moving joints, eq. 10, or squared shares of their limits in the
    torques' directions, as the task has it, times ``Agent.joint_weights``), ``"acceleration"`` (squared accelerations
    of those joints and of the object's six coordinates, times the task's pace) and ``"force"`` (squared grasp forces,
    and squared moments over the squared breadth of the hand); with shares, or where they have a weight, ``"range"``
    (what joint angles cost, see ``Comfort``) and ``"tilt"`` (the object's squared roll and pitch in units of
    ``TILT``); where it has a weight ``"spine"`` (squared shares in the load on agents' spines, see ``Agent.spine``).
    """
    task = problem.task
    step = np.diff(motion.time)
    weights = np.zeros(len(motion.time))
    weights[:-1] += step / 2
    weights[1:] += step / 2
    torques = {a.name: limit_share(a) if task.shares else a.tau[:, a.moving] for a in motion.agents}
    squares = {name: tau**2 for name, tau in torques.items()}
    for agent in problem.team.agents:
        if agent.joint_weights is not None:
            squares[agent.name] *= agent.joint_weights
    terms = {name: float(weights @ square.sum(axis=1)) for name, square in squares.items()}
    acceleration = sum((agent.a[:, agent.moving] ** 2).sum(axis=1) for agent in motion.agents)
    acceleration = acceleration + (motion.object.pose_acceleration**2).sum(axis=1)
    contact = [
        np.hstack([agent.grasp_force[:, own], agent.grasp_moment[:, own] / grasp.breadth])
        for _, agent, own, grasp in grasps_of(motion.agents)
    ]
    force = np.sum([(each**2).sum(axis=1) for each in contact], axis=0)
    terms |= {"acceleration": task.pace * float(weights @ acceleration), "force": float(weights @ force)}
    if "range" in (counted := objective_weights(problem)):
        comforts = [agent.comfort for agent in problem.team.agents]
        costs = [c.cost(a.q[:, a.moving]) for c, a in zip(comforts, motion.agents, strict=True) if c is not None]
        for agent, moved in zip(problem.team.agents, motion.agents, strict=True):
            costs += [agent.lean.cost(trunk_tilt(agent, moved.q))] if agent.lean else []
        terms["range"] = float(sum(weights @ cost for cost in costs))
    if "tilt" in counted:
        terms["tilt"] = float(weights @ ((motion.object.pose[:, 3:5] / TILT) ** 2).sum(axis=1))
    if "spine" in counted:
        spines = [agent.spine for agent in problem.team.agents]
        loads = [_spine_load(own, a) for own, a in zip(spines, motion.agents, strict=True) if own is not None]
        terms["spine"] = float(sum(weights @ load for load in loads))
    return terms


def _spine_load(shares: Array, agent: AgentTrajectory) -> Array:
    """Return the squared shares (K,) of an agent's torques in the load on its spine."""
    tau = agent.tau[:, agent.moving]
    return np.asarray(((np.where(tau > 0.0, shares[1], shares[0]) * tau) ** 2).sum(axis=1))


def objective_weights(problem: Problem) -> dict[str, float]:
    """Return the weight of each of ``objective_terms``."""
    task = problem.task
    weights = {agent.name: w for agent, w in zip(problem.team.agents, task.agent_weights, strict=True)}
    weights |= {"acceleration": task.acceleration_weight, "force": task.force_weight}
    more = {"range": task.range_weight, "tilt": task.tilt_weight}
    weights |= {name: weight for name, weight in more.items() if weight or task.shares}
    return weights | ({"spine": task.spine_weight} if task.spine_weight else {})
