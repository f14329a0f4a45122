"""Plots: every curve against the solution it shows, signs against anatomy, files against their formats."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.figure import Figure

from liftopt.errors import InputError
from liftopt.multibody.joint_curves import ANATOMY, human_curves, robot_curves
from liftopt.multibody.person.range_of_motion import RANGES
from liftopt.solution.grasp_loads import shares
from liftopt.viz import FORMATS
from liftopt.viz.plots import drawn, plots_of, rendered, write_plots
from liftopt.viz.plots_data import Lift
from liftopt.viz.plots_style import LINES

BEGINS = {"svg": b"<?xml", "png": b"\x89PNG", "pdf": b"%PDF"}


@pytest.fixture(scope="module")
def lift(solved: Callable[..., Any]) -> Lift:
    return Lift.of(solved("table5", "solver.intervals=10", "solver.starts=1").solution)


@pytest.fixture(scope="module")
def figures(lift: Lift) -> dict[str, Figure]:
    return {plot.name: drawn(plot, lift) for plot in plots_of(lift)}


def _panel(figure: Figure, title: str) -> Any:
    (axes,) = (axes for axes in figure.axes if axes.get_title(loc="left").startswith(title))
    return axes


def test_anatomical_signs_are_those_of_the_ranges_of_motion() -> None:
    for joint, item in zip(ANATOMY, RANGES, strict=True):
        positive = item.positive if joint.sign > 0 else item.negative
        assert joint.joint == item.joint
        last = positive.split()[-1]  # "elbow flexion", "bend to the right", "pronation"
        assert last in joint.motion


def test_arm_is_drawn_with_flexion_positive(figures: dict[str, Figure], lift: Lift) -> None:
    human = lift.dense.agents[0]
    for title, joint, sign in (("Shoulder flexion", "human_Q5", 1), ("Elbow flexion", "human_Q7", -1)):
        column = human.joint_names.index(joint)
        for quantity, values in (("angle", np.degrees(human.q)), ("torque", human.tau)):
            (axes,) = (
                a for a in figures["human_arm"].axes if a.get_title(loc="left") == _titled(title, joint, sign, quantity)
            )
            x, y = axes.lines[0].get_data()
            np.testing.assert_allclose(x, 100 * lift.dense.time / lift.dense.time[-1], atol=1e-12)
            np.testing.assert_allclose(y, sign * values[:, column], atol=1e-12)


def test_clearance_is_drawn_as_it_was_measured(figures: dict[str, Figure], lift: Lift) -> None:
    clearance = lift.dense.clearance
    assert clearance is not None
    between = clearance.of_kind("person-robot")
    assert between is not None
    figure = figures["clearance"]
    for title, expected in (
        ("Person and robot: smallest distance", 1e3 * between.distance),
        ("Person and robot: relative speed", between.speed),
    ):
        np.testing.assert_allclose(_panel(figure, title).lines[0].get_ydata(), expected, atol=1e-12)
    drawn_kinds = {line.get_label(): line.get_ydata() for line in _panel(figure, "Smallest distance").lines}
    np.testing.assert_allclose(drawn_kinds["person-robot"], 1e3 * between.distance, atol=1e-12)
    assert "within person" in drawn_kinds


def _titled(title: str, joint: str, sign: int, quantity: str) -> str:
    minus = "" if sign > 0 else "\N{MINUS SIGN}"
    return f"{title} ({minus}{joint.removeprefix('human_')}): {quantity}"


def test_signs_keep_power_and_limits_keep_their_side(lift: Lift) -> None:
    """Turning a sign must turn angle and torque together: their product, work, stays the model's."""
    for agent, curves in ((0, human_curves(lift.dense.agents[0])), (1, robot_curves(lift.dense.agents[1], "sawyer"))):
        solved = lift.dense.agents[agent]
        for curve in curves:
            column = solved.joint_names.index(f"{solved.name}_{curve.joint}")
            np.testing.assert_allclose(curve.q * curve.tau, np.degrees(solved.q * solved.tau)[:, column], atol=1e-9)
            assert (curve.q >= curve.q_limits[0] - 1e-3).all()
            assert (curve.q <= curve.q_limits[1] + 1e-3).all()
            limit = np.where(curve.tau >= 0, curve.tau_limits[1], curve.tau_limits[0])
            np.testing.assert_allclose(curve.share, curve.tau / limit, atol=1e-12)
    assert human_curves(lift.dense.agents[0])[6].q_limits == pytest.approx((0.0, 150.0))
    assert robot_curves(lift.dense.agents[1], "sawyer")[3].label == "Q4 (\N{MINUS SIGN}right_j3)"


