"""Fig. 2: the ground reaction read off a chain's global joints, in two passes of inverse dynamics.

Pass 1 leaves the ground out: the global joints then carry what the ground has to give. Pass 2 applies that as an
external force and moment at the foot, and the global joints carry nothing. The chain has global translations only;
the moment is read off three massless revolute rows put before them, whose axes are z, x, y of the root frame.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import pi

import numpy as np

from liftopt.crosscheck.kinematics import chain_motion
from liftopt.crosscheck.lagrangian import ExternalLoad, homogeneous, torque_terms
from liftopt.multibody.dh import BodyInertia, DHChain, DHRow, frame_transforms
from liftopt.types import Array

ROTATIONS = 3
TRANSLATIONS = 3


@dataclass(frozen=True)
class GroundReaction:
    """What the ground does to the chain, for S states, in the axes of the chain's root frame.

    Attributes:
        foot: (S, 3) the point foot, moved by the global translations [m].
        force: (S, 3) on the chain at the foot [N].
        moment: (S, 3) on the chain about the foot [Nm].
        tau: (S, n) torques of the second pass, ground reaction applied [Nm].
        residual: (S, 6) what the global joints (three rotations, three translations) still carry then; zero but for
            rounding.
    """

    foot: Array
    force: Array
    moment: Array
    tau: Array
    residual: Array


def with_root_rotations(chain: DHChain) -> DHChain:
    """Return the chain behind three massless revolute rows at its root; at zero they leave its frames where they are.

    Each row is Rz(pi/2) Rx(pi/2), a cyclic permutation of the axes, and three of them make the identity.
    """
    rows = tuple(DHRow(f"GR{i + 1}", "revolute", pi / 2, 0.0, 0.0, pi / 2) for i in range(ROTATIONS))
    return replace(chain, rows=rows + chain.rows, inertias=(BodyInertia.zero(),) * ROTATIONS + chain.inertias)


def foot_point(chain: DHChain) -> Array:
    """Return the point foot (3,) in the third row's frame [m]: the root's origin with the global joints at zero."""
    grounded = frame_transforms(chain, np.zeros(len(chain.rows)))[TRANSLATIONS - 1]
    point: Array = np.asarray(np.linalg.inv(grounded)[:3, 3])
    return point


def ground_reaction(
    chain: DHChain, q: Array, v: Array, a: Array, gravity: Array, loads: Sequence[ExternalLoad] = ()
) -> GroundReaction:
    """Run both passes of Fig. 2.

    Args:
        chain: its first three rows are the global translations GT1-GT3.
        q: (S, n) joint positions [rad or m].
        v: (S, n) joint velocities.
        a: (S, n) joint accelerations.
        gravity: (3,) root axes [m/s^2].
        loads: what acts on the chain besides the ground, links counted in ``chain``.

    Returns:
        The ground reaction at the foot and the torques with it applied.

    Raises:
        ValueError: the chain does not begin with three prismatic rows, or a body before the third has mass, which
            the third joint would not carry.
    """
    if [row.kind for row in chain.rows[:TRANSLATIONS]] != ["prismatic"] * TRANSLATIONS:
        raise ValueError(f"{chain.name}: its first {TRANSLATIONS} rows must be the prismatic global translations")
    if any(body.mass > 0.0 for body in chain.inertias[: TRANSLATIONS - 1]):
        raise ValueError(f"{chain.name}: bodies before the last global translation must be massless")
    rooted = with_root_rotations(chain)
    motion = chain_motion(rooted, *(np.pad(x, ((0, 0), (ROTATIONS, 0))) for x in (q, v, a)))
    held = [replace(load, link=load.link + ROTATIONS) for load in loads]

    first = torque_terms(rooted, motion, gravity, held).tau
    # The axes of the six global joints are orthonormal at zero rotation, so a vector is the sum of its components.
    axes = motion.placement[: ROTATIONS + TRANSLATIONS, :, :3, 2]
    moment_root = np.einsum("si,isj->sj", first[:, :ROTATIONS], axes[:ROTATIONS])
    force = np.einsum("si,isj->sj", first[:, ROTATIONS : ROTATIONS + TRANSLATIONS], axes[ROTATIONS:])
    leg, point = ROTATIONS + TRANSLATIONS - 1, foot_point(chain)
    foot = (motion.link_placement(leg) @ homogeneous(point, 1.0))[:, :3]
    moment = moment_root - np.cross(foot, force)

    second = torque_terms(rooted, motion, gravity, [*held, ExternalLoad(leg, point, force, moment)]).tau
    return GroundReaction(foot, force, moment, second[:, ROTATIONS:], second[:, : ROTATIONS + TRANSLATIONS])
