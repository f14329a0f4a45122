"""Placements, motions, forces and inertias. Oracle: Pinocchio's own in double precision, 1e-12."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

import liftopt.pinocchio_casadi as cpin

PLACEMENT = pin.exp6(np.array([0.3, -0.2, 0.5, 0.7, 0.1, -0.4]))
OTHER = pin.exp6(np.array([-0.1, 0.4, 0.2, -0.3, 0.6, 0.9]))
MOTION = pin.Motion(np.array([1.0, -2.0, 0.5]), np.array([0.3, 0.2, -0.7]))
FORCE = pin.Force(np.array([4.0, 1.0, -3.0]), np.array([-0.5, 2.0, 0.6]))
INERTIA = pin.Inertia(2.5, np.array([0.1, -0.3, 0.2]), np.diag([0.4, 0.5, 0.6]) + 0.05)
POINT = np.array([0.4, 0.5, -0.6])


def _array(x: Any) -> np.ndarray:
    for attribute in ("vector", "homogeneous"):
        x = getattr(x, attribute, x)
    if isinstance(x, (cpin.Inertia, pin.Inertia)):
        x = x.matrix()
    return np.atleast_2d(np.array(ca.DM(x) if isinstance(x, ca.SX) else x, dtype=float)).reshape(-1, order="F")


def _lift(x: Any) -> Any:
    """Return the symbolic counterpart of a Pinocchio object, by upstream's constructor from one."""
    return getattr(cpin, type(x).__name__)(x) if type(x).__module__.startswith("pinocchio") else ca.SX(x)


@pytest.mark.parametrize(
    ("operation", "operands"),
    [
        (lambda A, B: A * B, (PLACEMENT, OTHER)),
        (lambda A, B: A.act(B), (PLACEMENT, OTHER)),
        (lambda A, B: A.actInv(B), (PLACEMENT, OTHER)),
        (lambda A: A.inverse(), (PLACEMENT,)),
        (lambda A: ~A, (PLACEMENT,)),
        (lambda A: A.action, (PLACEMENT,)),
        (lambda A: A.actionInverse, (PLACEMENT,)),
        (lambda A: A.dualAction, (PLACEMENT,)),
        (lambda A, p: A.act(p), (PLACEMENT, POINT)),
        (lambda A, p: A.actInv(p), (PLACEMENT, POINT)),
        (lambda A, p: A * p, (PLACEMENT, POINT)),
        (lambda A, v: A.act(v), (PLACEMENT, MOTION)),
        (lambda A, v: A.actInv(v), (PLACEMENT, MOTION)),
        (lambda A, f: A.act(f), (PLACEMENT, FORCE)),
        (lambda A, f: A.actInv(f), (PLACEMENT, FORCE)),
        (lambda A, f: A * f, (PLACEMENT, FORCE)),
        (lambda A, Y: Y.se3Action(A), (PLACEMENT, INERTIA)),
        (lambda A, Y: Y.se3ActionInverse(A), (PLACEMENT, INERTIA)),
        (lambda A, v: v.se3Action(A), (PLACEMENT, MOTION)),
        (lambda A, f: f.se3ActionInverse(A), (PLACEMENT, FORCE)),
        (lambda v, f: v.dot(f), (MOTION, FORCE)),
        (lambda v, f: v.cross(f), (MOTION, FORCE)),
        (lambda v: v + v - (-v), (MOTION,)),
        (lambda f: f * 3.0, (FORCE,)),
        (lambda Y, v: Y * v, (INERTIA, MOTION)),
        (lambda Y: Y + Y.copy(), (INERTIA,)),
        (lambda Y: Y.toDynamicParameters(), (INERTIA,)),
        (lambda Y: type(Y).FromDynamicParameters(Y.toDynamicParameters()), (INERTIA,)),
    ],
)
def test_operation(operation: Any, operands: tuple[Any, ...]) -> None:
    found, expected = operation(*map(_lift, operands)), operation(*operands)
    assert np.max(np.abs(_array(found) - _array(expected))) < 1e-12


def test_types_of_attributes_are_those_of_upstream() -> None:
    M, v, Y = cpin.SE3(PLACEMENT), cpin.Motion(MOTION), cpin.Inertia(INERTIA)
    shapes = {
        (3, 3): (M.rotation, Y.inertia),
        (3, 1): (M.translation, v.linear, v.angular, Y.lever),
        (4, 4): (M.homogeneous, M.np),
        (6, 1): (v.vector,),
        (6, 6): (Y.matrix(), M.action),
        (1, 1): (Y.mass,),
    }
    for shape, values in shapes.items():
        assert all(isinstance(value, ca.SX) and value.shape == shape for value in values)


def test_parts_are_assigned() -> None:
    x, M, v, Y = ca.SX.sym("x", 3), cpin.SE3.Identity(), cpin.Motion.Zero(), cpin.Inertia.Zero()
    M.translation, v.angular, Y.lever, Y.mass = x, x, x, x[0]
    for part in (M.translation, v.angular, Y.lever, ca.vertcat(Y.mass, x[1:])):
        assert ca.is_equal(part, x)
    assert ca.is_equal(ca.SX(cpin.SE3(M.homogeneous).translation), x)


def test_an_inertia_is_read_from_its_lower_triangle() -> None:
    six = ca.SX.sym("I", 3, 3)
    assert ca.is_equal(cpin.Inertia(1, [0, 0, 0], six).inertia[0, 1], six[1, 0])


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: cpin.SE3(np.eye(2), [0, 0, 0]), "rotation: expected 3 x 3, got 2 x 2"),
        (lambda: cpin.SE3(np.eye(3), [0, 0]), "translation: expected 3 entries, got 2 x 1"),
        (lambda: cpin.Inertia([1, 2], [0, 0, 0], np.eye(3)), "mass: expected one number, got 2 x 1"),
        (lambda: cpin.Inertia(1, np.eye(3), np.eye(3)), "lever: expected 3 entries, got 3 x 3"),
        (lambda: cpin.Force([1, 2, 3]), "array: expected 6 entries, got 3 x 1"),
        (lambda: cpin.Motion.Zero().__setattr__("linear", [1]), "linear: expected 3 entries, got 1 x 1"),
    ],
)
def test_wrong_sizes_are_named(make: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make()


def test_a_force_list_is_built_as_upstream_builds_it() -> None:
    forces = cpin.StdVec_Force(3, cpin.Force.Zero())
    forces[1].linear = [1, 2, 3]
    assert len(forces) == 3
    assert float(forces[2].linear[0]) == 0.0
    assert float(cpin.StdVec_Force(forces)[1].linear[2]) == 3.0
    assert len(cpin.StdVec_Force()) == 0
