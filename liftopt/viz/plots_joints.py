"""Angles and torques of joints over the lift: Figs. 13, 14, 16 and 18 of the paper, and those of the other joints."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from liftopt.multibody.joint_curves import JointCurve, human_curves, robot_curves
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.types import Array
from liftopt.viz.plots_data import Lift
from liftopt.viz.plots_style import FAINT, INK, LIMIT, LINES, VERMILION, Line, draw, panels, percent, time_axes
from liftopt.viz.who import robot_of

Quantity = Literal["angle", "torque"]
QUANTITIES: tuple[Quantity, Quantity] = ("angle", "torque")
LONGEST = 44  # characters of a panel's title
NEAR = 0.6  # a limit is drawn to scale where the curve uses this much of it
ARM = ("Q5", "Q7")  # shoulder and elbow flexion, the joints of Figs. 13 and 14


def human_arm(lift: Lift, agent: AgentTrajectory) -> Figure:
    """Return shoulder and elbow flexion: angle and torque (the predicted side of Figs. 13 and 14), of each arm."""
    curves = [curve for curve in human_curves(agent) if curve.joint.rpartition("_")[2] in ARM]
    figure, grid = panels(len(curves), 2, height=1.7)
    for curve, (left, right) in zip(curves, grid, strict=True):
        _panel(left, lift, curve, "angle", LINES[0])
        _panel(right, lift, curve, "torque", LINES[1])
        for axes, quantity in zip((left, right), QUANTITIES, strict=True):
            axes.set_title(f"{curve.label}: {quantity}")
            axes.set_ylabel(f"{_named(curve, quantity)}, flexion +")
    time_axes(grid, float(lift.dense.time[-1]))
    return figure


def human_angles(lift: Lift, agent: AgentTrajectory) -> Figure:
    """Return all joint angles of the person with their ranges of motion."""
    return _grid(lift, _side_by_side(human_curves(agent)), "angle")


def human_torques(lift: Lift, agent: AgentTrajectory) -> Figure:
    """Return all joint torques of the person with their strength."""
    return _grid(lift, _side_by_side(human_curves(agent)), "torque")


def robot_angles(lift: Lift, agent: AgentTrajectory) -> Figure:
    """Return all joint angles of the robot with their limits (the predicted side of Fig. 16)."""
    return _grid(lift, _robot(lift, agent), "angle")


def robot_torques(lift: Lift, agent: AgentTrajectory) -> Figure:
    """Return all joint torques of the robot with their limits (the predicted side of Figs. 17 and 18)."""
    return _grid(lift, _robot(lift, agent), "torque")


def _side_by_side(curves: Sequence[JointCurve]) -> list[JointCurve]:
    """Return joints so that a whole body has its legs beside its trunk, and its right arm beside the left one."""
    parts: dict[str, list[JointCurve]] = {}
    for curve in curves:
        parts.setdefault(curve.part, []).append(curve)
    if len(parts) == 1:
        return list(curves)
    columns = [[*parts["legs"], *parts["right arm"]], [*parts["trunk"], *parts["left arm"]]]
    return [curve for pair in zip(*columns, strict=True) for curve in pair]


def _robot(lift: Lift, agent: AgentTrajectory) -> tuple[JointCurve, ...]:
    return robot_curves(agent, robot_of(lift.dense.scenario, agent).model)


def _grid(lift: Lift, curves: Sequence[JointCurve], quantity: Quantity) -> Figure:
    """Return one small panel a joint, two beside each other."""
    columns = 2
    rows = -(-len(curves) // columns)
    figure, grid = panels(rows, columns, height=1.1)
    for index, curve in enumerate(curves):
        axes = grid[index // columns][index % columns]
        _panel(axes, lift, curve, quantity, LINES[0] if quantity == "angle" else LINES[1])
        axes.set_title(short(curve.label))
        axes.set_ylabel(_named(curve, quantity))
    if len(curves) % columns:
        _explain(grid[-1].pop())
        grid[-2][-1].tick_params(labelbottom=True)
    time_axes(grid, float(lift.dense.time[-1]))
    return figure


def short(label: str) -> str:
    """Return a label that is no longer than its panel is wide, its middle left out if need be."""
    if len(label) <= LONGEST:
        return label
    kept = LONGEST - 1
    return f"{label[: kept // 2]}\N{HORIZONTAL ELLIPSIS}{label[len(label) - (kept - kept // 2) :]}"


def _explain(axes: Axes) -> None:
    """Use a panel left over for the key."""
    axes.axis("off")
    axes.plot([], [], color=INK, marker="o", markerfacecolor="white", label="predicted; a mark at every other knot")
    axes.plot([], [], color=VERMILION, linestyle=(0, (6, 2)), linewidth=1.0, label="limit, and what lies beyond it")
    axes.plot([], [], color=VERMILION, linewidth=4.0, alpha=0.6, label="at the limit")
    axes.legend(loc="center left", fontsize=7.5)


def _panel(axes: Axes, lift: Lift, curve: JointCurve, quantity: Quantity, line: Line) -> None:
    values = curve.q if quantity == "angle" else curve.tau
    limits = curve.q_limits if quantity == "angle" else curve.tau_limits
    draw(axes, lift.dense.time, values, line, knots=lift.factor)
    _scale(axes, values, limits, quantity)
    _mark_limits(axes, lift.dense.time, values, limits)
    used = f", {100 * curve.share.max():.0f} % used" if quantity == "torque" else ""
    axes.annotate(
        f"limits {_signed(limits[0])} to {_signed(limits[1])} {_unit(curve, quantity)}{used}",
        (1.0, 0.03), xycoords="axes fraction", ha="right", va="bottom", fontsize=6.8, color=LIMIT,
        bbox={"boxstyle": "round,pad=0.15", "facecolor": "white", "edgecolor": "none", "alpha": 0.8},
    )  # fmt: skip


def _unit(curve: JointCurve, quantity: Quantity) -> str:
    return curve.units.shown if quantity == "angle" else curve.units.tau


def _named(curve: JointCurve, quantity: Quantity) -> str:
    """Return what is shown, ``"angle [deg]"``; of a joint that slides ``"position [mm]"``."""
    return f"{curve.units.position if quantity == 'angle' else curve.units.effort} [{_unit(curve, quantity)}]"


def _scale(axes: Axes, values: Array, limits: tuple[float, float], quantity: Quantity) -> None:
    """Fit the axis to the curve; take in a limit that the curve comes near."""
    low, high = float(values.min()), float(values.max())
    span = max(high - low, 10.0 if quantity == "angle" else 0.05 * (limits[1] - limits[0]))
    if quantity == "angle":
        near = 0.2 * (limits[1] - limits[0])
        bottom = limits[0] if low - limits[0] < near else low
        top = limits[1] if limits[1] - high < near else high
    else:
        low, high = min(low, 0.0), max(high, 0.0)
        bottom = limits[0] if low < NEAR * limits[0] else low
        top = limits[1] if high > NEAR * limits[1] else high
        axes.axhline(0.0, color=FAINT, linewidth=0.8, zorder=1)
    middle, half = (bottom + top) / 2, max(top - bottom, span) / 2
    axes.set_ylim(middle - 1.35 * half, middle + 1.15 * half)


def _mark_limits(axes: Axes, time: Array, values: Array, limits: tuple[float, float]) -> None:
    bottom, top = axes.get_ylim()
    for limit, beyond in ((limits[0], bottom), (limits[1], top)):
        if bottom < limit < top:
            axes.axhline(limit, color=VERMILION, linewidth=1.0, linestyle=(0, (6, 2)), zorder=1.5)
            axes.axhspan(limit, beyond, facecolor="white", edgecolor=FAINT, hatch="////", linewidth=0, zorder=1)
        at = np.abs(values - limit) <= 1e-3 * (limits[1] - limits[0])
        axes.plot(percent(time), np.where(at, limit, np.nan), color=VERMILION, linewidth=5.0, alpha=0.6)
    axes.set_ylim(bottom, top)


def _signed(value: float) -> str:
    return f"{value + 0.0:.3g}".replace("-", "\N{MINUS SIGN}")  # no negative zero
