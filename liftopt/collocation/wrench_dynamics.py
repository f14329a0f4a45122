"""What happens at one knot where a hold transmits more than a force at a point: the functions of ``dynamics`` again.

The object's attitude is among an agent's knot variables here, so that the angle between hand and object is one exact
output, and the wrench along the object's axes, in which friction is told, are three and three. A hold without moments
has no unknowns for them: its knot variables stay zero, so that one kernel serves every mix of holds.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

import pinocchio as pin

from liftopt.collocation.dynamics import (
    FreeFlyer,
    HeldArm,
    KnotFunctions,
    Topology,
    clean_rotation,
    knot_functions,
    roll_pitch_yaw,
)
from liftopt.types import Array

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

    arm = HeldArm.of(topology)
    n, (f, m, angles) = arm.tau_free.shape[0], (ca.SX.sym(name, 3) for name in ("f", "m", "r"))
    frame = topology.model.getFrameId(topology.frames[0])
    local = clean_rotation(topology.model.frames[frame].placement.rotation).T @ topology.turns[0]
    grip = ca.mtimes(arm.placement.rotation, ca.SX(ca.sparsify(ca.DM(clean_rotation(local)))))
    attitude, _ = roll_pitch_yaw(ca, angles)

    tau, by_motion = arm.loaded(ca.mtimes(arm.jacobian_grasp.T, ca.vertcat(f, m)))
    cosine = (ca.trace(ca.mtimes(attitude.T, grip)) - 1) / 2
    rest = ca.vertcat(
        arm.placement.translation,
        ca.dot(f, f),
        ca.dot(m, m),
        cosine,
        ca.mtimes(attitude.T, f),
        ca.mtimes(attitude.T, m),
    )
    y = ca.vertcat(arm.motion, f, m, angles)
    jacobian = ca.vertcat(ca.horzcat(by_motion, arm.jacobian_grasp.T, ca.SX(n, 3)), ca.jacobian(rest, y))
    return knot_functions(y, arm.p, ca.vertcat(tau, rest), jacobian, squared=n)


def wrench_object_functions(topology: Topology) -> KnotFunctions:
    """Return the functions of the object: y = (x, x', x'', f_1, m_1 .. f_k, m_k).

    Outputs are as those of ``dynamics.object_functions``, the balance less the moments m about the grasp points too.
    """
    import casadi as ca

    body = FreeFlyer.of(topology)
    held = ca.SX.sym("h", WRENCH_SIZE * len(topology.frames))
    generalized, points = body.generalized, []
    for name, wrench in zip(topology.frames, ca.vertsplit(held, WRENCH_SIZE), strict=True):
        lever = body.model.frames[body.model.getFrameId(name)].placement.translation
        points.append(body.motion[:3] + ca.mtimes(body.rotation, lever))
        f_body, m_body = ca.mtimes(body.rotation.T, wrench[:3]), ca.mtimes(body.rotation.T, wrench[3:])
        generalized -= ca.vertcat(f_body, ca.cross(lever, f_body) + m_body)
    c = ca.vertcat(ca.mtimes(body.rotation, generalized[:3]), generalized[3:], *points)
    y = ca.vertcat(body.motion, held)
    return knot_functions(y, body.p, c, ca.jacobian(c, y), squared=0)
