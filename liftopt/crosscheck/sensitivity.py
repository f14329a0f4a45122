"""Eqs. 7-9: derivative of the joint torques with respect to an external force, and its like for a moment.

Sign: eqs. 7-9 as printed omit the minus that the third term of eq. 1 carries. Here the derivative is that of eq. 1,
so it equals minus the transposed Jacobian of the loaded point.
"""

from __future__ import annotations

import numpy as np

from liftopt.crosscheck.kinematics import ChainMotion
from liftopt.crosscheck.lagrangian import force_vectors, joint_axes
from liftopt.multibody.dh import DHChain
from liftopt.types import Array


def force_sensitivity(motion: ChainMotion, link: int, point: Array) -> Array:
    """Return dtau/df (S, n, 3) of a force at ``point`` (3,) or (S, 3) of ``link``'s DH frame, eqs. 7-9.

    Columns are the force's x, y, z in root axes; unit m at a revolute joint, 1 at a prismatic one.
    """
    pushed: Array = np.einsum("nsjk,nsk->snj", motion.partial, force_vectors(motion, link, point))
    return -pushed[..., :3]


def moment_sensitivity(chain: DHChain, motion: ChainMotion, link: int) -> Array:
    """Return dtau/dh (S, n, 3) of a moment on ``link``, from the fourth term of eq. 1; root axes, no unit."""
    axes = joint_axes(chain, motion).swapaxes(0, 1)
    axes[:, link + 1 :] = 0.0
    return -axes
