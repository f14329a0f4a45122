"""A solved motion as arrays over time: what every agent and the object do, by Pinocchio in double precision.

Everything is evaluated on the models loaded from the exported URDFs, all joints included, and never with the
kernels that the solver used.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from liftopt.multibody.agent import Agent, Grasp, JointLimits, Kind, LiftedObject, Stance
from liftopt.multibody.joint_units import JointUnits, units_of
from liftopt.multibody.robots.data_finding import DataFinding
from liftopt.types import Array

GRAVITY = 9.81  # m/s^2, as in the models
# Of an agent's motion.
CONSTANT = (
    "name", "kind", "joint_names", "moving", "sliding", "limits", "grasps", "stance", "p_world_base", "remarks",
)  # fmt: skip


@dataclass(frozen=True)
class AgentTrajectory:
    """The motion of one agent at K times; n joints in the order of its model, locked ones included.

    Attributes:
        name: of the agent.
        kind: what it is.
        joint_names: (n,) names.
        moving: (n,) False for the locked virtual joints.
        sliding: (n,) True for those that slide, whose position is in m and whose effort is in N; others turn.
        q, v, a: (K, n) position, velocity, acceleration [rad or m, per s, per s^2].
        tau: (K, n) generalised forces of RNEA with the grasp reaction [Nm or N].
        grasp_force: (K, grasps, 3) force of each grasp on the object, world axes [N].
        grasp_moment: (K, grasps, 3) moment on the object about the grasp point, world axes [Nm]; 0 where it has none.
        grasp_position: (K, grasps, 3) the agent's grasp points in the world [m].
        grip_rotation: (K, grasps, 3, 3) grip axes in the world: the object's if that hand is in its reference
            orientation.
        ground_force, ground_moment: (K, 3) reaction of the ground on the agent at its base point, world axes; of one
            who stands, on the feet too, at their origin.
        limits: of the moving joints.
        grasps: how it holds the object.
        stance: how it stands, None where its base holds it whatever it does.
        p_world_base: (3,) its base point [m].
        remarks: what was noticed about the data of its model as it was read; empty of one that a result has kept.
    """

    name: str
    kind: Kind
    joint_names: tuple[str, ...]
    moving: npt.NDArray[np.bool_]
    sliding: npt.NDArray[np.bool_]
    q: Array
    v: Array
    a: Array
    tau: Array
    grasp_force: Array
    grasp_moment: Array
    grasp_position: Array
    grip_rotation: Array
    ground_force: Array
    ground_moment: Array
    limits: JointLimits
    grasps: tuple[Grasp, ...]
    stance: Stance | None
    p_world_base: Array
    remarks: tuple[DataFinding, ...] = ()

    @property
    def centre_of_pressure(self) -> Array | None:
        """Where on the floor (K, 3) the ground bears one who stands, in the world [m]; NaN where it would have to pull.

        The reaction there has no moment but about the vertical.
        """
        if self.stance is None:
            return None
        vertical = np.where(self.ground_force[:, 2] > 0.0, self.ground_force[:, 2], np.nan)
        aside = np.stack([-self.ground_moment[:, 1], self.ground_moment[:, 0], 0.0 * vertical], axis=1)
        return np.asarray(self.p_world_base + aside / vertical[:, None])

    @property
    def load(self) -> Array:
        """Force (K, 3) of all its grasps together on the object, world axes [N]."""
        return np.asarray(self.grasp_force.sum(axis=1))

    @property
    def p_world_hold(self) -> Array:
        """Middle (K, 3) of its grasp points [m]."""
        return np.asarray(self.grasp_position.mean(axis=1))

    @property
    def moving_joints(self) -> tuple[str, ...]:
        """Names of the joints that are not locked, in the model's order."""
        return tuple(name for name, moves in zip(self.joint_names, self.moving, strict=True) if moves)

    @property
    def units(self) -> tuple[JointUnits, ...]:
        """Units of the joints that are not locked, in the model's order."""
        return tuple(units_of(bool(slides)) for slides in self.sliding[self.moving])

    def every(self, step: int) -> AgentTrajectory:
        """Return the trajectory at the first and every ``step``-th time after it."""
        over_time = {f.name: getattr(self, f.name)[::step] for f in fields(self) if f.name not in CONSTANT}
        return replace(self, **over_time)


