"""Oracles that several tests of the models share."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest


def _textbook_dh(theta: float, d: float, a: float, alpha: float) -> np.ndarray:
    """Return the Denavit-Hartenberg matrix (4, 4) as printed in textbooks, written out entry by entry."""
    ct, st, ca, sa = np.cos(theta), np.sin(theta), np.cos(alpha), np.sin(alpha)
    return np.array([[ct, -st * ca, st * sa, a * ct], [st, ct * ca, -ct * sa, a * st], [0, sa, ca, d], [0, 0, 0, 1]])


def _textbook_end(rows, q) -> np.ndarray:
    end = np.eye(4)
    for row, value in zip(rows, q, strict=True):
        turn, slide = (value, 0.0) if row.kind == "revolute" else (0.0, value)
        end = end @ _textbook_dh(row.theta + turn, row.d + slide, row.a, row.alpha)
    return end


def _frame_pose(model: pin.Model, name: str, q) -> np.ndarray:
    data = model.createData()
    pin.framesForwardKinematics(model, data, np.asarray(q, dtype=float))
    return data.oMf[model.getFrameId(name)].homogeneous


def _assert_bodies_are_physical(model: pin.Model) -> None:
    for name, body in zip(list(model.names)[1:], list(model.inertias)[1:], strict=True):
        if body.mass == 0.0:
            assert not np.any(body.inertia), name
            continue
        moments = np.linalg.eigvalsh(body.inertia)
        assert moments[0] > 0.0, (name, moments)
        assert moments[0] + moments[1] >= moments[2], (name, moments)


@pytest.fixture
def textbook_end():
    """Return a function: last frame (4, 4) of DH rows at q, in the chain's root frame."""
    return _textbook_end


@pytest.fixture
def frame_pose():
    """Return a function: T_world_frame (4, 4) of a named frame of a Pinocchio model at q."""
    return _frame_pose


@pytest.fixture
def assert_bodies_are_physical():
    """Return a check: every body with mass has positive principal moments that obey the triangle inequality."""
    return _assert_bodies_are_physical
