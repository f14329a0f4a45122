"""Where the links of an agent that stands are: the functions of ``pose_kernels``, the place of its base a parameter."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pinocchio as pin

from liftopt.collocation import spatial_symbols, standing_place
from liftopt.collocation.dynamics import KnotFunctions, knot_functions, symbolic_model
from liftopt.collocation.pose_kernels import PoseTopology
from liftopt.collocation.spatial_symbols import Placed
from liftopt.collocation.standing_place import PLACE_SIZE, base_of, in_base_axes, place_parameters
from liftopt.types import Array


@dataclass(frozen=True)
class StandingPoseTopology(PoseTopology):
    """A model as these kernels see it, in the axes of its base.

    Attributes:
        T_world_base: (4, 4) placement of the base, upright.
    """

    T_world_base: Array = field(default_factory=lambda: np.eye(4))

    @staticmethod
    def standing(model: pin.Model, joints: tuple[int, ...], T_world_base: Array) -> StandingPoseTopology:
        """Read the topology out of a Pinocchio model, which is in the world."""
        found = PoseTopology.moving(in_base_axes(model, T_world_base), joints)
        return StandingPoseTopology(found.model, found.frames, found.entries, joints, T_world_base)

    @property
    def parameters(self) -> Array:
        """Values (p,) of the entries that are not structurally zero, then of the place."""
        return np.concatenate([self.entries[self.entries != 0.0], place_parameters(self.T_world_base)])

    def signature(self) -> str:
        """Return a digest of all that a kernel is generated from; equal signatures share a kernel."""
        digest = hashlib.sha256(PoseTopology.signature(self).encode())
        for source in (__file__, spatial_symbols.__file__, standing_place.__file__):
            digest.update(Path(source).read_bytes())
        return digest.hexdigest()


def standing_pose_functions(topology: StandingPoseTopology) -> KnotFunctions:
    """Return the functions of an agent's links: y = q, c = (p_world_joint, R_world_joint by columns) of each joint."""
    import casadi as ca

    cpin, model, p = symbolic_model(topology)
    q, data, base = ca.SX.sym("q", model.nv), model.createData(), base_of(p[-PLACE_SIZE:])
    cpin.forwardKinematics(model, data, q)
    poses = [base * Placed(data.oMi[joint].rotation, data.oMi[joint].translation) for joint in topology.joints]
    c = ca.densify(ca.vertcat(*(ca.vertcat(pose.origin, ca.vec(pose.rotation)) for pose in poses)))
    return knot_functions(q, ca.vertcat(ca.SX.sym("T"), p), c, ca.jacobian(c, q), squared=0)
