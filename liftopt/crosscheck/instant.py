"""The equations of a lift at one instant, as CasADi expressions, written apart from the knot kernels of the solve.

Agents: Pinocchio's RNEA with the grasp reaction as an external force on the joint that carries the grasp. Object:
Newton's and Euler's equations in closed form, no Pinocchio. Both with the models' numbers in place. A hold without
moments has no unknowns for them; where one hold has them, they serve all six rows of the object's balance.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt
import pinocchio as pin

from liftopt.collocation.task import LiftTask
from liftopt.crosscheck.holds import bearable, footing, room
from liftopt.multibody.agent import Agent, LiftedObject
from liftopt.multibody.disc import at_the_cut, cut_model
from liftopt.multibody.standing import rooted
from liftopt.types import Array

OBJECT_SIZE, FORCE_SIZE = 6, 3


@dataclass(frozen=True)
class Coordinates:
    """What moves: the agents' joints that are not locked, then the object's coordinates that are not locked.

    Attributes:
        joints: number of moving joints of each agent.
        unlocked: which of the object's six coordinates may move; those whose range is one value stay there.
        locked_pose: (6,) that value, 0 for the others.
        turning: which grasps of all transmit moments.
        grasps: number of all grasps.
    """

    joints: tuple[int, ...]
    unlocked: npt.NDArray[np.int64]
    locked_pose: Array
    turning: tuple[int, ...]
    grasps: int

    @staticmethod
    def of(agents: tuple[Agent, ...], task: LiftTask) -> Coordinates:
        """Read off who moves what."""
        locked, grasps = task.pose_lower == task.pose_upper, [grasp for agent in agents for grasp in agent.grasps]
        return Coordinates(
            tuple(len(agent.posture) for agent in agents),
            np.flatnonzero(~locked),
            np.where(locked, task.pose_lower, 0),
            tuple(g for g, grasp in enumerate(grasps) if grasp.moments),
            len(grasps),
        )

    @property
    def n_joints(self) -> int:
        """Number of moving joints of all agents."""
        return sum(self.joints)

    @property
    def n_q(self) -> int:
        """Number of coordinates."""
        return self.n_joints + len(self.unlocked)

    @property
    def n_force(self) -> int:
        """Number of components of the grasp forces."""
        return FORCE_SIZE * self.grasps

    @property
    def n_moment(self) -> int:
        """Number of components of the grasp moments."""
        return FORCE_SIZE * len(self.turning)

    @property
    def sizes(self) -> tuple[int, ...]:
        """Numbers of unknowns of one point: coordinates, rates, accelerations, forces, moments and torques."""
        return (self.n_q, self.n_q, self.n_q, self.n_force, self.n_moment, self.n_joints)

    def select(self, columns: Array, pose: Array) -> Array:
        """Return (K, n_q) coordinates from the joints' (K, n_joints) and the object's six (K, 6)."""
        return np.hstack([columns, pose[:, self.unlocked]])


@dataclass(frozen=True)
class Instant:
    """Functions of y = (q, v, a, f, m, tau) at one instant: coordinates, rates, grasp forces, moments, joint torques.

    Attributes:
        coordinates: what moves.
        dynamics: y -> (n_joints,) torques less those that the motion and the grasp reaction need [Nm].
        balance: y -> (6,) force, world axes, and moment, body axes, that the object's motion needs, less what the
            grasps give [N, Nm].
        closure: q -> (3 grasps,) each grasp point less the object's [m].
        grasp: y -> (grasps,) squared norms of the grasp forces [N^2].
        hold: y -> what the holds leave of their other limits, see ``room``, and then what the soles leave of theirs,
            see ``footing``, and discs, see ``bearable``; empty for grips at points of agents that do not stand.
        workspace: q -> (grasps with a half-space,) distance of the grasp point from its border [m].
        tilt: q -> (agents with a trunk that leans,) 1 - cos of its angle to the vertical.
    """

    coordinates: Coordinates
    dynamics: Any
    balance: Any
    closure: Any
    grasp: Any
    hold: Any
    workspace: Any
    tilt: Any


def instant(agents: tuple[Agent, ...], lifted: LiftedObject, task: LiftTask) -> Instant:
    """Write the equations down for agents that hold one object, in the order of its grasp frames."""
    at = Coordinates.of(agents, task)
    q, v, a, force, moment, tau = (ca.SX.sym(*each) for each in zip("qvafmt", at.sizes, strict=True))
    forces, moments = ca.vertsplit(force, FORCE_SIZE), [ca.SX(FORCE_SIZE, 1)] * at.grasps
    for i, transmitted in zip(at.turning, ca.vertsplit(moment, FORCE_SIZE), strict=True):
        moments[i] = transmitted
    needed: list[Any] = []
    hands: list[Any] = []
    grips: list[Any] = []
    under: list[Any] = []
    tilts: list[Any] = []
    for agent, (first, last) in zip(agents, pairwise(np.cumsum([0, *at.joints]).tolist()), strict=True):
        s, held = slice(first, last), slice(len(hands), len(hands) + len(agent.grasps))
        tau_needed, ground, passed, points, axes = _agent(agent, q[s], v[s], a[s], forces[held], moments[held])
        needed.append(tau_needed)
        under += footing(agent.stance, ground) if agent.stance else []
        under += bearable(agent.disc, passed) if agent.disc else []
        tilts += _tilt(agent, q[s])
        hands += points
        grips += axes
    grasps, holders = zip(*((grasp, agent) for agent in agents for grasp in agent.grasps), strict=True)
    pose = [_six(at, x[at.n_joints :], constant) for x, constant in ((q, at.locked_pose), (v, 0.0), (a, 0.0))]
    balance, attitude, *edges = _object_equations(lifted)(*pose, force, ca.vertcat(*moments))
    left = [
        each
        for grasp, f, m, grip in zip(grasps, forces, moments, grips, strict=True)
        for each in room(grasp, f, m, grip, attitude)
    ]
    distances = [
        ca.dot(agent.workspace.normal, hand) - agent.workspace.offset
        for agent, hand in zip(holders, hands, strict=True)
        if agent.workspace is not None
    ]
    y = ca.vertcat(q, v, a, force, moment, tau)
    return Instant(
        at,
        ca.Function("dynamics", [y], ca.cse([tau - ca.vertcat(*needed)])),
        ca.Function("balance", [y], ca.cse([balance])),
        ca.Function("closure", [q], ca.cse([ca.vertcat(*hands) - ca.vertcat(*edges)])),
        ca.Function("grasp", [y], [ca.vertcat(*(ca.dot(f, f) for f in forces))]),
        ca.Function("hold", [y], ca.cse([ca.vertcat(*left, *under)])),
        ca.Function("workspace", [q], ca.cse([ca.vertcat(*distances)])),
        ca.Function("tilt", [q], ca.cse([ca.vertcat(*tilts)])),
    )


def _agent(
    agent: Agent, q: Any, v: Any, a: Any, forces: list[Any], moments: list[Any]
) -> tuple[Any, Any, Any, list[Any], list[Any]]:
    """Return the torques (n,) that an agent needs, what the ground does, what passes its disc, and its hands.

    These are grasp points (3,) and grip axes (3, 3) in the world. What the ground does to all that moves (6,) is told
    about the base's origin in its axes, of one who stands; of others it is empty. Through a disc pass axial force,
    lateral moment and the moment that extends; where there is none that is empty too.
    """
    import liftopt.pinocchio_casadi as cpin

    own, cut = np.arange(len(agent.posture)), slice(0, 0)
    reduced = agent.reduced()
    if agent.disc:
        reduced = cut_model(reduced, agent.disc)
        cut = at_the_cut(reduced, agent.disc.joint)
        own = np.delete(np.arange(reduced.nv), cut)
        q, v, a = (_at(own, each, reduced.nv) for each in (q, v, a))
    root = 1 if agent.stance else 0
    tree = rooted(reduced, agent.T_world_base) if agent.stance else reduced
    if agent.stance:
        q, v, a = ca.vertcat(ca.SX(6, 1), 1, q), ca.vertcat(ca.SX(6, 1), v), ca.vertcat(ca.SX(6, 1), a)
    model = cpin.Model(tree)
    data = model.createData()
    cpin.forwardKinematics(model, data, q)
    points, grips = [], []
    loads = [ca.SX(6, 1) for _ in range(tree.njoints)]
    for grasp, force, moment in zip(agent.grasps, forces, moments, strict=True):
        frame = reduced.frames[reduced.getFrameId(grasp.frame)]
        lever, joint = frame.placement.translation, frame.parentJoint + root
        placement = data.oMi[joint]
        reaction, twisting = (-ca.mtimes(placement.rotation.T, each) for each in (force, moment))
        loads[joint] += ca.vertcat(reaction, ca.cross(lever, reaction) + twisting)
        points.append(placement.translation + ca.mtimes(placement.rotation, lever))
        grips.append(ca.mtimes(placement.rotation, frame.placement.rotation @ grasp.R_hand_object))
    external = cpin.StdVec_Force([cpin.Force(load[:3], load[3:]) for load in loads])
    tau = cpin.rnea(model, model.createData(), q, v, a, external)
    joints = tau[6 * root :]
    return joints[own.tolist()], tau[: 6 * root], joints[cut], points, grips


def _at(places: npt.NDArray[np.int64], values: Any, size: int) -> Any:
    """Return so many zeros with values at these places."""
    spread = ca.SX(size, 1)
    spread[places.tolist()] = values
    return spread


def _tilt(agent: Agent, q: Any) -> list[Any]:
    """Return 1 - cos of the angle of an agent's trunk to the vertical; nothing of one without."""
    import liftopt.pinocchio_casadi as cpin

    if agent.lean is None:
        return []
    reduced = agent.reduced()
    trunk, upright = reduced.getJointId(agent.lean.joint), reduced.createData()
    pin.forwardKinematics(reduced, upright, pin.neutral(reduced))
    model = cpin.Model(reduced)
    data = model.createData()
    cpin.forwardKinematics(model, data, q)
    return [1 - ca.dot(data.oMi[trunk].rotation[2, :].T, ca.DM(upright.oMi[trunk].rotation[2]))]


