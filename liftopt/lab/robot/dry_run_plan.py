"""What a solution asks of a robot, as a simulated arm follows it: the motion, and rest before and after it.

A motion that starts with a step of acceleration has another force on the gripper at its start than at rest before it,
and another torque. Rest holds the object by the smallest change of the forces, and moments if any, that the solution
has at that end: the squeeze between the hands stays.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftopt.lab.meant import the_robot
from liftopt.lab.robot.joint_map import JointMap
from liftopt.lab.robot.simulated_arm import STEP
from liftopt.multibody.trajectory import AgentTrajectory, agent_trajectory, cross, grasps_of
from liftopt.scenario.build import agent_of, object_of
from liftopt.solution.interpolation import linear, resample
from liftopt.solution.solution import Solution
from liftopt.types import Array

AHEAD = 0.1  # [s]: how far along the plan an arm is sought from where it was a tick before
AT_ONCE = 1e-6  # [s] between rest and motion


@dataclass(frozen=True)
class Plan:
    """The solution on a grid fine enough to interpolate, rest first and last; joints as the robot has them.

    Attributes:
        step: between rows of the motion [s].
        time: (K,) [s].
        position, torque: (K, n) [rad, Nm].
        tip: (K, 3) the grasp point in the world [m].
        force, moment: (K, 3) on the gripper at that point, world axes [N, Nm].
    """

    step: float
    time: Array
    position: Array
    torque: Array
    tip: Array
    force: Array
    moment: Array

    @classmethod
    def of(cls, solution: Solution, robot: str | None = None) -> Plan:
        """Return the plan of a solved lift.

        Args:
            solution: the lift.
            robot: its name; None where there is only one.

        Raises:
            InputError: no robot is the one that is meant.
        """
        interval = float(solution.time[1] - solution.time[0])
        dense = resample(solution, max(1, round(interval / STEP / 2)))
        arm, signs = the_robot(dense, robot), JointMap.of(dense, robot).signs
        force, moment, torque = -arm.grasp_force[:, 0], -arm.grasp_moment[:, 0], signs * arm.tau[:, arm.moving]
        before, after = (_at_rest(dense, arm, signs, k) for k in (0, -1))
        rows = [
            np.vstack([first, rows, last])
            for first, rows, last in zip(before, (torque, force, moment), after, strict=True)
        ]
        return cls(
            float(dense.time[1]),
            np.concatenate([[-AT_ONCE], dense.time, [dense.time[-1] + AT_ONCE]]),
            _ends_repeated(signs * arm.q[:, arm.moving]),
            rows[0],
            _ends_repeated(arm.grasp_position[:, 0]),
            rows[1],
            rows[2],
        )

    def progress(self, position: Array, last: int, time: float) -> int:
        """Return how far along the plan the arm is at a time [s]: the nearest row from ``last`` to ``AHEAD`` later.

        The end's two rows have one position: after the motion's time it is that of rest.
        """
        ahead = self.position[last : last + 1 + round(AHEAD / self.step)]
        reached = last + int(np.argmin(np.square(ahead - position).sum(axis=1)))
        return reached + (reached == len(self.time) - 2 and time > self.time[-2])

    def at(self, rows: Array, time: Array) -> Array:
        """Return rows (K, n) of the plan at ``time`` (T,): (T, n)."""
        return linear(self.time, rows, time)


def _ends_repeated(rows: Array) -> Array:
    return np.vstack([rows[:1], rows, rows[-1:]])


def _at_rest(dense: Solution, robot: AgentTrajectory, signs: Array, k: int) -> tuple[Array, Array, Array]:
    """Return a robot's torques (n,), force and moment on its gripper (3,) that hold the object still where it is."""
    lifted = object_of(dense.scenario, dense.urdfs)
    arms = dense.object.grasp_position[k] - dense.object.pose[k, :3]
    columns: list[Array] = []
    loads: list[Array] = []
    first = 0
    for g, agent, own_grasp, grasp in grasps_of(dense.agents):
        if agent.name == robot.name:
            first = sum(len(load) for load in loads)
        columns.append(np.vstack([np.eye(3), cross(arms[g], np.eye(3)).T]))
        loads.append(agent.grasp_force[k, own_grasp])
        if grasp.moments:
            columns.append(np.eye(6)[:, 3:])
            loads.append(agent.grasp_moment[k, own_grasp])
    grasp_map, load = np.hstack(columns), np.concatenate(loads)
    weight = np.append(-lifted.model.inertias[1].mass * lifted.model.gravity.linear, np.zeros(3))
    load = load + np.linalg.pinv(grasp_map) @ (weight - grasp_map @ load)
    own = load[first : first + 6] if robot.grasps[0].moments else np.append(load[first : first + 3], np.zeros(3))
    q, none = robot.q[[k]][:, robot.moving], np.zeros((1, int(robot.moving.sum())))
    still = agent_trajectory(
        agent_of(dense.scenario, robot.name, dense.urdfs), q, none, none, own[None, :3], own[None, 3:]
    )
    return signs * still.tau[0, robot.moving], -own[:3], -own[3:]
