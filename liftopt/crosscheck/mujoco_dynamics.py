"""Inverse dynamics of the solved motion by MuJoCo: the torques, and the balance of the free object."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftopt.multibody.mujoco_model import import_mujoco, joint_places, spec_of, states_of
from liftopt.multibody.trajectory import grasps_of
from liftopt.solution.solution import Solution
from liftopt.types import Array

# A symmetric lift takes no torque to turn or bend sideways; below this share of the largest torque it is rounding.
NO_TORQUE = 1e-6


@dataclass(frozen=True)
class InverseDynamics:
    """What MuJoCo finds where the solution says something too, at K times.

    Attributes:
        name: of the agent or object.
        labels: (n,) joints, or rows of the balance.
        ours, theirs: (K, n) torques with the grasp reaction applied, locked joints included [Nm, N]; for the object the
            wrench its motion needs less what the grasps give, force along world axes, moment about body axes.
        scale: (n,) what an error is relative to: the largest torque of the joint (at least ``NO_TORQUE`` of the
            agent's largest), the object's weight and its weight
            at half the span of the grasps; of a single grasp, at its distance from the centre of mass.
        gap: largest distance of a grasp point of the agent from where the solution has it [m]; 0 for the object.
    """

    name: str
    labels: tuple[str, ...]
    ours: Array
    theirs: Array
    scale: Array
    gap: float

    @property
    def relative(self) -> float:
        """Largest error over its scale."""
        return float((np.abs(self.ours - self.theirs).max(axis=0) / self.scale).max())

    @property
    def worst(self) -> str:
        """The label of that error."""
        return self.labels[int(np.argmax(np.abs(self.ours - self.theirs).max(axis=0) / self.scale))]


def inverse_dynamics(solution: Solution) -> tuple[InverseDynamics, ...]:
    """Return MuJoCo's inverse dynamics of each agent and of the object at all times of a solution.

    The grasp forces act as external forces at the grasp: on the object as they are, on an agent reversed, at the point
    where MuJoCo's own kinematics has the grasp.

    Raises:
        InputError: MuJoCo is not installed.
    """
    mujoco = import_mujoco()
    model = spec_of(solution.urdfs.values()).compile()
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    data, lifted = mujoco.MjData(model), solution.object
    states = states_of(model, solution.agents, lifted)
    grasps = list(grasps_of(solution.agents))
    bodies = [model.body(grasp.frame).id for *_, grasp in grasps]
    edges = [model.body(f"grasp_{grasp.name}").id for *_, grasp in grasps]
    top = model.body(lifted.name).id
    found, gaps = np.zeros_like(states.tau), dict.fromkeys((agent.name for agent in solution.agents), 0.0)
    for k in range(len(solution.time)):
        data.qpos[:], data.qvel[:], data.qacc[:] = states.qpos[k], states.qvel[k], states.qacc[k]
        mujoco.mj_inverse(model, data)
        external = np.zeros(model.nv)
        for i, agent, own, _ in grasps:
            force, moment = agent.grasp_force[k, own], agent.grasp_moment[k, own]
            mujoco.mj_applyFT(model, data, -force, -moment, data.xpos[bodies[i]], bodies[i], external)
            mujoco.mj_applyFT(model, data, force, moment, data.xpos[edges[i]], top, external)
            gap = float(np.linalg.norm(data.xpos[bodies[i]] - agent.grasp_position[k, own]))
            gaps[agent.name] = max(gaps[agent.name], gap)
        found[k] = data.qfrc_inverse - external
    results = []
    for agent in solution.agents:
        dofs = [dof for _, dof in joint_places(model, agent)]
        largest = np.abs(agent.tau).max(axis=0)
        scale = np.maximum(largest, NO_TORQUE * largest.max())
        results.append(
            InverseDynamics(agent.name, agent.joint_names, agent.tau, found[:, dofs], scale, gaps[agent.name])
        )
    weight = float(model.body_mass[top] * 9.81)
    points = lifted.grasp_position[0]
    apart = np.ptp(points, axis=0) / 2 if len(points) > 1 else points - lifted.pose[0, :3]
    span = np.linalg.norm(apart)
    first = int(model.joint(f"{lifted.name}_free").dofadr[0])
    labels = tuple(f"{kind} {axis}" for kind in ("force", "moment") for axis in "xyz")
    scale = weight * np.array([1.0, 1.0, 1.0, span, span, span])
    theirs = found[:, first : first + 6]
    return (*results, InverseDynamics(lifted.name, labels, lifted.wrench, theirs, scale, 0.0))
