"""What happens at one knot, as symbolic functions: joint torques and grasp points of an agent, balance of the object.

Every function is parametric in masses, centres of mass, inertias and placements, so that one compiled kernel serves
every subject, tool and object of a topology. The equations come from Pinocchio's RNEA and its derivatives on CasADi
symbols (``pinocchio.casadi``); only the Hessian of a weighted sum of the outputs comes from CasADi's own derivatives.

Motion enters by the phase s = t / T: ``v = q' / T`` and ``a = q'' / T**2``, so that T is a parameter too.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from liftopt.types import Array

# Entries of a model that are smaller than this are structural zeros (rounding of angles in a URDF).
STRUCTURAL_ZERO = 1e-12


@dataclass(frozen=True)
class Topology:
    """A model as the kernels see it: structure (what a kernel is generated from) and values (its parameters).

    Attributes:
        model: Pinocchio model of the agent (its moving joints) or object (a free-flyer).
        frames: names of the grasp frames.
        entries: (m,) all masses, centres of mass, inertias and translations, in one fixed order.
    """

    model: pin.Model
    frames: tuple[str, ...]
    entries: Array

    @staticmethod
    def of(model: pin.Model, frames: tuple[str, ...]) -> Topology:
        """Read the topology and the parameter values out of a Pinocchio model."""
        values: list[float] = []
        for j in range(1, model.njoints):
            body = model.inertias[j]
            values += [*model.jointPlacements[j].translation, body.mass, *body.lever]
            values += [body.inertia[r, c] for r in range(3) for c in range(r + 1)]
        for name in frames:
            values += [*model.frames[model.getFrameId(name)].placement.translation]
        entries = np.array(values)
        entries[np.abs(entries) < STRUCTURAL_ZERO] = 0.0
        return Topology(model, frames, entries)

    @property
    def parameters(self) -> Array:
        """Values (p,) of the entries that are not structurally zero: what a kernel takes."""
        values: Array = self.entries[self.entries != 0.0]
        return values

    def signature(self) -> str:
        """Return a digest of all that a kernel is generated from; equal signatures share a kernel."""
        digest = hashlib.sha256()
        digest.update((self.entries != 0.0).tobytes())
        digest.update(np.asarray(self.model.gravity.linear).round(12).tobytes())
        for j in range(1, self.model.njoints):
            joint = self.model.joints[j]
            digest.update(f"{joint.shortname()} {self.model.parents[j]};".encode())
            if joint.shortname().endswith("Unaligned"):
                digest.update(np.asarray(joint.extract().axis, dtype=float).tobytes())
            digest.update((clean_rotation(self.model.jointPlacements[j].rotation) + 0.0).tobytes())
        for name in self.frames:
            digest.update(f"{self.model.frames[self.model.getFrameId(name)].parentJoint};".encode())
        digest.update(np.asarray(self.model.armature, dtype=float).tobytes())
        return digest.hexdigest()


@dataclass(frozen=True)
class KnotFunctions:
    """CasADi functions of one agent or object at one knot: knot variables y, parameters p, outputs c.

    y is q, q', q'' (n each) and the forces of the grasps concerned; p is T and then ``Topology.parameters``.

    Attributes:
        value: (y, p) -> c.
        gradient: (y, p, m) -> (dc/dy)^T m.
        jacobian: (y, p) -> dc/dy.
        curvature: (y, p, m) -> upper triangle of ``sum_i m_i c_i''``.
        squares: (dc/dy, d) -> upper triangle of ``sum_j d_j c_j' c_j'^T`` over the leading outputs, those that may
            enter an objective squared; a function of its own, since one with both takes the compiler twice as long.
    """

    value: Any
    gradient: Any
    jacobian: Any
    curvature: Any
    squares: Any


def clean_rotation(rotation: Array) -> Array:
    """Return a rotation (3, 3) whose entries within 1e-12 of 0 and +-1 are exactly that, so that zeros stay zeros."""
    nearest = np.round(rotation)
    return np.where(np.abs(rotation - nearest) < STRUCTURAL_ZERO, nearest, rotation)


@dataclass(frozen=True)
class HeldArm:
    """An agent at one knot on symbols, by Pinocchio.

    Attributes:
        motion: (3 n,) q, q', q''.
        p: T and then the model's parameters.
        tau_free: (n,) torques that the motion takes without a load, and ``tau_by_motion`` (n, 3 n) their slopes.
        jacobian_grasp: (6, n) of the grasp frame, world axes.
        placement: of the grasp frame in the world.
    """

    motion: Any
    p: Any
    tau_free: Any
    tau_by_motion: Any
    jacobian_grasp: Any
    placement: Any

    @staticmethod
    def of(topology: Topology) -> HeldArm:
        """Return the agent of a topology."""
        import casadi as ca

        cpin, model, p = symbolic_model(topology)
        n = model.nv
        period = ca.SX.sym("T")
        q, dq, ddq = (ca.SX.sym(name, n) for name in ("q", "dq", "ddq"))
        v, a = dq / period, ddq / period**2
        frame = model.getFrameId(topology.frames[0])

        dtau_dq, dtau_dv, mass_matrix = cpin.computeRNEADerivatives(model, model.createData(), q, v, a)
        jacobian = cpin.computeFrameJacobian(model, model.createData(), q, frame, cpin.LOCAL_WORLD_ALIGNED)
        data = model.createData()
        cpin.forwardKinematics(model, data, q)
        cpin.updateFramePlacements(model, data)
        return HeldArm(
            motion=ca.vertcat(q, dq, ddq),
            p=ca.vertcat(period, p),
            tau_free=cpin.rnea(model, model.createData(), q, v, a),
            tau_by_motion=ca.horzcat(dtau_dq, dtau_dv / period, mass_matrix / period**2),
            jacobian_grasp=jacobian,
            placement=data.oMf[frame],
        )

    def loaded(self, load: Any) -> tuple[Any, Any]:
        """Return torques (n,) under joint loads (n,) that depend on q, and their slopes (n, 3 n) by the motion."""
        import casadi as ca

        n = load.shape[0]
        by_motion = ca.horzcat(ca.jacobian(load, self.motion[:n]), ca.SX(n, 2 * n))
        return self.tau_free + load, self.tau_by_motion + by_motion


@dataclass(frozen=True)
class FreeFlyer:
    """The object at one knot on symbols, by Pinocchio.

    Attributes:
        motion: (18,) x, x', x''; x is the centre of mass, then roll, pitch, yaw.
        p: T and then the model's parameters.
        model: with symbolic entries.
        q: (7,) configuration.
        rotation: (3, 3) from body to world.
        generalized: (6,) force and moment that the motion takes, body axes.
    """

    motion: Any
    p: Any
    model: Any
    q: Any
    rotation: Any
    generalized: Any

    @staticmethod
    def of(topology: Topology) -> FreeFlyer:
        """Return the object of a topology."""
        import casadi as ca

        cpin, model, p = symbolic_model(topology)
        period = ca.SX.sym("T")
        x, dx, ddx = (ca.SX.sym(name, 6) for name in ("x", "dx", "ddx"))
        rotation, spin = roll_pitch_yaw(ca, x[3:])
        q = ca.vertcat(x[:3], quaternion(ca, x[3:]))
        v = ca.vertcat(ca.mtimes(rotation.T, dx[:3]), ca.mtimes(spin, dx[3:])) / period
        a = ca.jtimes(v, ca.vertcat(x, dx), ca.vertcat(dx, ddx)) / period
        generalized = cpin.rnea(model, model.createData(), q, v, a)
        return FreeFlyer(ca.vertcat(x, dx, ddx), ca.vertcat(period, p), model, q, rotation, generalized)


def agent_functions(topology: Topology) -> KnotFunctions:
    """Return the functions of an agent: y = (q, q', q'', f), c = (tau, p_world_grasp, f . f).

    ``tau = RNEA(q, v, a) - (-J^T f)``: f (3,) is the force the agent exerts on the object, world axes, so its
    reaction loads the arm at the grasp frame (third term of eq. 1). n torques [Nm], then 3 coordinates [m], then the
    squared force [N^2].
    """
    import casadi as ca

    arm = HeldArm.of(topology)
    n, f = arm.tau_free.shape[0], ca.SX.sym("f", 3)
    jacobian_grasp = arm.jacobian_grasp[:3, :]
    tau, by_motion = arm.loaded(ca.mtimes(jacobian_grasp.T, f))
    c = ca.vertcat(tau, arm.placement.translation, ca.dot(f, f))
    jacobian = ca.vertcat(
        ca.horzcat(by_motion, jacobian_grasp.T),
        ca.horzcat(jacobian_grasp, ca.SX(3, 2 * n + 3)),
        ca.horzcat(ca.SX(1, 3 * n), 2 * f.T),
    )
    return knot_functions(ca.vertcat(arm.motion, f), arm.p, c, jacobian, squared=n)


def object_functions(topology: Topology) -> KnotFunctions:
    """Return the functions of the object: y = (x, x', x'', f_1 .. f_m), c = (balance, p_world_grasp_1 .. m).

    x = centre of mass (world X, Y, Z), then roll, pitch, yaw with ``R = Rx Ry Rz``, Table 4's order. The balance
    (6,) is RNEA of the free-flyer less the grasp forces (eq. 6): force along world axes [N], moment about the
    body's axes [Nm]. Grasp points (3 m,) in the world [m].
    """
    import casadi as ca

    import liftopt.pinocchio_casadi as cpin

    body = FreeFlyer.of(topology)
    forces = ca.SX.sym("f", 3 * len(topology.frames))
    generalized, points = body.generalized, []
    for name, force in zip(topology.frames, ca.vertsplit(forces, 3), strict=True):
        frame = body.model.getFrameId(name)
        data = body.model.createData()
        cpin.forwardKinematics(body.model, data, body.q)
        cpin.updateFramePlacements(body.model, data)
        points.append(data.oMf[frame].translation)
        lever = body.model.frames[frame].placement.translation
        f_body = ca.mtimes(body.rotation.T, force)
        generalized -= ca.vertcat(f_body, ca.cross(lever, f_body))
    c = ca.vertcat(ca.mtimes(body.rotation, generalized[:3]), generalized[3:], *points)
    y = ca.vertcat(body.motion, forces)
    return knot_functions(y, body.p, c, ca.jacobian(c, y), squared=0)


def knot_functions(y: Any, p: Any, c: Any, jacobian: Any, squared: int) -> KnotFunctions:
    """Return the functions of outputs c (y, p) with their Jacobian; the first ``squared`` outputs may be squared."""
    import casadi as ca

    m, d = ca.SX.sym("m", c.shape[0]), ca.SX.sym("d", squared)
    # Differentiating the scalar m . c twice takes a quarter of the instructions of differentiating J^T m.
    curvature, gradient = ca.hessian(ca.dot(m, c), y)
    slopes = ca.SX.sym("slopes", jacobian.sparsity())
    leading = slopes[:squared, :]
    squares = ca.mtimes(leading.T, ca.repmat(d, 1, y.shape[0]) * leading)
    return KnotFunctions(
        value=ca.Function("value", [y, p], ca.cse([c])),
        gradient=ca.Function("gradient", [y, p, m], ca.cse([gradient])),
        jacobian=ca.Function("jacobian", [y, p], ca.cse([jacobian])),
        curvature=ca.Function("curvature", [y, p, m], ca.cse([ca.triu(curvature)])),
        squares=ca.Function("squares", [slopes, d], [ca.triu(squares)]),
    )


def symbolic_model(topology: Topology) -> tuple[Any, Any, Any]:
    """Return (pinocchio.casadi module, its model with symbolic entries, the symbols p)."""
    import casadi as ca

    import liftopt.pinocchio_casadi as cpin

    symbols = ca.SX.sym("p", len(topology.parameters))
    entries = ca.SX(len(topology.entries), 1)
    for k, i in enumerate(np.flatnonzero(topology.entries)):
        entries[int(i)] = symbols[k]
    model = cpin.Model(topology.model)
    at = 0
    for j in range(1, topology.model.njoints):
        translation, mass, lever, lower = entries[at : at + 3], entries[at + 3], entries[at + 4 : at + 7], at + 7
        inertia = ca.SX(3, 3)
        for k, (row, col) in enumerate((r, c) for r in range(3) for c in range(r + 1)):
            inertia[row, col] = inertia[col, row] = entries[lower + k]
        rotation = ca.SX(ca.sparsify(ca.DM(clean_rotation(topology.model.jointPlacements[j].rotation))))
        model.jointPlacements[j] = cpin.SE3(rotation, translation)
        model.inertias[j] = cpin.Inertia(mass, lever, inertia)
        at += 13
    for name in topology.frames:
        frame = topology.model.getFrameId(name)
        rotation = ca.SX(ca.sparsify(ca.DM(clean_rotation(topology.model.frames[frame].placement.rotation))))
        model.frames[frame].placement = cpin.SE3(rotation, entries[at : at + 3])
        at += 3
    return cpin, model, symbols


def roll_pitch_yaw(ca: Any, angles: Any) -> tuple[Any, Any]:
    """Return R = Rx Ry Rz (3, 3) and the map (3, 3) from the angles' rates to the angular velocity, body axes."""
    (cr, cp, cy), (sr, sp, sy) = (
        (function(angles[0]), function(angles[1]), function(angles[2])) for function in (ca.cos, ca.sin)
    )
    rx = ca.vertcat(ca.horzcat(1, 0, 0), ca.horzcat(0, cr, -sr), ca.horzcat(0, sr, cr))
    ry = ca.vertcat(ca.horzcat(cp, 0, sp), ca.horzcat(0, 1, 0), ca.horzcat(-sp, 0, cp))
    rz = ca.vertcat(ca.horzcat(cy, -sy, 0), ca.horzcat(sy, cy, 0), ca.horzcat(0, 0, 1))
    after_roll = ca.mtimes(ry, rz)
    spin = ca.horzcat(after_roll.T[:, 0], rz.T[:, 1], ca.vertcat(0, 0, 1))
    return ca.mtimes(rx, after_roll), spin


def quaternion(ca: Any, angles: Any) -> Any:
    """Return the quaternion (x, y, z, w) of Rx Ry Rz."""
    half = angles / 2
    (cr, cp, cy), (sr, sp, sy) = ((f(half[0]), f(half[1]), f(half[2])) for f in (ca.cos, ca.sin))
    return ca.vertcat(
        sr * cp * cy + cr * sp * sy,
        cr * sp * cy - sr * cp * sy,
        cr * cp * sy + sr * sp * cy,
        cr * cp * cy - sr * sp * sy,
    )
