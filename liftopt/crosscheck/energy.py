"""Conservation of energy: what torques and forces do, against how kinetic and potential energy change.

Along the motion between the knots (``solution/interpolation.py``) the power of every joint torque and of every grasp
force is integrated by Simpson's rule, in panels that end at the knots, and compared with Pinocchio's energies. The
work never meets the mass matrix and the energies never meet the torques, so a wrong torque, force or velocity shows.

An agent and the object each close their books to the error of the quadrature alone, of fourth order. All together
they close up to what the transcription leaves: the balance of the object holds at the knots only, as does closure, so
between them a grasp force moves two points that are a little apart. That work is given apart, and it is the
transcription's error in energy.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from liftopt.multibody.agent import Agent, LiftedObject
from liftopt.multibody.trajectory import AgentTrajectory, ObjectTrajectory, free_flyer_state, grasps_of
from liftopt.scenario.build import agents_of, object_of
from liftopt.solution.interpolation import resample
from liftopt.solution.solution import Solution
from liftopt.types import Array

TURNING = "grasp moments"


@dataclass(frozen=True)
class EnergyBooks:
    """The books of one agent, of the object or of all, at the K knots; everything is 0 at the first [J].

    Attributes:
        name: whose books.
        change: (K,) kinetic plus potential energy, less that of the start.
        work: name -> (K,) work done by the joint torques, the grasp forces and the rest.
    """

    name: str
    change: Array
    work: dict[str, Array]

    @property
    def error(self) -> float:
        """Largest difference of work and change of energy at a knot [J]."""
        return float(np.abs(np.sum(list(self.work.values()), axis=0) - self.change).max())

    @property
    def relative(self) -> float:
        """That error over the largest change of energy."""
        return self.error / float(np.abs(self.change).max())


def energy_books(solution: Solution, panels: int) -> tuple[EnergyBooks, ...]:
    """Return the books of each agent, of the object, and of all together.

    Work is under ``"torques"``, ``"grasp forces"`` (of the object on an agent, of the agents on the object) and, for
    the object, ``"unbalanced"``: the residual of the balance (eq. 17), which the motion needs and nobody gives. In the
    books of all, ``"unbalanced"`` also holds what the grasp forces do where the grasp points part between knots.
    Where grasps transmit moments, their work is apart under ``"grasp moments"``: in the books of all it is what they do
    on hands that turn on the object.

    Args:
        solution: what was solved.
        panels: panels of Simpson's rule between two knots.
    """
    factor = 2 * panels
    dense = resample(solution, factor)
    models = agents_of(solution.scenario, solution.urdfs)
    books = [_agent(*pair, dense.time, factor) for pair in zip(models, dense.agents, strict=True)]
    held_model = object_of(solution.scenario, solution.urdfs)
    books.append(_object(held_model, dense.object, dense.agents, dense.time, factor))
    *agents, lifted = books
    total = {
        "torques": np.sum([agent.work["torques"] for agent in agents], axis=0),
        "unbalanced": np.sum([book.work["grasp forces"] for book in books], axis=0) + lifted.work["unbalanced"],
    }
    if TURNING in lifted.work:
        total[TURNING] = np.sum([book.work[TURNING] for book in books if TURNING in book.work], axis=0)
    return (*books, EnergyBooks("all", np.sum([book.change for book in books], axis=0), total))


def turned_in_hands(books: tuple[EnergyBooks, ...]) -> float:
    """Return the largest work that moments do because hands turn on the object, over the largest change of energy."""
    total = books[-1]
    return float(np.abs(total.work.get(TURNING, np.zeros(1))).max() / np.abs(total.change).max())


def unexplained(books: tuple[EnergyBooks, ...]) -> float:
    """Return the transcription's error in energy: the largest unbalanced work over the largest change of energy."""
    total = books[-1]
    return float(np.abs(total.work["unbalanced"]).max() / np.abs(total.change).max())


def _agent(model: Agent, agent: AgentTrajectory, time: Array, factor: int) -> EnergyBooks:
    energy, grip = np.zeros(len(time)), np.zeros((len(time), len(model.grasps), 6))
    data, frames = model.model.createData(), [model.model.getFrameId(grasp.frame) for grasp in model.grasps]
    for k in range(len(time)):
        energy[k] = pin.computeMechanicalEnergy(model.model, data, agent.q[k], agent.v[k])
        pin.forwardKinematics(model.model, data, agent.q[k], agent.v[k])
        for own, frame in enumerate(frames):
            grip[k, own] = pin.getFrameVelocity(model.model, data, frame, pin.LOCAL_WORLD_ALIGNED).vector
    work = {
        "torques": _integral((agent.tau * agent.v).sum(axis=1), time, factor),
        "grasp forces": _integral(-(agent.grasp_force * grip[..., :3]).sum(axis=(1, 2)), time, factor),
    }
    if any(grasp.moments for grasp in agent.grasps):
        work[TURNING] = _integral(-(agent.grasp_moment * grip[..., 3:]).sum(axis=(1, 2)), time, factor)
    return EnergyBooks(agent.name, (energy - energy[0])[::factor], work)


def _object(
    model: LiftedObject, lifted: ObjectTrajectory, agents: Sequence[AgentTrajectory], time: Array, factor: int
) -> EnergyBooks:
    data, energy, unbalanced = model.model.createData(), np.zeros(len(time)), np.zeros(len(time))
    for k in range(len(time)):
        q, v, _ = free_flyer_state(lifted.pose[k], lifted.pose_velocity[k], lifted.pose_acceleration[k])
        energy[k] = pin.computeMechanicalEnergy(model.model, data, q, v)
        unbalanced[k] = lifted.wrench[k, :3] @ lifted.velocity[k, :3] + lifted.wrench[k, 3:] @ v[3:]
    power, turning = np.zeros(len(time)), np.zeros(len(time))
    for g, agent, own, _ in grasps_of(agents):
        lever, spin = lifted.grasp_position[:, g] - lifted.pose[:, :3], lifted.velocity[:, 3:]
        power += (agent.grasp_force[:, own] * (lifted.velocity[:, :3] + np.cross(spin, lever))).sum(axis=1)
        turning += (agent.grasp_moment[:, own] * spin).sum(axis=1)
    work = {"grasp forces": _integral(power, time, factor), "unbalanced": _integral(unbalanced, time, factor)}
    if any(grasp.moments for *_, grasp in grasps_of(agents)):
        work[TURNING] = _integral(turning, time, factor)
    return EnergyBooks(lifted.name, (energy - energy[0])[::factor], work)


def _integral(power: Array, time: Array, factor: int) -> Array:
    """Return the integral (K,) from the first knot to each, by Simpson's rule, ``factor / 2`` panels an interval."""
    step = np.diff(time)[::2]
    panels = step / 3 * (power[:-1:2] + 4 * power[1::2] + power[2::2])
    return np.concatenate([[0.0], np.cumsum(panels.reshape(-1, factor // 2).sum(axis=1))])
