"""Where bodies are at one knot: the poses of an agent's links, or of the object, as functions of its coordinates.

What must stay apart is fixed on such bodies. So a row that keeps two of them on both sides of a plane is a linear
combination of these outputs, and one kernel serves every shape on them.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pinocchio as pin

from liftopt.collocation.dynamics import KnotFunctions, Topology, knot_functions, roll_pitch_yaw, symbolic_model

POSE_SIZE = 12  # position, then the columns of the rotation
# Numbers of each joint in ``Topology.entries``: a placement's translation, mass, centre of mass, inertia.
TRANSLATION, JOINT = 3, 13


@dataclass(frozen=True)
class PoseTopology(Topology):
    """A model as these kernels see it; its parameters are the translations between its joints.

    Attributes:
        joints: whose poses are the outputs, in that order.
    """

    joints: tuple[int, ...] = ()

    @staticmethod
    def moving(model: pin.Model, joints: tuple[int, ...]) -> PoseTopology:
        """Read the topology out of a Pinocchio model."""
        entries = Topology.of(model, ()).entries.reshape(-1, JOINT).copy()
        entries[:, TRANSLATION:] = 0.0  # no pose depends on them
        return PoseTopology(model, (), entries.ravel(), joints)

    def signature(self) -> str:
        """Return a digest of all that a kernel is generated from; equal signatures share a kernel."""
        digest = hashlib.sha256(Topology.signature(self).encode())
        digest.update(repr(self.joints).encode())
        digest.update(Path(__file__).read_bytes())
        return digest.hexdigest()


def pose_functions(topology: PoseTopology) -> KnotFunctions:
    """Return the functions of an agent's links: y = q, c = (p_world_joint, R_world_joint by columns) of each joint."""
    import casadi as ca

    cpin, model, p = symbolic_model(topology)
    q, data = ca.SX.sym("q", model.nv), model.createData()
    cpin.forwardKinematics(model, data, q)
    poses = [data.oMi[joint] for joint in topology.joints]
    c = ca.vertcat(*(ca.vertcat(pose.translation, ca.vec(pose.rotation)) for pose in poses))
    return knot_functions(q, ca.vertcat(ca.SX.sym("T"), p), ca.densify(c), ca.jacobian(c, q), squared=0)


def object_pose_functions(topology: Topology) -> KnotFunctions:
    """Return the functions of the object: y = (x, y, z, roll, pitch, yaw), c = (p_world_object, R by columns)."""
    import casadi as ca

    x = ca.SX.sym("x", 6)
    rotation, _ = roll_pitch_yaw(ca, x[3:])
    c = ca.densify(ca.vertcat(x[:3], ca.vec(rotation)))
    p = ca.vertcat(ca.SX.sym("T"), ca.SX.sym("p", len(topology.parameters)))
    return knot_functions(x, p, c, ca.jacobian(c, x), squared=0)


def parameter_free(model: pin.Model) -> PoseTopology:
    """Return the topology of a free body, whose pose depends on no number of the model."""
    return PoseTopology(model, (), np.zeros(len(Topology.of(model, ()).entries)), (1,))
