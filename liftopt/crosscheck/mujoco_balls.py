"""Three hinges through one point as one ball joint, for a simulation in MuJoCo that may pass where they line up.

A shoulder is three hinges in a row with no mass between them. Where the first and the last axis are in line (gimbal
lock) their angles are not determined: the least deviation turns both by far, and with them the axis of the torque about
the middle one, so a simulation of hinges blows up in a motion that is sound. The same joint as a ball, moved by the
moment whose components along the axes are the solved torques, has no such place. Of 16 widely varied lifts the
simulation of five held within its bounds by hinges, of 14 by balls.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from liftopt.multibody.mujoco_model import import_mujoco
from liftopt.multibody.trajectory import AgentTrajectory, cross
from liftopt.types import Array

TOGETHER = 1e-9  # [m]: axes this near to each other meet in one point


@dataclass(frozen=True, eq=False)
class BallMotion:
    """The motion of one ball joint at K times; vectors along the axes of the body it carries.

    Attributes:
        hinges: names of the three hinges it stands for; MuJoCo's ball joint has the name of the last.
        quaternion: (K, 4) w x y z, from the body's orientation with the hinges at 0.
        velocity: (K, 3) angular velocity relative to the body before [rad/s].
        moment: (K, 3) that the joint transmits to the body [Nm].
        axes: (K, 3, 3) of the hinges, one a row.
    """

    hinges: tuple[str, str, str]
    quaternion: Array
    velocity: Array
    moment: Array
    axes: Array


def ball_joints(model: pin.Model) -> list[int]:
    """Return the last hinge of each three in a row whose axes meet and that have no mass between them."""
    found: list[int] = []
    for j in range(3, model.njoints):
        first, second = j - 2, j - 1
        apart = max(float(np.linalg.norm(model.jointPlacements[i].translation)) for i in (second, j))
        in_a_row = model.parents[j] == second and model.parents[second] == first
        light = all(np.all(model.inertias[i].matrix() == 0.0) for i in (first, second))
        revolute = all(model.joints[i].shortname().startswith("JointModelR") for i in (first, second, j))
        if in_a_row and light and revolute and apart < TOGETHER and (not found or first > found[-1]):
            found.append(j)
    return found


def make_balls(spec: Any, motions: Sequence[BallMotion]) -> None:
    """Turn the hinges of a MuJoCo specification into ball joints."""
    for motion in motions:
        for name in motion.hinges[:-1]:
            spec.delete(spec.joint(name))
        spec.joint(motion.hinges[-1]).type = import_mujoco().mjtJoint.mjJNT_BALL


def ball_motions(model: pin.Model, trajectory: AgentTrajectory) -> list[BallMotion]:
    """Return what the ball joints of an agent do.

    Args:
        model: of the agent.
        trajectory: its motion, whose torques (n,) the moments stand for.
    """
    data, joints, count = model.createData(), ball_joints(model), len(trajectory.q)
    rotation, axes = np.zeros((len(joints), count, 3, 3)), np.zeros((len(joints), count, 3, 3))
    moment = np.zeros((len(joints), count, 3))
    pin.forwardKinematics(model, data, pin.neutral(model))
    rest = _relative_rotations(model, data, joints)
    for k, (q, v, a) in enumerate(zip(trajectory.q, trajectory.v, trajectory.a, strict=True)):
        slopes = pin.computeJointJacobians(model, data, q)
        pin.rnea(model, data, q, v, a)
        relative = _relative_rotations(model, data, joints)
        for i, j in enumerate(joints):
            here = data.oMi[j]
            rotation[i, k] = rest[i].T @ relative[i]
            axes[i, k] = [here.rotation.T @ slopes[3:, model.idx_vs[h]] for h in (j - 2, j - 1, j)]
            moment[i, k] = data.f[j].angular
            for own in _beyond(model, trajectory, j):
                lever = trajectory.grasp_position[k, own] - here.translation
                held = cross(lever, trajectory.grasp_force[k, own]) + trajectory.grasp_moment[k, own]
                moment[i, k] += here.rotation.T @ held
    motions = []
    for i, j in enumerate(joints):
        columns = [model.idx_vs[h] for h in (j - 2, j - 1, j)]
        hinges = (model.names[j - 2], model.names[j - 1], model.names[j])
        quaternion = np.roll([pin.Quaternion(turned).coeffs() for turned in rotation[i]], 1, axis=1)
        velocity = np.einsum("kh,khc->kc", trajectory.v[:, columns], axes[i])
        motions.append(BallMotion(hinges, quaternion, velocity, moment[i], axes[i]))
    return motions


def _beyond(model: pin.Model, trajectory: AgentTrajectory, joint: int) -> list[int]:
    """Return which of an agent's grasps a joint carries."""
    carriers = [model.frames[model.getFrameId(grasp.frame)].parentJoint for grasp in trajectory.grasps]
    return [own for own, carrier in enumerate(carriers) if joint in model.supports[carrier].tolist()]


def _relative_rotations(model: pin.Model, data: pin.Data, joints: Sequence[int]) -> list[Array]:
    """Return how the body of each ball joint is turned in the body before it, where ``data`` has them."""
    before = [data.oMi[model.parents[j - 2]].rotation for j in joints]
    return [np.asarray(r.T @ data.oMi[j].rotation) for r, j in zip(before, joints, strict=True)]
