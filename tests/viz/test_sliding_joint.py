"""Figures and tables of a joint that slides. Oracle: its own trajectory in m, m/s and N."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from liftopt.multibody.joint_curves import robot_curves
from liftopt.solution.interpolation import between_knots
from liftopt.viz.plots_data import Lift
from liftopt.viz.plots_joints import robot_angles, robot_torques
from liftopt.viz.report_tables import joint_rows


def test_it_is_shown_in_millimetres_and_newtons(on_a_column: Any) -> None:
    fine = between_knots(on_a_column.solution)
    column, *others = robot_curves(fine["robot"], "")
    np.testing.assert_allclose(column.q, 1e3 * fine["robot"].q[:, 0])
    np.testing.assert_allclose(column.v, 1e3 * fine["robot"].v[:, 0])
    assert column.q_limits == pytest.approx((0.0, 500.0)) and column.v_limit == pytest.approx(400.0)
    assert column.tau_limits == pytest.approx((-900.0, 900.0))
    assert {curve.units.shown for curve in others} == {"deg"}
    first, second, *_ = joint_rows((column, *others), fine)
    assert first["q"].endswith(" mm") and first["q_limits"] == "0 to 500 mm"
    assert " N at " in first["tau"] and first["tau_limits"].endswith("900 N")
    assert not second["q"].endswith("m")
    lift = Lift.of(on_a_column.solution)
    for figure, labels in (
        (robot_angles, ("position [mm]", "angle [deg]")),
        (robot_torques, ("force [N]", "torque [Nm]")),
    ):
        axes = figure(lift, lift.dense["robot"]).axes
        assert (axes[0].get_ylabel(), axes[1].get_ylabel()) == labels
