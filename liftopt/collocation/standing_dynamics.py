"""What happens at one knot of an agent that is a tree with several hands, and may stand on its soles.

The functions of ``dynamics`` again. A hand that holds nothing has no unknowns: its knot variables stay zero, so that
one kernel serves every choice of hands. Where the agent stands, which way it faces and how each hand lies on the object
are parameters.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pinocchio as pin

from liftopt.collocation import (
    closed_form,
    spatial_symbols,
    standing_hand,
    standing_knot,
    standing_place,
    tree_dynamics,
)
from liftopt.collocation.closed_form import closed_form_functions
from liftopt.collocation.dynamics import KnotFunctions, Topology, clean_rotation, symbolic_model
from liftopt.collocation.standing_knot import StandingKnot
from liftopt.collocation.standing_place import in_base_axes, place_parameters
from liftopt.collocation.wrench_dynamics import WrenchTopology
from liftopt.types import Array


@dataclass(frozen=True)
class StandingTopology(WrenchTopology):
    """A tree as its kernels see it; its model is in the axes of its base, and ``turns`` are parameters.

    Attributes:
        T_world_base: (4, 4) placement of the base, upright.
        trunk: joint whose link's lean is an output, 0 for none.
    """

    T_world_base: Array = field(default_factory=lambda: np.eye(4))
    trunk: int = 0

    @staticmethod
    def standing(
        model: pin.Model, frames: tuple[str, ...], T_world_base: Array, *grips: Array, trunk: str = ""
    ) -> StandingTopology:
        """Read the topology out of a Pinocchio model.

        Args:
            model: in the world.
            frames: of all hands, whether they hold or not.
            T_world_base: (4, 4) placement of the base, Z up.
            grips: (3, 3) ``Grasp.R_hand_object`` of each hand.
            trunk: name of the joint whose link's lean is an output, or none.
        """
        local = in_base_axes(model, T_world_base)
        found = WrenchTopology.holding(local, frames, *grips)
        carried = int(model.getJointId(trunk)) if trunk else 0
        return StandingTopology(local, frames, found.entries, found.turns, T_world_base, carried)

    @property
    def up(self) -> Array:
        """Direction (3,) in the trunk's link that is up where all joints are at zero."""
        data = self.model.createData()
        pin.forwardKinematics(self.model, data, pin.neutral(self.model))
        return np.asarray(clean_rotation(data.oMi[self.trunk].rotation)[2] + 0.0)

    @property
    def parameters(self) -> Array:
        """Values (p,): of the model's entries that are not structurally zero, of the place and of the grips."""
        place = place_parameters(self.T_world_base)
        return np.concatenate([self.entries[self.entries != 0.0], place, *(turn.ravel() for turn in self.turns)])

    def signature(self) -> str:
        """Return a digest of all that a kernel is generated from; equal signatures share a kernel."""
        digest = hashlib.sha256(Topology.signature(self).encode())
        digest.update(f"{self.trunk} {self.up.tolist()}".encode())
        for part in (closed_form, spatial_symbols, standing_hand, standing_knot, standing_place, tree_dynamics):
            digest.update(Path(str(part.__file__)).read_bytes())
        digest.update(Path(__file__).read_bytes())
        return digest.hexdigest()


def standing_agent_functions(topology: StandingTopology) -> KnotFunctions:
    """Return the functions of an agent: y = (q, q', q'', f_1, m_1 .. f_h, m_h, roll, pitch, yaw).

    The outputs are torques (n,), where a trunk is named 1 - cos of its angle from the vertical, of each hand
    (p_world_grasp, f . f, m . m, cosine, f_object, m_object), all as in ``wrench_dynamics``, and force and moment (6,)
    that the ground exerts on all that moves, the grasps' reactions included: about the base's origin, in its axes.
    """
    cpin, model, entries = symbolic_model(topology)
    up = topology.up if topology.trunk else None
    knot = StandingKnot(cpin, model, topology.model, topology.frames, entries, topology.trunk, up)
    return closed_form_functions(knot)
