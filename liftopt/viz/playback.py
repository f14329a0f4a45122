"""A solved lift as a film: where every body is and what every hand pushes with, at a frame rate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from scipy.spatial.transform import Rotation

from liftopt.ergonomics.lift import subject_in
from liftopt.errors import NO_VALUE, InputError
from liftopt.multibody.agent import Agent, Grasp
from liftopt.multibody.poses import joint_placements
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.scenario.build import agents_of
from liftopt.scenario.grasps import placed_grasps
from liftopt.solution.interpolation import motion_between
from liftopt.solution.solution import Solution
from liftopt.types import Array
from liftopt.viz.base import base_of
from liftopt.viz.free_arm import hanging_arm
from liftopt.viz.holding import held_by_gripper, held_by_hand
from liftopt.viz.person_bodies import PersonBodies, bodies_between, half_way
from liftopt.viz.scene_pressure import pressure_body, pressure_placements
from liftopt.viz.who import robot_of

FRAME_RATE = 50.0  # [Hz]; the viewer interpolates in between


@dataclass(frozen=True)
class BodyTrack:
    """The motion of one body.

    Attributes:
        position: (K, 3) of its frame in the world [m].
        quaternion: (K, 4) x y z w, without sign flips from frame to frame.
    """

    position: Array
    quaternion: Array


@dataclass(frozen=True)
class ForceTrack:
    """The force of one hand on the object.

    Attributes:
        point: (K, 3) grasp point in the world [m].
        force: (K, 3) world axes [N].
    """

    point: Array
    force: Array


@dataclass(frozen=True)
class Playback:
    """A lift at K frames.

    Attributes:
        time: (K,) [s].
        bodies: by joint name for what an agent moves, by its own name for the object; hands and grippers
            are bodies too.
        forces: by grasp.
        zero: (4, 4) T_world_body in which what is drawn of a body is given: all joints at zero, or the
            identity for the object, palms, fingers and grippers, whose parts are given in their own frames.
        joints: names of the bodies that each agent moves, by agent.
        bases: (4, 4) T_world_base by agent, of its feet or of its arm's base: X ahead, Z up.
    """

    time: Array
    bodies: dict[str, BodyTrack]
    forces: dict[str, ForceTrack]
    zero: dict[str, Array]
    joints: dict[str, tuple[str, ...]]
    bases: dict[str, Array]


def playback_of(solution: Solution, frame_rate: float = FRAME_RATE) -> Playback:
    """Return the lift at ``frame_rate`` [Hz], the last frame at its very end.

    In between knots it is the spline that was solved. Forces are linear between knots, as the optimal-control problem
    has them.

    Raises:
        InputError: the solution holds numbers that are not finite, or its time does not run forward.
    """
    last = float(solution.time[-1])
    return playback_at(solution, np.linspace(0.0, last, max(2, round(last * frame_rate) + 1)))


def playback_at(solution: Solution, time: Array) -> Playback:
    """Return the lift at ``time`` (K,) [s], as ``playback_of`` does.

    Raises:
        InputError: as ``playback_of``.
    """
    _check(solution)
    knots, lifted = solution.time, solution.object
    pose = motion_between(knots, lifted.pose, lifted.pose_velocity, lifted.pose_acceleration, time)[0]
    T_world_object = np.array([_object_placement(row).homogeneous for row in pose])
    bodies: dict[str, BodyTrack] = {}
    forces: dict[str, ForceTrack] = {}
    zero: dict[str, Array] = {}
    joints: dict[str, tuple[str, ...]] = {}
    bases: dict[str, Array] = {}
    for agent, track in zip(agents_of(solution.scenario, solution.urdfs), solution.agents, strict=True):
        q = motion_between(knots, track.q, track.v, track.a, time)[0]
        placements = _placements(agent, q)
        upright = {name: list_[0] for name, list_ in _placements(agent, np.zeros((1, agent.model.nq))).items()}
        bases[agent.name] = base_of(agent)
        held_at = _grasp_placements(agent, placements)
        moved = _Moved(track, bases[agent.name], placements, upright, T_world_object, held_at)
        holding, drawn = _holding(solution, moved), _drawn(solution, moved)
        if (disc := pressure_placements(track, bases[agent.name], knots, time)) is not None:
            drawn[pressure_body(agent.name)] = disc, np.eye(4)
        moves = placements | holding | {name: list_ for name, (list_, _) in drawn.items()}
        bodies |= {name: _track(list_) for name, list_ in moves.items()}
        for own, grasp in enumerate(agent.grasps):
            forces[grasp.name] = _force(agent.model, grasp, track.grasp_force[:, own], knots, time, q)
        zero |= upright | dict.fromkeys(holding, np.eye(4))
        zero |= {name: bases[agent.name] @ at_zero for name, (_, at_zero) in drawn.items()}
        joints[agent.name] = tuple(moves)
    bodies[lifted.name] = _track(T_world_object)
    zero[lifted.name] = np.eye(4)
    return Playback(time, bodies, forces, zero, joints, bases)


@dataclass(frozen=True)
class _Moved:
    """An agent and where its joints are: T_world_joint by joint, over the lift (K, 4, 4) and at zero (4, 4).

    ``T_world_grasp`` (K, 4, 4) is the frame that its first grasp is at.
    """

    agent: AgentTrajectory
    T_world_base: Array
    placements: dict[str, Array]
    upright: dict[str, Array]
    T_world_object: Array
    T_world_grasp: Array

    def at_zero(self, joint: str) -> Array:
        """Return a joint at zero (4, 4), in the base's axes."""
        return np.asarray(np.linalg.inv(self.T_world_base) @ self.upright[joint])


