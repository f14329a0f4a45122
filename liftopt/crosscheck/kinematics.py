"""Forward recursion of the recursive Lagrangian: global transforms A_i and their time derivatives B_i, C_i.

Everything is batched: S states are carried through one recursion as (S, 4, 4) arrays. Nothing here is shared with
Pinocchio or with the URDF export: a DH row is written out in closed form, not split at its joint.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftopt.multibody.dh import DHChain, DHRow, rotation_x
from liftopt.types import Array


@dataclass(frozen=True)
class ChainMotion:
    """What one forward recursion over a chain of n rows leaves behind, for S states.

    Index i counts rows from 0; ``placement[i]`` is the frame *before* row i and ``placement[i + 1]`` the one after
    it, hence the DH frame of link i. All frames are seen from the chain's root frame.

    Attributes:
        step: (n, S, 4, 4) T_i, the transform of each row.
        placement: (n + 1, S, 4, 4) A_i, beginning with the root's identity.
        velocity: (n + 1, S, 4, 4) B_i = dA_i/dt [1/s].
        acceleration: (n + 1, S, 4, 4) C_i = d2A_i/dt2 [1/s^2].
        partial: (n, S, 4, 4) dA_i/dq_i.
    """

    step: Array
    placement: Array
    velocity: Array
    acceleration: Array
    partial: Array

    @property
    def samples(self) -> int:
        """Number of states S."""
        return int(self.step.shape[1])

    def link_placement(self, link: int) -> Array:
        """Return A (S, 4, 4) of the DH frame of ``link``, in the root frame."""
        placement: Array = self.placement[link + 1]
        return placement


def row_transforms(row: DHRow, q: Array) -> tuple[Array, Array, Array]:
    """Return T, dT/dq and d2T/dq2, each (S, 4, 4), of one DH row at its joint values ``q`` (S,) [rad or m]."""
    revolute = row.kind == "revolute"
    theta = row.theta + q if revolute else np.full_like(q, row.theta)
    c, s = np.cos(theta), np.sin(theta)
    twist = rotation_x(row.alpha)
    ca, sa = twist[1, 1], twist[2, 1]
    step, first, second = (np.zeros((len(q), 4, 4)) for _ in range(3))
    step[:, 0] = np.stack([c, -s * ca, s * sa, row.a * c], axis=-1)
    step[:, 1] = np.stack([s, c * ca, -c * sa, row.a * s], axis=-1)
    step[:, 2, 1], step[:, 2, 2], step[:, 3, 3] = sa, ca, 1.0
    step[:, 2, 3] = row.d if revolute else row.d + q
    if revolute:
        first[:, 0], first[:, 1] = -step[:, 1], step[:, 0]
        second[:, :2] = -step[:, :2]
    else:
        first[:, 2, 3] = 1.0
    return step, first, second


def chain_motion(chain: DHChain, q: Array, v: Array, a: Array) -> ChainMotion:
    """Carry A_i, B_i and C_i from the root to the last link.

    Args:
        chain: n DH rows.
        q: (S, n) joint positions [rad or m].
        v: (S, n) joint velocities.
        a: (S, n) joint accelerations.

    Returns:
        The motion of every link in the root frame.

    Raises:
        ValueError: an array is not (S, n).
    """
    samples, n = len(q), len(chain.rows)
    for name, array in (("q", q), ("v", v), ("a", a)):
        if array.shape != (samples, n):
            raise ValueError(f"{chain.name}: {name} has shape {array.shape}, expected {(samples, n)}")
    step, partial = np.empty((2, n, samples, 4, 4))
    placement, velocity, acceleration = np.zeros((3, n + 1, samples, 4, 4))
    placement[0] = np.eye(4)
    for i, row in enumerate(chain.rows):
        step[i], first, second = row_transforms(row, q[:, i])
        qd, qdd = v[:, i, None, None], a[:, i, None, None]
        partial[i] = placement[i] @ first
        placement[i + 1] = placement[i] @ step[i]
        velocity[i + 1] = velocity[i] @ step[i] + partial[i] * qd
        acceleration[i + 1] = (
            acceleration[i] @ step[i]
            + 2.0 * velocity[i] @ first * qd
            + placement[i] @ second * qd**2
            + partial[i] * qdd
        )
    return ChainMotion(step, placement, velocity, acceleration, partial)


def at_rest(chain: DHChain, q: Array) -> ChainMotion:
    """Return the motion of the chain standing still at ``q`` (S, n): enough for what depends on position alone."""
    return chain_motion(chain, q, np.zeros_like(q), np.zeros_like(q))
