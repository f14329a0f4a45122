"""Forward simulation by MuJoCo with the solved torques: do they make the motion that they are said to make?

The grasps are equality constraints between the grasp points (``connect``), so MuJoCo finds the grasp forces itself;
contacts are off, the virtual joints are welded. Joints get the torques of the solution, between the knots too; three
hinges through one point are one ball joint and get the moment that these are components of (``mujoco_balls.py``).
Moments that grasps transmit act on hand and object as they were solved, along world axes.

Two grasps at points cannot hold the object about the line through them: the optimal-control problem locks that turn
and reports the moment this takes ("unserved moment"). The simulation leaves the turn free and applies that moment.

A simulation keeps the grasps together at all times, a solution at its knots: between them its grasp points are up to
1 mm apart. So it starts from, and a feedback holds it to, the motion with the grasps closed (``_closed``), else what
the transcription leaves open would show as torque: of an arm with heavy links up to a quarter of its limits.

Nothing is stabilised in the windows. Over the whole lift an open loop diverges, within 0.3 s on the paper's lift: the
object's centre lies above the line of the grasps, and arms that push each other through points buckle at wrist and
forearm, where there is little inertia. So a feedback holds joints and object to that motion, ``M (w^2 e + 2 w de/dt)``
with the inertia matrix M of the moment; what it adds to the solved torques is reported.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from liftopt.crosscheck.mujoco_balls import BallMotion, ball_motions, make_balls
from liftopt.errors import ModelError
from liftopt.multibody.mujoco_model import States, import_mujoco, spec_of, states_of
from liftopt.multibody.trajectory import grasps_of
from liftopt.scenario.build import agents_of, object_of
from liftopt.solution.interpolation import resample
from liftopt.solution.solution import Solution
from liftopt.types import Array

TIME_STEP = 5e-4  # [s], at most
SETTLING = 0.02  # time constant with which the constraints close a gap of the grasp points [s]
HARDNESS = 0.9999  # of the constraints: the most MuJoCo allows, so its grasp forces are good to some 1e-3
WINDOW = 0.05  # [s]
ROLL = 3
LOST = 1.0  # [rad, m]: a simulation that is this far off is stopped
# Of the feedback [rad/s]. Deviations grow as exp(49 t) at worst on the paper's lift and exp(114 t) on a lift with the
# arm nearly straight, where humeral rotation meets hardly any inertia (eigenvalues of the linearised simulation).
BANDWIDTH = 160.0


@dataclass(frozen=True)
class Deviation:
    """How far a simulation came off the solution, the largest over joints and times; infinite where it blew up.

    Attributes:
        joint: [rad; m of one that slides].
        position: of the object's centre [m].
        turn: of the object [rad].
    """

    joint: float
    position: float
    turn: float


@dataclass(frozen=True)
class Windows:
    """Open loop in short windows, each started on the solution, its grasps closed.

    Attributes:
        deviation: the largest over all windows.
        force: largest difference of MuJoCo's grasp forces from the solution's at the start of a window, over the
            largest grasp force.
        count: number of windows.
    """

    deviation: Deviation
    force: float
    count: int


@dataclass(frozen=True)
class Followed:
    """The whole lift with feedback.

    Attributes:
        deviation: from the solution.
        joints: (n,) names of the moving joints.
        torque: (n,) largest torque that the feedback added [Nm; N of a joint that slides].
        share: (n,) that over the joint's torque limit, the larger of its two.
        moment: largest moment that the feedback added on the object about the axes it can turn about [Nm].
    """

    deviation: Deviation
    joints: tuple[str, ...]
    torque: Array
    share: Array
    moment: float


@dataclass(frozen=True, eq=False)
class Simulation:
    """A solution in MuJoCo, ready to be simulated. Its methods raise InputError where MuJoCo is missing."""

    solution: Solution

    def windows(self, serve: bool = True) -> Windows:
        """Simulate open loop in windows of ``WINDOW``; without ``serve`` the unserved moment is left out."""
        steps = max(1, round(WINDOW / self._step))
        starts = range(0, len(self._states.qpos) - 1, steps)
        worst, force = np.zeros(3), 0.0
        for first in starts:
            force = max(force, self._start(first, serve))
            for k in range(first, min(first + steps, len(self._states.qpos) - 1)):
                worst = np.maximum(worst, self._advance(k, self._feedforward(k, serve)))
                if np.isinf(worst).any():
                    break
        peak = max(float(np.linalg.norm(agent.grasp_force, axis=2).max()) for agent in self._dense.agents)
        return Windows(Deviation(*worst.tolist()), force / peak, len(starts))

    def follow(self) -> Followed:
        """Simulate the whole lift with feedback on all joints and on the object's turn about its grasps."""
        added, moment, worst = np.zeros(len(self._hinges)), 0.0, np.zeros(3)
        self._start(0, True)
        for k in range(len(self._states.qpos) - 1):
            feedback = self._feedback(k)
            added = np.maximum(added, np.abs(self._at_hinges(k, feedback)))
            moment = max(moment, float(np.linalg.norm(feedback[self._turns])))
            worst = np.maximum(worst, self._advance(k, self._feedforward(k, True) + feedback))
            if np.isinf(worst).any():
                break
        limits = np.concatenate([agent.limits.effort for agent in self.solution.agents])
        return Followed(Deviation(*worst.tolist()), self._hinges, added, added / limits, moment)

    @cached_property
    def _mujoco(self) -> Any:
        return import_mujoco()

    @cached_property
    def _dense(self) -> Solution:
        interval = float(self.solution.time[1] - self.solution.time[0])
        return resample(self.solution, int(np.ceil(interval / TIME_STEP - 1e-9)))

    @property
    def _step(self) -> float:
        return float(self._dense.time[1])

    @cached_property
    def _model(self) -> Any:
        mujoco = self._mujoco
        spec = spec_of(
            self.solution.urdfs.values(), [name for agent in self.solution.agents for name in _pinned(agent)]
        )
        make_balls(spec, self._balls)
        for *_, hold in grasps_of(self.solution.agents):
            ends = (hold.frame, f"grasp_{hold.name}")
            for body in ends:
                spec.body(body).add_site().name = f"{body}_site"
            grasp = spec.add_equality()
            grasp.type, grasp.objtype = mujoco.mjtEq.mjEQ_CONNECT, mujoco.mjtObj.mjOBJ_SITE
            grasp.name1, grasp.name2 = (f"{body}_site" for body in ends)
            grasp.solref, grasp.solimp = [SETTLING, 1.0], [HARDNESS, HARDNESS, 1e-3, 0.5, 2.0]
        spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
        spec.option.timestep, spec.option.tolerance, spec.option.iterations = self._step, 1e-12, 200
        return spec.compile()

    @cached_property
    def _data(self) -> Any:
        return self._mujoco.MjData(self._model)

    @cached_property
    def _still(self) -> Any:
        """What closes the grasps, beside the simulation."""
        return self._mujoco.MjData(self._model)

    @cached_property
    def _balls(self) -> list[BallMotion]:
        models = agents_of(self.solution.scenario, self.solution.urdfs)
        pairs = zip(models, self._dense.agents, strict=True)
        return [ball for agent, trajectory in pairs for ball in ball_motions(agent.model, trajectory)]

    @cached_property
    def _states(self) -> States:
        states = states_of(self._model, self._dense.agents, self._dense.object)
        for ball in self._balls:
            at, rate = self._places[ball.hinges[-1]]
            states.qpos[:, at : at + 4], states.qvel[:, rate] = ball.quaternion, ball.velocity
            states.tau[:, rate] = ball.moment
        return states

    @cached_property
    def _moments(self) -> Array:
        """What grasps transmit to every body (K, bodies, 3), world axes [Nm]."""
        moments = np.zeros((len(self._dense.time), self._model.nbody, 3))
        for _, agent, own, grasp in grasps_of(self._dense.agents):
            moments[:, self._model.body(f"grasp_{grasp.name}").id] = agent.grasp_moment[:, own]
            moments[:, self._model.body(grasp.frame).id] = -agent.grasp_moment[:, own]
        return moments

    @cached_property
    def _places(self) -> dict[str, tuple[int, slice]]:
        """Where each joint but the object's stands in qpos, and in qvel."""
        model, balls = self._model, {ball.hinges[-1] for ball in self._balls}
        names = [model.joint(j).name for j in range(model.njnt)]
        joints = [model.joint(name) for name in names if name != f"{self.solution.object.name}_free"]
        firsts = [(j.name, int(j.qposadr[0]), int(j.dofadr[0])) for j in joints]
        return {name: (at, slice(rate, rate + (3 if name in balls else 1))) for name, at, rate in firsts}

    @cached_property
    def _joints(self) -> list[int]:
        return [dof for _, dofs in self._places.values() for dof in range(dofs.start, dofs.stop)]

    @cached_property
    def _hinges(self) -> tuple[str, ...]:
        """Names of the solution's moving joints."""
        return tuple(name for agent in self.solution.agents for name in agent.moving_joints)

    def _at_hinges(self, k: int, force: Array) -> Array:
        """Return the torques (n,) of the moving joints that generalised forces stand for at time ``k``."""
        torques = {name: force[dofs.start] for name, (_, dofs) in self._places.items()}
        for ball in self._balls:
            moment = force[self._places[ball.hinges[-1]][1]]
            torques |= dict(zip(ball.hinges, ball.axes[k] @ moment, strict=True))
        return np.array([torques[name] for name in self._hinges])

    @cached_property
    def _body(self) -> int:
        """First of the object's six places in qvel: linear, then angular in body axes."""
        return int(self._model.joint(f"{self.solution.object.name}_free").dofadr[0])

    @property
    def _grasps(self) -> int:
        return int(self.solution.object.grasp_position.shape[1])

    @cached_property
    def _rows(self) -> list[int]:
        """Rows of the balance of the turns that forces at the grasp points leave free: a single point leaves three."""
        try:
            return [object_of(self.solution.scenario, self.solution.urdfs).unserved_row() or ROLL]
        except ModelError:
            return [ROLL, ROLL + 1, ROLL + 2]

    @property
    def about(self) -> str:
        """About what forces at the grasp points leave the object free to turn, in words."""
        return f"about its {'xyz'[self._rows[0] - ROLL]} axis" if len(self._rows) == 1 else "about its one grasp"

    @property
    def _free(self) -> int:
        return self._body + self._rows[0]

    @property
    def _turns(self) -> list[int]:
        """Where in qvel the object can turn about its grasp points."""
        return [self._body + row for row in self._rows]

    @cached_property
    def _held(self) -> npt.NDArray[np.bool_]:
        """Which places (nv,) in qvel have feedback."""
        return np.isin(np.arange(self._model.nv), [*self._joints, *self._turns])

    def _closed(self, k: int) -> tuple[Array, Array]:
        """Return position and velocity at time ``k`` with the grasp points together, as near as inertia has it."""
        mujoco, model, data = self._mujoco, self._model, self._still
        data.qpos[:], rate = self._states.qpos[k], self._states.qvel[k].copy()
        for closing in (True, True, False):
            mujoco.mj_fwdPosition(model, data)
            slopes = data.efc_J.reshape(-1, model.nv)
            moved = np.zeros_like(slopes)
            mujoco.mj_solveM(model, data, moved, slopes)
            off = data.efc_pos if closing else slopes @ rate
            step = -moved.T @ np.linalg.lstsq(slopes @ moved.T, off, rcond=None)[0]
            if closing:
                mujoco.mj_integratePos(model, data.qpos, step, 1.0)
            else:
                rate += step
        return data.qpos.copy(), rate

    def _start(self, k: int, serve: bool) -> float:
        """Put the simulation on the solution, its grasps closed; return by how much its forces differ there [N]."""
        mujoco, data = self._mujoco, self._data
        mujoco.mj_resetData(self._model, data)
        data.qpos[:], data.qvel[:] = self._closed(k)
        data.qfrc_applied[:], data.xfrc_applied[:, 3:] = self._states.tau[k], self._moments[k]
        data.qfrc_applied[self._free] = self._dense.object.wrench[k, self._rows[0]] * serve
        mujoco.mj_forward(self._model, data)
        # A constraint's force acts on its first body along world axes: on the agent, from the object.
        forces = -data.efc_force.reshape(self._grasps, 3)
        wanted = np.concatenate([agent.grasp_force[k] for agent in self._dense.agents])
        return float(np.linalg.norm(forces - wanted, axis=1).max())

    def _feedforward(self, k: int, serve: bool) -> Array:
        """Return the solved torques, and the moment on the object if served, halfway through a step."""
        force: Array = self._states.tau[k : k + 2].mean(axis=0)
        force[self._free] = self._dense.object.wrench[k : k + 2, self._rows[0]].mean() * serve
        return force

    def _feedback(self, k: int) -> Array:
        model, data, held = self._model, self._data, self._held
        position, rate = self._closed(k)
        acceleration = BANDWIDTH**2 * self._away(position) + 2 * BANDWIDTH * (rate - data.qvel)
        force = np.zeros(model.nv)
        self._mujoco.mj_mulM(model, data, force, acceleration * held)
        return force * held

    def _advance(self, k: int, force: Array) -> Array:
        """Go from time ``k`` to the next; return the deviations there, those of ``Deviation``."""
        self._data.qfrc_applied[:] = force
        self._data.xfrc_applied[:, 3:] = self._moments[k : k + 2].mean(axis=0)
        self._mujoco.mj_step(self._model, self._data)
        error, at = self._away(self._states.qpos[k + 1]), self._body
        joints, position, turn = error[self._joints], error[at : at + 3], error[at + 3 : at + 6]
        worst = np.array([np.abs(joints).max(), np.linalg.norm(position), np.linalg.norm(turn)])
        # Stopped well before MuJoCo takes notice: it would start again at its own zero and write a log.
        return worst if np.all(worst < LOST) else np.full(3, np.inf)

    def _away(self, position: Array) -> Array:
        """Return how far (nv,) the simulation is from a position."""
        error = np.zeros(self._model.nv)
        self._mujoco.mj_differentiatePos(self._model, error, 1.0, self._data.qpos, position)
        return error


def _pinned(agent: Any) -> Iterator[str]:
    return (name for name, moves in zip(agent.joint_names, agent.moving, strict=True) if not moves)
