"""What happens at one knot of a serial arm: the functions of ``wrench_dynamics`` for all arms at once.

Where the arm stands, its lengths and angles, its masses, its tool and how it holds are parameters, so that one kernel
serves every arm with the same kinds of joints in the same order. A hold without moments has no unknowns for them.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pinocchio as pin

from liftopt.collocation import (
    arm_chain,
    arm_frames,
    arm_knot,
    arm_numbers,
    closed_form,
    spatial_symbols,
    standing_hand,
    tree_dynamics,
)
from liftopt.collocation.arm_frames import ArmFrames
from liftopt.collocation.arm_knot import ArmKnot
from liftopt.collocation.arm_numbers import numbers_of, placement_numbers
from liftopt.collocation.closed_form import closed_form_functions
from liftopt.collocation.dynamics import KnotFunctions, Topology
from liftopt.types import Array

PARTS = (arm_chain, arm_frames, arm_knot, arm_numbers, closed_form, spatial_symbols, standing_hand, tree_dynamics)


@dataclass(frozen=True)
class ArmTopology(Topology):
    """A serial arm as its kernels see it; its entries are their parameters, whichever of them are zero.

    Attributes:
        kinds: of its joints from the base on, R for one that turns and P for one that slides.
    """

    kinds: str = ""

    @staticmethod
    def holding(model: pin.Model, frame: str, grip: Array) -> ArmTopology:
        """Read the topology out of a Pinocchio model.

        Args:
            model: of the arm.
            frame: name of the grasp frame, which the last link carries.
            grip: (3, 3) ``Grasp.R_hand_object``.

        Raises:
            ModelError: it is no serial arm, or a joint neither turns about nor slides along its z axis.
        """
        frames = ArmFrames.of(model)
        hand = frames.own[-1].inverse() * model.frames[model.getFrameId(frame)].placement
        held = placement_numbers(hand.rotation @ grip, hand.translation)
        return ArmTopology(model, (frame,), np.array([*numbers_of(frames), *held]), frames.kinds)

    @property
    def parameters(self) -> Array:
        """Values (p,) that a kernel takes."""
        return self.entries

    def signature(self) -> str:
        """Return a digest of all that a kernel is generated from; equal signatures share a kernel."""
        return signature_of(self.kinds, self.model, __file__, *(str(part.__file__) for part in PARTS))


def signature_of(structure: str, model: pin.Model, *sources: str) -> str:
    """Return a digest of a structure in words, of gravity and of what makes the functions."""
    digest = hashlib.sha256(structure.encode())
    digest.update(np.asarray(model.gravity.linear).round(12).tobytes())
    for source in sources:
        digest.update(Path(source).read_bytes())
    return digest.hexdigest()


def arm_functions(topology: ArmTopology) -> KnotFunctions:
    """Return the functions of an arm, knot variables and outputs as of ``wrench_dynamics.wrench_agent_functions``."""
    import casadi as ca

    gravity = ca.SX(ca.sparsify(ca.DM(np.asarray(topology.model.gravity.linear))))
    return closed_form_functions(ArmKnot(topology.kinds, len(topology.entries), gravity))
