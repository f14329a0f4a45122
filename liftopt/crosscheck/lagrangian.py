"""Eqs. 1-5: inverse dynamics of a DH chain by recursive Lagrangian, with external forces and moments.

Arefeen et al. (2023), section 2.2. Vectors are in the axes of the chain's root frame; the frame's placement in the
world is the caller's. A load ACTING ON the chain lowers the torque: tau = inertia - gravity - force - moment.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from liftopt.crosscheck.kinematics import ChainMotion, chain_motion
from liftopt.multibody.dh import BodyInertia, DHChain
from liftopt.types import Array


@dataclass(frozen=True)
class ExternalLoad:
    """A force at a point of one link, and a moment on that link, in each of S states.

    Attributes:
        link: index of the link, that is of the row that moves it, from 0.
        point: (3,) or (S, 3) r_k, where the force acts, in the link's DH frame [m].
        force: (S, 3) f_k, root axes [N].
        moment: (S, 3) h_k, root axes [Nm].
    """

    link: int
    point: Array
    force: Array
    moment: Array


@dataclass(frozen=True)
class TorqueTerms:
    """The four terms on the right of eq. 1, with their signs, each (S, n) [Nm, or N at a prismatic joint].

    Attributes:
        inertia: first term, inertia and Coriolis.
        gravity: second term.
        force: third term, external forces.
        moment: fourth term, external moments.
    """

    inertia: Array
    gravity: Array
    force: Array
    moment: Array

    @property
    def tau(self) -> Array:
        """Their sum (S, n), the left of eq. 1."""
        return self.inertia + self.gravity + self.force + self.moment


def pseudo_inertia(body: BodyInertia) -> Array:
    """Return I_i (4, 4), the integral of r r^T dm over the body with r = [x y z 1] in the body's frame."""
    second = 0.5 * np.trace(body.inertia) * np.eye(3) - body.inertia + body.mass * np.outer(body.com, body.com)
    pseudo = np.empty((4, 4))
    pseudo[:3, :3] = second
    pseudo[:3, 3] = pseudo[3, :3] = body.mass * body.com
    pseudo[3, 3] = body.mass
    return pseudo


def homogeneous(vectors: Array, last: float) -> Array:
    """Return (..., 4) from (..., 3): ``last`` is 1 for a point, 0 for a direction, a force or a moment."""
    return np.concatenate([vectors, np.full((*vectors.shape[:-1], 1), last)], axis=-1)


def joint_axes(chain: DHChain, motion: ChainMotion) -> Array:
    """Return A_{i-1} z_0 (n, S, 3) of eq. 1, root axes: z_{i-1} of a revolute joint, zero for a prismatic one."""
    axes: Array = motion.placement[:-1, :, :3, 2].copy()
    axes[[row.kind == "prismatic" for row in chain.rows]] = 0.0
    return axes


def force_vectors(motion: ChainMotion, link: int, point: Array) -> Array:
    """Return (n, S, 4) of F_i, eq. 4: ``point`` of ``link`` seen from the frame of link i, zero beyond ``link``."""
    vectors = np.zeros((len(motion.step), motion.samples, 4))
    vectors[link] = homogeneous(np.broadcast_to(point, (motion.samples, 3)), 1.0)
    for i in range(link - 1, -1, -1):
        vectors[i] = _apply(motion.step[i + 1], vectors[i + 1])
    return vectors


def torque_terms(chain: DHChain, motion: ChainMotion, gravity: Array, loads: Sequence[ExternalLoad]) -> TorqueTerms:
    """Return the four terms of eq. 1 by the backward recursions, eqs. 2-5.

    Eq. 4 is written for one loaded link; each load has a recursion of its own here and the terms add up.

    Args:
        chain: n rows and n inertias.
        motion: of that chain, from ``chain_motion``.
        gravity: (3,) in root axes [m/s^2]; (0, -9.81, 0) in the paper's frame.
        loads: forces and moments that act on the chain.

    Returns:
        Inertia, gravity, force and moment terms of every joint.
    """
    n, samples = len(chain.rows), motion.samples
    inertia, weight, force, moment = np.zeros((4, samples, n))
    momentum_rate, first_moment, couple = np.zeros((samples, 4, 4)), np.zeros((samples, 4)), np.zeros((samples, 3))
    g, axes = homogeneous(gravity, 0.0), joint_axes(chain, motion)
    for i in range(n - 1, -1, -1):
        pseudo = pseudo_inertia(chain.inertias[i])
        if i + 1 < n:
            momentum_rate = motion.step[i + 1] @ momentum_rate
            first_moment = _apply(motion.step[i + 1], first_moment)
        momentum_rate = pseudo @ motion.acceleration[i + 1].swapaxes(1, 2) + momentum_rate  # D_i, eq. 2
        first_moment = pseudo[:, 3] + first_moment  # E_i, eq. 3: the last column of I_i is m_i [r_i 1]
        couple = couple + sum(load.moment for load in loads if load.link == i)  # G_i, eq. 5
        inertia[:, i] = np.einsum("sjk,skj->s", motion.partial[i], momentum_rate)
        weight[:, i] = -_apply(motion.partial[i], first_moment) @ g
        moment[:, i] = -np.einsum("sj,sj->s", couple, axes[i])
    for load in loads:
        pushed = np.einsum("nsjk,nsk->nsj", motion.partial, force_vectors(motion, load.link, load.point))
        force -= np.einsum("sj,nsj->sn", load.force, pushed[..., :3])
    return TorqueTerms(inertia, weight, force, moment)


def inverse_dynamics(
    chain: DHChain, q: Array, v: Array, a: Array, gravity: Array, loads: Sequence[ExternalLoad] = ()
) -> Array:
    """Return the generalized forces tau (S, n) of eq. 1 for states q, v, a (S, n); see ``torque_terms``."""
    return torque_terms(chain, chain_motion(chain, q, v, a), gravity, loads).tau


def _apply(matrices: Array, vectors: Array) -> Array:
    product: Array = np.einsum("sij,sj->si", matrices, vectors)
    return product