@dataclass(frozen=True)
class ObjectTrajectory:
    """The motion of the object at K times.

    Attributes:
        name: of the object.
        pose: (K, 6) centre of mass in the world [m], then roll, pitch, yaw [rad] with R = Rx Ry Rz.
        pose_velocity, pose_acceleration: (K, 6) its rates.
        quaternion: (K, 4) x y z w.
        velocity, acceleration: (K, 6) linear then angular, world axes, at the centre of mass.
        grasp_position: (K, all agents' grasps, 3) its grasp points in the world [m].
        wrench: (K, 6) RNEA less what the grasps do: force along world axes [N], moment about body axes [Nm]; eq. 17.
    """

    name: str
    pose: Array
    pose_velocity: Array
    pose_acceleration: Array
    quaternion: Array
    velocity: Array
    acceleration: Array
    grasp_position: Array
    wrench: Array

    def every(self, step: int) -> ObjectTrajectory:
        """Return the trajectory at the first and every ``step``-th time after it."""
        over_time = {f.name: getattr(self, f.name)[::step] for f in fields(self) if f.name != "name"}
        return replace(self, **over_time)


def agent_trajectory(
    agent: Agent, q: Array, v: Array, a: Array, force: Array, moment: Array | None = None
) -> AgentTrajectory:
    """Return the trajectory of an agent from its moving joints (K, n_moving), forces and moments (K, grasps, 3) there.

    Without moments there are none; both act on the object. Those of one grasp may be (K, 3).
    """
    model, names = agent.model, tuple(list(agent.model.names)[1:])
    moving = np.array([name not in agent.locked_joints for name in names])
    full_q, full_v, full_a = (np.zeros((len(q), model.nv)) for _ in range(3))
    full_q[:, moving], full_v[:, moving], full_a[:, moving] = q, v, a
    data, frames = model.createData(), [model.frames[model.getFrameId(grasp.frame)] for grasp in agent.grasps]
    shape = (len(q), len(frames), 3)
    force = np.array(force, float).reshape(shape)
    moment = np.zeros_like(force) if moment is None else np.array(moment, float).reshape(shape)
    tau, point, root = np.zeros_like(full_q), np.zeros(shape), np.zeros((len(q), 6))
    grip = np.zeros((*shape, 3))
    slopes = np.zeros((len(q), 6, model.nv))
    for k in range(len(q)):
        slopes[k] = pin.computeJointJacobians(model, data, full_q[k]).reshape(6, -1)  # of one joint it is flat
        for g, frame in enumerate(frames):
            point[k, g] = data.oMi[frame.parentJoint].act(frame.placement.translation)
            grip[k, g] = data.oMi[frame.parentJoint].rotation
        tau[k] = pin.rnea(model, data, full_q[k], full_v[k], full_a[k])
        # The wrench that the first joint transmits holds all that moves against gravity and its own motion; what is
        # fixed to the ground (a robot's pedestal) is not part of it.
        root[k] = data.oMi[1].act(data.f[1]).vector
    p_world_base = model.jointPlacements[1].translation if agent.stance is None else agent.T_world_base[:3, 3]
    ground_force, ground_moment = root[:, :3], root[:, 3:] - cross(p_world_base, root[:, :3])
    for g, (frame, grasp) in enumerate(zip(frames, agent.grasps, strict=True)):
        f, m, p = force[:, g], moment[:, g], point[:, g]
        # The Jacobians (linear, then angular) are about the world's origin, so the force has its moment about it.
        wrench = np.hstack([f, cross(p, f) + m])
        tau += np.einsum("kci,kc->ki", slopes, wrench) * bearing(model, frame.parentJoint)
        grip[:, g] = grip[:, g] @ frame.placement.rotation @ grasp.R_hand_object
        ground_force, ground_moment = ground_force + f, ground_moment + cross(p - p_world_base, f) + m
    if agent.stance is not None:
        weight = np.array([0.0, 0.0, GRAVITY * agent.stance.mass])
        lever = agent.T_world_base[:3, :3] @ agent.stance.p_base_com
        ground_force, ground_moment = ground_force + weight, ground_moment + cross(lever, weight)
    return AgentTrajectory(
        agent.name, agent.kind, names, moving, agent.sliding, full_q, full_v, full_a, tau, force, moment, point, grip,
        ground_force, ground_moment, agent.limits, agent.grasps, agent.stance, np.array(p_world_base),
        agent.remarks,
    )  # fmt: skip