def _holding(solution: Solution, moved: _Moved) -> dict[str, Array]:
    """Return T_world_body (K, 4, 4) of what an agent holds with, by body."""
    agent, half = moved.agent, _half(solution)
    if agent.kind == "robot":
        length = robot_of(solution.scenario, agent).tool.length
        return held_by_gripper(agent.name, length, moved.T_world_grasp, moved.T_world_object, half)
    subject, holds = subject_in(solution, agent.name), placed_grasps(solution.scenario)
    kinds = {placed.name: placed.hold for placed in holds}
    found: dict[str, Array] = {}
    for arm in PersonBodies.of(agent).arms:
        if arm.hand:
            hold, world = kinds[agent.grasps[arm.grasp].name], moved.placements[arm.wrist]
            zero = moved.at_zero(arm.wrist)
            found |= held_by_hand(arm.hand, subject, arm.side, hold, zero, world, moved.T_world_object, half)
    return found


def _drawn(solution: Solution, moved: _Moved) -> dict[str, tuple[Array, Array]]:
    """Return T_world_body (K, 4, 4) and T_base_body (4, 4) at zero of what no joint of a person moves alone, by body.

    A robot has nothing of the kind.
    """
    agent = moved.agent
    if agent.kind == "robot":
        return {}
    bodies, subject = PersonBodies.of(agent), subject_in(solution, agent.name)
    zero = {joint: moved.at_zero(joint) for joint in moved.placements}
    found = {
        name: (half_way(between, zero, moved.placements), between.T_base_joint)
        for name, between in bodies_between(bodies, subject).items()
    }
    if bodies.feet not in zero:
        found[bodies.feet] = np.tile(moved.T_world_base, (len(moved.T_world_object), 1, 1)), np.eye(4)
    for arm in bodies.arms:
        if not arm.moves:
            T_base_trunk, T_world_trunk = zero[bodies.trunk], moved.placements[bodies.trunk]
            T_object_world = np.asarray(np.linalg.inv(moved.T_world_object))
            hanging = hanging_arm(subject, arm.side, T_base_trunk, T_world_trunk, T_object_world, _half(solution))
            found[arm.upper] = hanging, T_base_trunk
    return found


def _half(solution: Solution) -> Array:
    """Return the half sizes of the object (3,) [m]."""
    lifted = solution.scenario.object
    return np.array([lifted.depth, lifted.width, lifted.height]) / 2.0


def _check(solution: Solution) -> None:
    name, lifted = solution.scenario.name, solution.object
    shown = [solution.time, lifted.pose, lifted.pose_velocity, lifted.pose_acceleration]
    shown += [values for agent in solution.agents for values in (agent.q, agent.v, agent.a, agent.grasp_force)]
    if not all(np.isfinite(values).all() for values in shown):
        raise InputError(name, NO_VALUE, "cannot be shown: the result holds numbers that are not finite")
    if len(solution.time) < 2 or not (np.diff(solution.time) > 0.0).all():
        raise InputError(name, NO_VALUE, "cannot be shown: the result's time does not run forward")


def _placements(agent: Agent, q: Array) -> dict[str, Array]:
    """Return T_world_joint (K, 4, 4) of every joint at each row of ``q`` (K, n)."""
    names = list(agent.model.names)[1:]
    found = joint_placements(agent.model, q, range(1, len(names) + 1))
    return {name: found[:, n] for n, name in enumerate(names)}


def _grasp_placements(agent: Agent, placements: dict[str, Array]) -> Array:
    """Return T_world_grasp (K, 4, 4) of the frame that an agent's first grasp is at."""
    model = agent.model
    frame = model.frames[model.getFrameId(agent.grasps[0].frame)]
    return np.asarray(placements[model.names[frame.parentJoint]] @ frame.placement.homogeneous)


def _object_placement(pose: Array) -> pin.SE3:
    """Return T_world_object from position and roll, pitch, yaw (6,) with R = Rx Ry Rz."""
    roll, pitch, yaw = (pin.utils.rotate(axis, angle) for axis, angle in zip("xyz", pose[3:], strict=True))
    return pin.SE3(roll @ pitch @ yaw, pose[:3])


def _force(model: pin.Model, grasp: Grasp, at_knots: Array, knots: Array, time: Array, q: Array) -> ForceTrack:
    data, frame = model.createData(), model.getFrameId(grasp.frame)
    points = np.zeros((len(time), 3))
    for k, row in enumerate(q):
        pin.forwardKinematics(model, data, row)
        points[k] = pin.updateFramePlacement(model, data, frame).translation
    force = np.stack([np.interp(time, knots, at_knots[:, i]) for i in range(3)], axis=1)
    return ForceTrack(points, force)


def _track(placements: Array) -> BodyTrack:
    turns = Rotation.from_matrix(placements[:, :3, :3]).as_quat()
    return BodyTrack(np.array(placements[:, :3, 3]), continuous(turns))


def continuous(quaternions: Array) -> Array:
    """Return unit ``quaternions`` (K, 4) with signs such that none is far from the one before it."""
    flips = np.where(np.sum(quaternions[1:] * quaternions[:-1], axis=1) < 0.0, -1.0, 1.0)
    signs = np.concatenate([[1.0], np.cumprod(flips)])
    return np.asarray(quaternions * signs[:, None])
