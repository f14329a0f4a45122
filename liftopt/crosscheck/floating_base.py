"""Eq. 6: the floating-base table as a chain of six virtual joints, and its map to the free body that moves likewise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftopt.crosscheck.kinematics import ChainMotion
from liftopt.types import Array


@dataclass(frozen=True)
class BodyMotion:
    """Motion of a free body in S states: the free-flyer's coordinates of a six-joint chain's last link.

    Attributes:
        placement: (S, 4, 4) of the body frame in the world.
        twist: (S, 6) linear then angular velocity of the body frame, body axes [m/s, rad/s].
        twist_rate: (S, 6) time derivative of ``twist`` in body axes, the spatial acceleration [m/s^2, rad/s^2].
        jacobian: (S, 6, n) twist = jacobian @ v of the chain.
    """

    placement: Array
    twist: Array
    twist_rate: Array
    jacobian: Array


def body_motion(motion: ChainMotion, t_world_root: Array, t_link_body: Array) -> BodyMotion:
    """Return the motion of a body frame fixed to the chain's last link.

    With X the body's placement, X^-1 dX/dt is its twist as a (4, 4) matrix, and the rate of the twist follows from
    d2X/dt2; all three come from A_n, B_n and C_n.

    Args:
        motion: of the chain, n rows and S states.
        t_world_root: (4, 4) placement of the chain's root in the world.
        t_link_body: (4, 4) placement of the body frame in the last link's DH frame.
    """
    placement, rate, second = (
        t_world_root @ x[-1] @ t_link_body for x in (motion.placement, motion.velocity, motion.acceleration)
    )
    inverse = np.linalg.inv(placement)
    twist = inverse @ rate
    to_last = np.linalg.inv(motion.placement[1:]) @ motion.placement[-1]
    columns = inverse @ (t_world_root @ motion.partial @ to_last @ t_link_body)
    return BodyMotion(placement, _vee(twist), _vee(inverse @ second - twist @ twist), np.moveaxis(_vee(columns), 0, -1))


def body_wrench(body: BodyMotion, tau: Array) -> Array:
    """Return the wrench (S, 6), force then moment at the body frame in body axes, that ``tau`` (S, 6) stands for.

    Virtual work: tau = jacobian^T wrench. The map is singular where the second of Table 4's rotations is +-pi/2.
    """
    return np.asarray(np.linalg.solve(body.jacobian.swapaxes(1, 2), tau[..., None])[..., 0])


def joint_forces(body: BodyMotion, wrench: Array) -> Array:
    """Return tau (S, n) of the virtual joints for a ``wrench`` (S, 6) at the body frame in body axes."""
    forces: Array = np.einsum("sij,si->sj", body.jacobian, wrench)
    return forces


def _vee(matrices: Array) -> Array:
    """Return (..., 6), linear then angular, of twists written as (..., 4, 4) matrices."""
    skew = matrices[..., :3, :3]
    angular = np.stack([skew[..., 2, 1], skew[..., 0, 2], skew[..., 1, 0]], axis=-1)
    return np.concatenate([matrices[..., :3, 3], angular], axis=-1)
