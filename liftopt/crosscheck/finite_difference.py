"""Central differences of eq. 1 in the external load, with a bound on their own error.

Eq. 1 is linear in force and moment, so a central difference has no truncation error and its step may be large; what
is left is rounding, which is bounded entry by entry here.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np

from liftopt.crosscheck.kinematics import ChainMotion
from liftopt.crosscheck.lagrangian import ExternalLoad, torque_terms
from liftopt.multibody.dh import DHChain
from liftopt.types import Array

STEP = 64.0  # N or Nm; a power of two, so that dividing by it does not round
# Roundings of each end, none of a number larger than ``size`` below: the shift of the load, three products and their
# two sums, three sums of eq. 1's terms, and the difference of the ends.
ROUNDINGS = 10


def load_differences(
    chain: DHChain, motion: ChainMotion, gravity: Array, load: ExternalLoad, by: Literal["force", "moment"]
) -> tuple[Array, Array]:
    """Return central differences (S, n, 3) of tau by the components of ``load`` and a bound (S, n, 3) on their error.

    Args:
        chain: n rows.
        motion: of that chain, S states.
        gravity: (3,) root axes [m/s^2].
        load: about which to differ, the only one on the chain.
        by: which vector of the load is varied.
    """
    base: Array = getattr(load, by)
    differences, sizes = np.empty((2, motion.samples, len(chain.rows), 3))
    for axis in range(3):
        shift = STEP * np.eye(3)[axis]
        varied = [base + sign * shift for sign in (1.0, -1.0)]
        loads = [replace(load, force=v) if by == "force" else replace(load, moment=v) for v in varied]
        ends = [torque_terms(chain, motion, gravity, [each]) for each in loads]
        differences[..., axis] = (ends[0].tau - ends[1].tau) / (2.0 * STEP)
        sizes[..., axis] = np.max(
            [abs(e.inertia) + abs(e.gravity) + abs(e.force) + abs(e.moment) for e in ends], axis=0
        )
    # The products f_j dtau/df_j may be larger than their sum, which is what the force term holds.
    sizes += np.abs(differences) @ (np.abs(base) + STEP)[..., None]
    unit_roundoff = np.finfo(np.float64).eps / 2.0
    return differences, 2 * ROUNDINGS * unit_roundoff * sizes / (2.0 * STEP)
