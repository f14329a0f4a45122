"""What the objective weighs of each part of the NLP: an agent or the object."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from liftopt.collocation.layout import FORCE_SIZE, OBJECT_SIZE
from liftopt.collocation.task import TILT, LiftTask
from liftopt.collocation.wrench_dynamics import WRENCH_SIZE
from liftopt.multibody.agent import Agent, Comfort, JointLimits
from liftopt.types import Array

ANGLES = slice(3, 5)  # roll and pitch among an object's knot variables
RANGE_ROWS = 5


@dataclass(frozen=True)
class Weights:
    """Weights of one part in the objective, per unit of phase.

    Attributes:
        above, below: (n_squared,) of the squared leading outputs where they are above zero, and where not.
        variable: (n_y,) of the squared knot variables.
        range: (5, m) of the m leading knot variables: neutral value, factors of the squared distance from it below
            and above, and of its fourth power below and above; m is 0 where none of them costs anything.
    """

    above: Array
    below: Array
    variable: Array
    range: Array

    @staticmethod
    def none(n_y: int) -> Weights:
        """Return those of a part that costs nothing, without squared outputs."""
        return Weights(np.zeros(0), np.zeros(0), np.zeros(n_y), np.zeros((RANGE_ROWS, 0)))

    def of_outputs(self, c: Array) -> Array:
        """Return the weight of each squared leading output in ``c`` (..., n_squared): that of its side."""
        return np.where(c > 0.0, self.above, self.below)

    def range_cost(self, y: Array) -> Array:
        """Return what the leading knot variables of ``y`` (..., n_y) cost, each for itself (..., m)."""
        neutral, *factors = self.range
        square_below, square_above, fourth_below, fourth_above = factors
        away = y[..., : len(neutral)] - neutral
        upper = np.real(away) > 0.0
        square, fourth = np.where(upper, square_above, square_below), np.where(upper, fourth_above, fourth_below)
        return np.asarray((square + fourth * away**2) * away**2)


def agent_weights(task: LiftTask, i: int, agent: Agent, n_y: int, posture_weight: float = 0.0) -> Weights:
    """Return what the objective weighs of agent ``i``, with ``n_y`` knot variables.

    The integrals over time are T times those over the phase, and qdd = q'' / T**2.
    """
    n, period = len(agent.posture), task.duration
    variable = _motion_weights(task, n, n_y, posture_weight)
    room = FORCE_SIZE if agent.pushes_at_a_point else WRENCH_SIZE
    for grasp in agent.grasps:
        first = 3 * n + room * agent.hands.index(grasp.frame)
        variable[first : first + FORCE_SIZE] = task.force_weight * period
        variable[first + FORCE_SIZE : first + room] = task.force_weight * period / grasp.breadth**2
    effort = np.full(n, task.agent_weights[i] * period)
    if agent.joint_weights is not None:
        effort = effort * agent.joint_weights
    below, above = (effort / unit**2 for unit in torque_units(agent.limits)) if task.shares else (effort, effort)
    if agent.spine is not None and task.spine_weight:
        below, above = (
            own + task.spine_weight * period * share**2 for own, share in zip((below, above), agent.spine, strict=True)
        )
    if agent.lean is not None:
        own = task.range_weight * period / (1.0 - np.cos(agent.lean.room)) ** 2
        below, above = np.append(below, own), np.append(above, own)
    return Weights(above, below, variable, _range(agent.comfort, task.range_weight * period))


def object_weights(task: LiftTask, n_y: int, posture_weight: float = 0.0) -> Weights:
    """Return what the objective weighs of the object; arguments as ``agent_weights``."""
    variable = _motion_weights(task, OBJECT_SIZE, n_y, posture_weight)
    variable[ANGLES] += task.tilt_weight * task.duration / TILT**2
    return replace(Weights.none(n_y), variable=variable)


def torque_units(limits: JointLimits) -> tuple[Array, Array]:
    """Return which torque counts as one, (n,) below zero and (n,) above [Nm]: the limit in that direction."""
    return -limits.tau_lower, limits.tau_upper


def _motion_weights(task: LiftTask, n: int, n_y: int, posture_weight: float) -> Array:
    """Return the weights (n_y,) of squared knot variables that agents and object have alike."""
    variable = np.zeros(n_y)
    variable[:n] = posture_weight
    variable[2 * n : 3 * n] = task.acceleration_weight * task.pace / task.duration**3
    return variable


def _range(comfort: Comfort | None, weight: float) -> Array:
    """Return ``Weights.range``."""
    if comfort is None or weight == 0.0:
        return np.zeros((RANGE_ROWS, 0))
    rooms, own = (comfort.room_lower, comfort.room_upper), (comfort.square_weight, comfort.weight)
    factors = [weight * each / room**power for each, power in zip(own, (2, 4), strict=True) for room in rooms]
    return np.stack([comfort.neutral, *factors])
