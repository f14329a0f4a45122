"""What happens at one knot where a hold transmits more than a force at a point: the functions of ``dynamics`` again.

The object's attitude is among an agent's knot variables here, so that the angle between hand and object is one exact
output, and the wrench along the object's axes, in which friction is told, are three and three. A hold without moments
has no unknowns for them: its knot variables stay zero, so that one kernel serves every mix of holds.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from liftopt.collocation.dynamics import (
    KnotFunctions,
    Topology,
    clean_rotation,
    knot_functions,
    quaternion,
    roll_pitch_yaw,
    symbolic_model,
)

Array = npt.NDArray[np.float64]
WRENCH_SIZE = 6


@dataclass(frozen=True)
class WrenchTopology(Topology):
    """A model as these kernels see it.

    Attributes:
        turns: of an agent's grasp frames, (3, 3) each: the grip axes in the joint that carries it; none for an object.
    """

    turns: tuple[Array, ...] = ()

    @staticmethod
    def holding(model: pin.Model, frames: tuple[str, ...], *grips: Array) -> WrenchTopology:
        """Read the topology out of a Pinocchio model; ``grips`` are ``Grasp.R_hand_object``."""
        base, turns = Topology.of(model, frames), []
        for name, grip in zip(frames, grips, strict=False):
            turns.append(clean_rotation(model.frames[model.getFrameId(name)].placement.rotation @ grip) + 0.0)
        return WrenchTopology(base.model, base.frames, base.entries, tuple(turns))

    def signature(self) -> str:
        """Return a digest of all that a kernel is generated from; equal signatures share a kernel."""
        digest = hashlib.sha256(Topology.signature(self).encode())
        for turn in self.turns:
            digest.update(turn.tobytes())
        digest.update(Path(__file__).read_bytes())
        return digest.hexdigest()


def wrench_agent_functions(topology: WrenchTopology) -> KnotFunctions:
    """Return the functions of an agent: y = (q, q', q'', f, m, roll, pitch, yaw).

    The outputs are (tau, p_world_grasp, f . f, m . m, cosine, f_object, m_object): ``tau = RNEA(q, v, a) + J^T (f, m)``
    with the force f and the moment m about the grasp point that the agent exerts on the object, world axes (third term
    of eq. 1); the cosine of the angle from the grip axes to those of the object, whose attitude is
    ``Rx(roll) Ry(pitch) Rz(yaw)``; force and moment along the object's axes. Leading outputs are as those of
    ``dynamics.agent_functions``.
    """
    import casadi as ca

    cpin, model, p = symbolic_model(topology)
    n = model.nv
    period = ca.SX.sym("T")
    q, dq, ddq, f, m, angles = (
        ca.SX.sym(name, size) for name, size in (("q", n), ("dq", n), ("ddq", n), ("f", 3), ("m", 3), ("r", 3))
    )
    v, a = dq / period, ddq / period**2
    frame = model.getFrameId(topology.frames[0])

    data = model.createData()
    dtau_dq, dtau_dv, mass_matrix = cpin.computeRNEADerivatives(model, data, q, v, a)
    tau_free = cpin.rnea(model, model.createData(), q, v, a)
    data = model.createData()
    jacobian_grasp = cpin.computeFrameJacobian(model, data, q, frame, cpin.LOCAL_WORLD_ALIGNED)
    data = model.createData()
    cpin.forwardKinematics(model, data, q)
    cpin.updateFramePlacements(model, data)
    placement = data.oMf[frame]
    local = clean_rotation(topology.model.frames[frame].placement.rotation).T @ topology.turns[0]
    grip = ca.mtimes(placement.rotation, ca.SX(ca.sparsify(ca.DM(clean_rotation(local)))))
    attitude, _ = roll_pitch_yaw(ca, angles)

    load = ca.mtimes(jacobian_grasp.T, ca.vertcat(f, m))
    cosine = (ca.trace(ca.mtimes(attitude.T, grip)) - 1) / 2
    rest = ca.vertcat(
        placement.translation,
        ca.dot(f, f),
        ca.dot(m, m),
        cosine,
        ca.mtimes(attitude.T, f),
        ca.mtimes(attitude.T, m),
    )
    y = ca.vertcat(q, dq, ddq, f, m, angles)
    by_motion = ca.horzcat(dtau_dq + ca.jacobian(load, q), dtau_dv / period, mass_matrix / period**2)
    jacobian = ca.vertcat(ca.horzcat(by_motion, jacobian_grasp.T, ca.SX(n, 3)), ca.jacobian(rest, y))
    return knot_functions(y, ca.vertcat(period, p), ca.vertcat(tau_free + load, rest), jacobian, squared=n)


def wrench_object_functions(topology: Topology) -> KnotFunctions:
    """Return the functions of the object: y = (x, x', x'', f_1, m_1 .. f_k, m_k).

    Outputs are as those of ``dynamics.object_functions``, the balance less the moments m about the grasp points too.
    """
    import casadi as ca

    cpin, model, p = symbolic_model(topology)
    k = len(topology.frames)
    period = ca.SX.sym("T")
    x, dx, ddx, held = (ca.SX.sym(s, size) for s, size in (("x", 6), ("dx", 6), ("ddx", 6), ("h", WRENCH_SIZE * k)))

    rotation, spin = roll_pitch_yaw(ca, x[3:])
    q = ca.vertcat(x[:3], quaternion(ca, x[3:]))
    v = ca.vertcat(ca.mtimes(rotation.T, dx[:3]), ca.mtimes(spin, dx[3:])) / period
    a = ca.jtimes(v, ca.vertcat(x, dx), ca.vertcat(dx, ddx)) / period

    generalized = cpin.rnea(model, model.createData(), q, v, a)
    points = []
    for name, wrench in zip(topology.frames, ca.vertsplit(held, WRENCH_SIZE), strict=True):
        lever = model.frames[model.getFrameId(name)].placement.translation
        points.append(x[:3] + ca.mtimes(rotation, lever))
        f_body, m_body = ca.mtimes(rotation.T, wrench[:3]), ca.mtimes(rotation.T, wrench[3:])
        generalized -= ca.vertcat(f_body, ca.cross(lever, f_body) + m_body)
    c = ca.vertcat(ca.mtimes(rotation, generalized[:3]), generalized[3:], *points)
    y = ca.vertcat(x, dx, ddx, held)
    return knot_functions(y, ca.vertcat(period, p), c, ca.jacobian(c, y), squared=0)
