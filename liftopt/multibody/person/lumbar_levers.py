"""Lever arms of the muscles that hold the lumbar spine, and how much moment its limit on compression allows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from liftopt.multibody.sources import Source
from liftopt.types import Array

# Lever arms about the disc [m]: extensors behind it, abdominal muscles ahead of it, those of the flank beside it.
EXTENSOR, LONG_EXTENSOR, FLEXOR, FLANK = 0.05, 0.075, 0.08, 0.12
LEVER_SOURCE = Source(
    "extensors: the 5 cm that such models commonly take (Guengoer 2013, Auburn University), 7.5 cm at most (McGill & "
    "Norman 1987, J Biomech 20:591-600); abdominal muscles and flanks: about what Jorgensen, Marras, Granata & Wiand "
    "(2001), Clin Biomech 16:182-193 measured by MRI",
    "unverified",
)
COMPRESSION_LIMIT, COMPRESSION_MOST = 3400.0, 6400.0  # [N]
COMPRESSION_SOURCE = Source(
    "NIOSH (1981), Work Practices Guide for Manual Lifting, DHHS 81-122: action limit 3400 N, maximum permissible "
    "limit 6400 N; 3400 N kept by Waters, Putz-Anderson, Garg & Fine (1993), Ergonomics 36:749-776",
    "secondary",
)
BEND, FLEXION = "Q1", "Q2"  # joints at the base of the spine: to the right and forward positive


def spine_shares(joints: Sequence[str]) -> Array:
    """Return what one Nm of torque adds to the load on the spine, (2, n) below and above zero [1/Nm].

    A torque that holds the trunk up, or bends it aside, counts as one where the muscle that bears it presses the spine
    with the action limit.

    Args:
        joints: names of the n joints without the person's.
    """
    shares, names = np.zeros((2, len(joints))), list(joints)
    shares[0, names.index(FLEXION)] = 1.0 / (COMPRESSION_LIMIT * EXTENSOR)
    shares[:, names.index(BEND)] = 1.0 / (COMPRESSION_LIMIT * FLANK)
    return shares
