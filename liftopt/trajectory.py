"""A solved motion as arrays over time: what every agent and the object do, by Pinocchio in double precision.

Everything is evaluated on the models loaded from the exported URDFs, all joints included, and never with the
kernels that the solver used.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from liftopt.multibody.agent import Agent, JointLimits, LiftedObject

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class AgentTrajectory:
    """The motion of one agent at K times; n joints in the order of its model, pinned ones included.

    Attributes:
        name: of the agent.
        joint_names: (n,) names.
        moving: (n,) False for the pinned virtual joints.
        q, v, a: (K, n) position, velocity, acceleration [rad or m, per s, per s^2].
        tau: (K, n) generalised forces of RNEA with the grasp reaction [Nm or N].
        grasp_force: (K, 3) force on the object, world axes [N].
        grasp_position: (K, 3) the agent's grasp point in the world [m].
        ground_force, ground_moment: (K, 3) reaction of the ground on the agent at its base point, world axes.
        limits: of the moving joints.
    """

    name: str
    joint_names: tuple[str, ...]
    moving: npt.NDArray[np.bool_]
    q: Array
    v: Array
    a: Array
    tau: Array
    grasp_force: Array
    grasp_position: Array
    ground_force: Array
    ground_moment: Array
    limits: JointLimits


@dataclass(frozen=True)
class ObjectTrajectory:
    """The motion of the object at K times.

    Attributes:
        name: of the object.
        pose: (K, 6) centre of mass in the world [m], then roll, pitch, yaw [rad] with R = Rx Ry Rz.
        pose_velocity, pose_acceleration: (K, 6) its rates.
        quaternion: (K, 4) x y z w.
        velocity, acceleration: (K, 6) linear then angular, world axes, at the centre of mass.
        grasp_position: (K, agents, 3) its grasp points in the world [m].
        wrench: (K, 6) RNEA less the grasp forces: force along world axes [N], moment about body axes [Nm]; eq. 17.
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


def agent_trajectory(agent: Agent, q: Array, v: Array, a: Array, force: Array) -> AgentTrajectory:
    """Return the trajectory of an agent from its moving joints (K, n_moving) and its force on the object (K, 3)."""
    model = agent.model
    moving = np.array([name not in agent.pinned for name in list(model.names)[1:]])
    full_q, full_v, full_a = (np.zeros((len(q), model.nv)) for _ in range(3))
    full_q[:, moving], full_v[:, moving], full_a[:, moving] = q, v, a
    data, frame = model.createData(), model.getFrameId(agent.grasp_frame)
    tau, point, ground_force, ground_moment = np.zeros_like(full_q), *np.zeros((3, len(q), 3))
    p_world_base = model.jointPlacements[1].translation
    for k in range(len(q)):
        jacobian = pin.computeFrameJacobian(model, data, full_q[k], frame, pin.LOCAL_WORLD_ALIGNED)[:3]
        pin.forwardKinematics(model, data, full_q[k])
        point[k] = pin.updateFramePlacement(model, data, frame).translation
        free = pin.rnea(model, data, full_q[k], full_v[k], full_a[k])
        # The wrench that the first joint transmits holds all that moves against gravity and its own motion; what is
        # fixed to the ground (a robot's pedestal) is not part of it.
        root = data.oMi[1].act(data.f[1])
        tau[k] = free + jacobian.T @ force[k]
        ground_force[k] = root.linear + force[k]
        ground_moment[k] = root.angular - pin.skew(p_world_base) @ root.linear
        ground_moment[k] += pin.skew(point[k] - p_world_base) @ force[k]
    return AgentTrajectory(
        agent.name, tuple(list(model.names)[1:]), moving, full_q, full_v, full_a, tau, np.asarray(force, dtype=float),
        point, ground_force, ground_moment, agent.limits,
    )  # fmt: skip


def object_trajectory(
    held: LiftedObject, x: Array, xdot: Array, xddot: Array, forces: Array, data: pin.Data | None = None
) -> ObjectTrajectory:
    """Return the object's trajectory from its six coordinates and rates (K, 6) and all grasp forces (K, 3 agents).

    ``data`` is room to work in; after the call it holds the placements of the last row.
    """
    model = held.model
    data = data or model.createData()
    frames = [model.getFrameId(name) for name in held.grasp_frames]
    quaternion, velocity, acceleration = np.zeros((len(x), 4)), np.zeros((len(x), 6)), np.zeros((len(x), 6))
    points, wrench = np.zeros((len(x), len(frames), 3)), np.zeros((len(x), 6))
    for k in range(len(x)):
        q, v, a = free_flyer_state(x[k], xdot[k], xddot[k])
        generalized = pin.rnea(model, data, q, v, a)
        pin.framesForwardKinematics(model, data, q)
        rotation = data.oMi[1].rotation
        for i, frame in enumerate(frames):
            points[k, i] = data.oMf[frame].translation
            force = forces[k, 3 * i : 3 * i + 3]
            generalized[:3] -= rotation.T @ force
            generalized[3:] -= rotation.T @ (pin.skew(points[k, i] - x[k, :3]) @ force)
        quaternion[k] = q[3:]
        velocity[k] = [*xdot[k, :3], *(rotation @ v[3:])]
        acceleration[k] = [*xddot[k, :3], *(rotation @ a[3:])]
        wrench[k] = [*(rotation @ generalized[:3]), *generalized[3:]]
    return ObjectTrajectory(held.name, x, xdot, xddot, quaternion, velocity, acceleration, points, wrench)


def free_flyer_state(x: Array, xdot: Array, xddot: Array) -> tuple[Array, Array, Array]:
    """Return Pinocchio's free-flyer q (7,), v (6,), a (6,) from the six coordinates and their rates (6,) each."""
    roll, pitch, yaw = (pin.utils.rotate(axis, angle) for axis, angle in zip("xyz", x[3:], strict=True))
    rotation = roll @ pitch @ yaw
    about_x, about_y, about_z = yaw.T @ pitch.T[:, 0], yaw.T[:, 1], np.array([0.0, 0.0, 1.0])
    after_roll = about_y * xdot[4] + about_z * xdot[5]
    omega = about_x * xdot[3] + after_roll
    alpha = about_x * xddot[3] + about_y * xddot[4] + about_z * xddot[5]
    # The axes of roll and pitch turn with the rotations that follow them.
    alpha += pin.skew(about_x * xdot[3]) @ after_roll + pin.skew(about_y * xdot[4]) @ (about_z * xdot[5])
    linear = rotation.T @ xdot[:3]
    q = np.concatenate([x[:3], pin.Quaternion(rotation).coeffs()])
    v = np.concatenate([linear, omega])
    a = np.concatenate([rotation.T @ xddot[:3] - pin.skew(omega) @ linear, alpha])
    return q, v, a
