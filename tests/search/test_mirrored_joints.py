"""Mirrored joints: Pinocchio tells whether what a mirrored arm carries is held as before."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from liftopt.collocation.problem import Problem
from liftopt.search.initial_guess import naive_guess
from liftopt.search.mirrored_joints import in_line, mirrored_joints


def test_mirrored_arm_holds_its_last_link_as_before(small_lift: Problem) -> None:
    """Pinocchio: Sawyer's last link has the same orientation, and at most three joints differ."""
    robot, layout = small_lift.team.agents[1], small_lift.layout
    x, columns = naive_guess(small_lift).x, layout.control[:, layout.columns(1)]
    q = np.array([0.3, -0.8, 0.4, 1.0, -0.5, 0.9, 0.2])
    x[columns] = q
    found = [start for start in mirrored_joints(small_lift, x) if start.name.startswith("robot")]
    assert len(found) >= 3
    model = robot.reduced()
    data = model.createData()

    def orientation(q: np.ndarray) -> np.ndarray:
        pin.forwardKinematics(model, data, q)
        return np.array(data.oMi[model.njoints - 1].rotation)

    for start in found:
        other = start.x[columns][0]
        inside = (other > robot.limits.q_lower) & (other < robot.limits.q_upper)
        if inside.all():
            np.testing.assert_allclose(orientation(other), orientation(q), atol=1e-9)
        changed = ~np.isclose(np.cos(other - q), 1.0)
        assert 2 <= changed.sum() <= 3
        assert np.delete(start.x, columns.ravel()) == pytest.approx(np.delete(x, columns.ravel()))
    assert any(((s.x[columns] > robot.limits.q_lower) & (s.x[columns] < robot.limits.q_upper)).all() for s in found)


def test_only_joints_between_axes_that_can_be_parallel_are_mirrored(small_lift: Problem) -> None:
    """Closed form: of hinges about z, x, z, z the second is in line at 0, the third has a neighbour along itself."""
    model, parent = pin.Model(), 0
    for n, kind in enumerate((pin.JointModelRZ, pin.JointModelRX, pin.JointModelRZ, pin.JointModelRZ)):
        parent = model.addJoint(parent, kind(), pin.SE3.Identity(), str(n))
    arm: Any = SimpleNamespace(reduced=lambda: model, posture=np.zeros(4))
    np.testing.assert_allclose(in_line(arm), [np.nan, 0.0, np.nan, np.nan], atol=1e-12)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("liftopt.search.mirrored_joints.in_line", lambda agent: np.full(len(agent.posture), np.nan))
        assert list(mirrored_joints(small_lift, naive_guess(small_lift).x)) == []