def grasps_of(agents: Sequence[AgentTrajectory]) -> Iterator[tuple[int, AgentTrajectory, int, Grasp]]:
    """Give all grasps of all agents in order: its number among all, the agent, its number among the agent's, itself."""
    number = 0
    for agent in agents:
        for own, grasp in enumerate(agent.grasps):
            yield number, agent, own, grasp
            number += 1


def limit_share(agent: AgentTrajectory) -> Array:
    """Return the torques (K, moving joints) of an agent as fractions of the limits in their directions."""
    tau = agent.tau[:, agent.moving]
    return np.where(tau >= 0.0, tau / agent.limits.tau_upper, tau / agent.limits.tau_lower)


def bearing(model: pin.Model, carrier: int) -> Array:
    """Return (nv,) 1 for the joints between the world and the joint ``carrier``, itself included, 0 for the others."""
    on = np.zeros(model.nv)
    for joint in model.supports[carrier].tolist()[1:]:
        on[model.idx_vs[joint] : model.idx_vs[joint] + model.nvs[joint]] = 1.0
    return on


def mirrored(matrices: Array) -> Array:
    """Return symmetric matrices (K, n, n) from their upper triangles, all that Pinocchio fills of a mass matrix."""
    return np.triu(matrices) + np.triu(matrices, 1).swapaxes(1, 2)


def object_trajectory(
    lifted: LiftedObject, x: Array, xdot: Array, xddot: Array, forces: Array, moments: Array | None = None
) -> ObjectTrajectory:
    """Return the object's trajectory from its six coordinates and rates (K, 6) and all grasps' forces and moments.

    Both are (K, grasps, 3), or flat; without moments there are none.
    """
    model, data = lifted.model, lifted.model.createData()
    frames = [model.getFrameId(name) for name in lifted.grasp_frames]
    rotation, (q, v, a) = attitude(x[:, 3:])[0], free_flyer_state(x, xdot, xddot)
    generalized, point = np.zeros((len(x), 6)), np.zeros((len(x), len(frames), 3))
    for k in range(len(x)):
        generalized[k] = pin.rnea(model, data, q[k], v[k], a[k])
        pin.framesForwardKinematics(model, data, q[k])
        for i, frame in enumerate(frames):
            point[k, i] = data.oMf[frame].translation
    force = np.reshape(forces, (len(x), len(frames), 3))
    moment = cross(point - x[:, None, :3], force).sum(axis=1)
    if moments is not None:
        moment += np.reshape(moments, force.shape).sum(axis=1)
    wrench = np.hstack([turned(rotation, generalized[:, :3]) - force.sum(axis=1),
                        generalized[:, 3:] - turned(rotation.swapaxes(1, 2), moment)])  # fmt: skip
    velocity = np.hstack([xdot[:, :3], turned(rotation, v[:, 3:])])
    acceleration = np.hstack([xddot[:, :3], turned(rotation, a[:, 3:])])
    return ObjectTrajectory(lifted.name, x, xdot, xddot, q[:, 3:], velocity, acceleration, point, wrench)