def test_forces_and_shares(figures: dict[str, Figure], lift: Lift) -> None:
    figure = figures["grasp_forces"]
    for agent, title in zip(lift.dense.agents, ("Force of the person", "Force of the robot"), strict=True):
        for i in range(3):
            np.testing.assert_allclose(_panel(figure, title).lines[i].get_ydata(), agent.load[:, i], atol=1e-12)
    part = shares(lift.dense.agents)
    np.testing.assert_allclose(part.sum(axis=0), 1.0, atol=1e-12)
    np.testing.assert_allclose(_panel(figure, "Load share").lines[0].get_ydata(), 100 * part[0], atol=1e-9)


@pytest.mark.parametrize("name", ["robot_angles", "robot_torques"])
def test_all_robot_joints_are_drawn_with_their_limits(figures: dict[str, Figure], lift: Lift, name: str) -> None:
    figure, limits = figures[name], lift.dense.agents[1].limits
    low, high = (
        (np.degrees(limits.q_lower), np.degrees(limits.q_upper))
        if name == "robot_angles"
        else (limits.tau_lower, limits.tau_upper)
    )
    for i in range(7):
        words = " ".join(text.get_text() for text in _panel(figure, f"Q{i + 1} ").texts).replace("\N{MINUS SIGN}", "-")
        assert f"limits {low[i] + 0.0:.3g} to {high[i]:.3g}" in words


def test_both_times_are_shown(figures: dict[str, Figure], lift: Lift) -> None:
    axes = _panel(figures["object_motion"], "Height")
    (seconds,) = axes.child_axes
    assert (seconds.get_xlabel(), axes.get_xlim()) == ("time [s]", (0.0, 100.0))
    seconds.get_figure().draw_without_rendering()
    assert seconds.get_xlim() == pytest.approx((0.0, lift.dense.time[-1]))


def test_series_differ_without_colour() -> None:
    assert len({str(line.linestyle) for line in LINES}) == len({line.marker for line in LINES}) == len(LINES)
    greys = sorted(_luminance(line.color) for line in LINES)
    assert np.diff(greys).min() > 0.01


def _luminance(color: str) -> float:
    red, green, blue = (int(color[i : i + 2], 16) / 255 for i in (1, 3, 5))
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def test_snapshots_put_the_hands_where_forward_kinematics_does(figures: dict[str, Figure], lift: Lift) -> None:
    """One map without perspective takes all paths of all panels there: x to the right, z up, y hardly seen."""
    agents = lift.dense.agents
    points = np.vstack([agent.p_world_hold for agent in agents])
    for axes, moment in zip(figures["snapshots"].axes, (0.0, 0.25, 0.5, 0.75, 1.0), strict=True):
        k = round(moment * (len(lift.dense.time) - 1))
        drawn_at = np.vstack([axes.lines[2 * i].get_xydata() for i in range(len(agents))])
        affine, *_ = np.linalg.lstsq(np.column_stack([points, np.ones(len(points))]), drawn_at, rcond=None)
        np.testing.assert_allclose(points @ affine[:3] + affine[3], drawn_at, atol=1e-6)
        assert affine[0, 0] == pytest.approx(-affine[2, 1], rel=0.01)
        assert affine[0, 0] > 100.0  # pixels a metre
        assert abs(affine[2, 0]) < 1e-6
        arrows = [patch for patch in axes.patches if hasattr(patch, "get_arrowstyle")]
        for i, (arrow, agent) in enumerate(zip(arrows, agents, strict=True)):
            start, tip = arrow._posA_posB
            np.testing.assert_allclose(start, agent.p_world_hold[k] @ affine[:3] + affine[3], atol=1e-6)
            along, force = np.subtract(tip, start), agent.load[k] @ affine[:3]
            assert along[0] * force[1] == pytest.approx(along[1] * force[0], abs=1e-6)
            assert along @ force > 0
            np.testing.assert_allclose(axes.lines[2 * i + 1].get_xydata()[-1], start, atol=1e-9)  # the path so far


@pytest.mark.parametrize("kind", FORMATS)
def test_formats(figures: dict[str, Figure], kind: str) -> None:
    image = rendered(figures["strength_used"], kind)
    assert image.startswith(BEGINS[kind])
    assert rendered(figures["strength_used"], kind) == image  # nothing in it depends on the clock


def test_every_plot_is_a_picture(figures: dict[str, Figure]) -> None:
    for name, figure in figures.items():
        root = ElementTree.parse(io.BytesIO(rendered(figure, "svg"))).getroot()
        assert len(list(root.iter("{http://www.w3.org/2000/svg}path"))) > 10, name


def test_writing_to_a_place_that_is_taken(solved: Callable[..., Any], tmp_path: Path) -> None:
    taken = tmp_path / "file"
    taken.write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        write_plots(solved("table5", "solver.intervals=10", "solver.starts=1").solution, taken, ("svg",))
