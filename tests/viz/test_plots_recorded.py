"""Predicted over recorded angles: geometry of Pinocchio's joints, and the table against what it was rounded from."""

from __future__ import annotations

import csv
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from liftopt.ergonomics.motion import motion_of
from liftopt.ergonomics.recorded_lifts import HEIGHTS, LIFTS, RECORDED, SMALLEST
from liftopt.scenario.build import agents_of
from liftopt.viz.plots import drawn, plots_of
from liftopt.viz.plots_data import Lift
from liftopt.viz.plots_recorded import TITLES, compared_angles

CURVES = Path(__file__).parents[3] / "shared" / "data" / "recorded_lifts" / "ammr_by_height.csv"
CALLED = {
    "elbow": ("elbow_flex_3d", 1),
    "humeral_elevation": ("shoulder_elev_3d", 1),
    "wrist_extension": ("wrist_flex", -1),
    "twist": ("twist", 1),
}


@pytest.fixture(scope="module")
def lift(solved: Callable[..., Any]) -> Lift:
    return Lift.of(solved("table5", "solver.intervals=10", "solver.starts=1").solution)


@pytest.mark.skipif(not CURVES.exists(), reason="the recorded curves are not part of the repository")
def test_the_table_is_that_of_the_recorded_curves() -> None:
    """Mean, sample deviation and number of lifts at each height, to the degree they are rounded to."""
    header, *rows = list(csv.reader(CURVES.read_text(encoding="utf-8").splitlines()))
    np.testing.assert_allclose([float(name.removesuffix("m")) for name in header[2:]], HEIGHTS)
    for name, (called, sign) in CALLED.items():
        values = sign * np.array([[float(value) for value in row[2:]] for row in rows if row[1] == called])
        np.testing.assert_allclose(np.nanmean(values, axis=0), RECORDED[name].mean, atol=0.51)
        np.testing.assert_allclose(np.nanstd(values, axis=0, ddof=1), RECORDED[name].deviation, atol=0.51)
        assert tuple(np.isfinite(values).sum(axis=0).tolist()) == LIFTS


def test_a_band_is_around_its_mean_and_never_narrower_than_it_can_be_measured() -> None:
    for angle in RECORDED.values():
        low, high = angle.band()
        np.testing.assert_allclose((low + high) / 2, angle.mean)
        assert (high - low).min() >= 2 * SMALLEST
        assert np.all((high - low) / 2 >= angle.deviation)


def test_angles_are_those_between_pinocchios_joints(lift: Lift) -> None:
    solution = lift.dense
    (person,) = (agent for agent in agents_of(solution.scenario) if agent.kind == "person")
    model = person.model
    data, names = model.createData(), list(model.names)
    shoulder, elbow, wrist, trunk = (names.index(f"human_{row}") for row in ("Q5", "Q7", "Q9", "Q3"))
    pin.forwardKinematics(model, data, pin.neutral(model))
    hanging = data.oMi[trunk].rotation.T @ [0.0, 0.0, -1.0]
    found = compared_angles(motion_of(solution, solution["human"]))
    for k in range(0, len(solution.time), 17):
        pin.forwardKinematics(model, data, solution["human"].q[k])
        at = [data.oMi[joint].translation for joint in (shoulder, elbow, wrist)]
        upper, lower = at[1] - at[0], at[2] - at[1]
        assert found["elbow"][k] == pytest.approx(_angle(upper, lower), abs=0.5)
        assert found["humeral_elevation"][k] == pytest.approx(
            _angle(upper, data.oMi[trunk].rotation @ hanging), abs=1e-3
        )
    q = np.degrees(solution["human"].q)
    np.testing.assert_allclose(found["wrist_extension"], q[:, names.index("human_Q9") - 1], atol=1e-9)
    np.testing.assert_allclose(found["twist"], q[:, names.index("human_Q3") - 1], atol=1e-9)


def _angle(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.degrees(np.arccos(a @ b / np.linalg.norm(a) / np.linalg.norm(b))))


def test_the_plot_shows_them_over_the_band_by_the_wrists_height(lift: Lift) -> None:
    (plot,) = (plot for plot in plots_of(lift) if plot.name == "recorded_angles")
    figure = drawn(plot, lift)
    person = lift.dense["human"]
    angles = compared_angles(motion_of(lift.dense, person))
    for name, title in TITLES.items():
        (axes,) = (axes for axes in figure.axes if axes.get_title(loc="left") == title)
        recorded, predicted = axes.lines[0], axes.lines[1]
        np.testing.assert_array_equal(recorded.get_ydata(), RECORDED[name].mean)
        np.testing.assert_array_equal(predicted.get_ydata(), angles[name])
        # The wrist is a hand's length or less from the grasp point, above or below.
        assert np.abs(predicted.get_xdata() - person.p_world_hold[:, 2]).max() < 0.1
    legend = figure.axes[0].get_legend().get_texts()
    assert "recorded: one person, a trend" in [text.get_text() for text in legend]