def _object_equations(lifted: LiftedObject) -> Any:
    """Return (pose, rates, second derivatives, forces, moments) -> balance, attitude and each grasp point."""
    body, gravity, m = lifted.model.inertias[1], lifted.model.gravity.linear, len(lifted.grasp_frames)
    pose, rate, second = (ca.SX.sym(name, OBJECT_SIZE) for name in ("pose", "rate", "second"))
    force, moment = (ca.SX.sym(name, FORCE_SIZE * m) for name in ("force", "moment"))
    turn = _turn_x(pose[3]) @ _turn_y(pose[4]) @ _turn_z(pose[5])
    spin = turn.T @ ca.reshape(ca.jtimes(ca.vec(turn), pose, rate), 3, 3)
    omega = ca.vertcat(spin[2, 1], spin[0, 2], spin[1, 0])
    alpha = ca.jtimes(omega, ca.vertcat(pose, rate), ca.vertcat(rate, second))
    inertia = ca.DM(body.inertia)
    levers = [
        ca.DM(lifted.model.frames[lifted.model.getFrameId(name)].placement.translation) for name in lifted.grasp_frames
    ]
    newton = body.mass * (second[:3] - gravity)
    euler = inertia @ alpha + ca.cross(omega, inertia @ omega)
    for lever, push, twist in zip(levers, *(ca.vertsplit(each, FORCE_SIZE) for each in (force, moment)), strict=True):
        newton -= push
        euler -= ca.cross(lever, turn.T @ push) + turn.T @ twist
    points = [pose[:3] + turn @ lever for lever in levers]
    return ca.Function("object", [pose, rate, second, force, moment], [ca.vertcat(newton, euler), turn, *points])


def _six(at: Coordinates, unlocked: Any, constant: Any) -> Any:
    pose = ca.SX(np.broadcast_to(constant, OBJECT_SIZE).tolist())
    for i, coordinate in enumerate(at.unlocked):
        pose[int(coordinate)] = unlocked[i]
    return pose


def _turn_x(angle: Any) -> Any:
    c, s = ca.cos(angle), ca.sin(angle)
    return ca.vertcat(ca.horzcat(1, 0, 0), ca.horzcat(0, c, -s), ca.horzcat(0, s, c))


def _turn_y(angle: Any) -> Any:
    c, s = ca.cos(angle), ca.sin(angle)
    return ca.vertcat(ca.horzcat(c, 0, s), ca.horzcat(0, 1, 0), ca.horzcat(-s, 0, c))


def _turn_z(angle: Any) -> Any:
    c, s = ca.cos(angle), ca.sin(angle)
    return ca.vertcat(ca.horzcat(c, -s, 0), ca.horzcat(s, c, 0), ca.horzcat(0, 0, 1))