def free_flyer_state(x: Array, xdot: Array, xddot: Array) -> tuple[Array, Array, Array]:
    """Return Pinocchio's free-flyer q (..., 7), v, a (..., 6) from the six coordinates and their rates (..., 6) each.

    All that is done is analytic in its arguments, which may be complex.
    """
    (rotation, spin), rates = attitude(x[..., 3:]), xdot[..., 3:]
    omega, body_rotation = turned(spin, rates), rotation.swapaxes(-1, -2)
    # The axes of roll and pitch turn with the rotations that follow them.
    about_x, after_roll = spin[..., 0] * rates[..., :1], spin[..., 1] * rates[..., 1:2] + spin[..., 2] * rates[..., 2:]
    turning = cross(about_x, after_roll) + cross(spin[..., 1] * rates[..., 1:2], spin[..., 2] * rates[..., 2:])
    linear = turned(body_rotation, xdot[..., :3])
    v = np.concatenate([linear, omega], axis=-1)
    a = np.concatenate(
        [turned(body_rotation, xddot[..., :3]) - cross(omega, linear), turned(spin, xddot[..., 3:]) + turning],
        axis=-1,
    )
    return np.concatenate([x[..., :3], quaternion(x[..., 3:])], axis=-1), v, a


def attitude(angles: Array) -> tuple[Array, Array]:
    """Return R = Rx Ry Rz (..., 3, 3) and the map (..., 3, 3) from the angles' rates to the body's angular velocity.

    ``angles`` (..., 3) are roll, pitch and yaw; the angular velocity is along the body's axes.
    """
    (cr, cp, cy), (sr, sp, sy) = _each(np.cos(angles)), _each(np.sin(angles))
    zero, one = np.zeros_like(cr), np.ones_like(cr)
    rotation = np.stack(
        [cp * cy, -cp * sy, sp,
         cr * sy + sr * sp * cy, cr * cy - sr * sp * sy, -sr * cp,
         sr * sy - cr * sp * cy, sr * cy + cr * sp * sy, cr * cp],
        axis=-1,
    )  # fmt: skip
    spin = np.stack([cp * cy, sy, zero, -cp * sy, cy, zero, sp, zero, one], axis=-1)
    shape = (*np.shape(angles)[:-1], 3, 3)
    return rotation.reshape(shape), spin.reshape(shape)


def angle_between(one: Array, other: Array) -> Array:
    """Return the angle (K,) from rotations (K, 3, 3) to others [rad]."""
    # By the chord rather than the cosine, which is flat at zero: |R - S| = 2 sqrt(2) sin(angle / 2).
    chord = np.linalg.norm(one - other, axis=(1, 2))
    return np.asarray(2.0 * np.arcsin(np.minimum(1.0, chord / np.sqrt(8.0))))


def hand_turn(grasp: Grasp, rotation: Array, grip: Array) -> Array:
    """Return how far a hand is turned (K,) from its reference orientation on the object [rad]; around a bar, from it.

    Args:
        grasp: how it holds.
        rotation: (K, 3, 3) the object's axes in the world.
        grip: (K, 3, 3) the hand's grip axes in the world.
    """
    if grasp.bar is None:
        return angle_between(rotation, grip)
    one, other = rotation @ grasp.bar, grip @ grasp.bar
    return np.asarray(2.0 * np.arcsin(np.minimum(1.0, np.linalg.norm(one - other, axis=1) / 2.0)))


def quaternion(angles: Array) -> Array:
    """Return the quaternion (..., 4), x y z w, of Rx Ry Rz for roll, pitch and yaw (..., 3)."""
    half = np.asarray(angles) / 2
    (cr, cp, cy), (sr, sp, sy) = _each(np.cos(half)), _each(np.sin(half))
    return np.stack(
        [sr * cp * cy + cr * sp * sy, cr * sp * cy - sr * cp * sy,
         cr * cp * sy + sr * sp * cy, cr * cp * cy - sr * sp * sy],
        axis=-1,
    )  # fmt: skip


def turned(matrix: Array, vector: Array) -> Array:
    """Return matrices (..., m, n) times vectors (..., n)."""
    product: Array = np.einsum("...ij,...j->...i", matrix, vector)
    return product


def cross(left: Array, right: Array) -> Array:
    """Return the cross product of vectors (..., 3); of a few vectors NumPy's own takes several times as long."""
    (a, b, c), (x, y, z) = _each(left), _each(right)
    return np.stack([b * z - c * y, c * x - a * z, a * y - b * x], axis=-1)


def _each(vector: Array) -> tuple[Array, Array, Array]:
    return vector[..., 0], vector[..., 1], vector[..., 2]
