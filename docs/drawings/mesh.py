"""What the unknowns look like over time, and how well the answer holds between the knots."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from drawings.stage import default_lift
from liftopt.viz.plots_data import Lift
from liftopt.viz.plots_style import BLUE, GREEN, INK, LIMIT, VERMILION


def mesh() -> Figure:
    """Return elbow angle and acceleration with their knots, a grasp force, and the closure of both grasps."""
    lift = Lift.of(default_lift())
    knots, dense = lift.knots, lift.dense
    person, joint = knots["human"], knots["human"].joint_names.index("human_Q7")
    figure = Figure(figsize=(7.6, 6.4))
    angle, acceleration, force, closure = figure.subplots(4, 1, sharex=True)
    figure.subplots_adjust(left=0.1, right=0.985, top=0.96, bottom=0.07, hspace=0.42)
    angle.plot(dense.time, np.degrees(dense["human"].q[:, joint]), color=BLUE)
    angle.plot(knots.time, np.degrees(person.q[:, joint]), "o", color=BLUE, markersize=3.5, markerfacecolor="white")
    angle.set_title("joint angle: a cubic B-spline (here the elbow, Q7 [deg])")
    acceleration.plot(dense.time, dense["human"].a[:, joint], color=GREEN)
    acceleration.plot(knots.time, person.a[:, joint], "o", color=GREEN, markersize=3.5, markerfacecolor="white")
    acceleration.set_title("its acceleration: linear between knots [rad/s\N{SUPERSCRIPT TWO}]")
    force.plot(dense.time, dense["human"].load[:, 2], color=VERMILION)
    force.plot(knots.time, person.load[:, 2], "o", color=VERMILION, markersize=3.5, markerfacecolor="white")
    force.set_title("a grasp force: one unknown a component and knot (the hand's, upwards [N])")
    for trajectory, column, color in zip(dense.agents, range(2), (BLUE, VERMILION), strict=True):
        gap = np.linalg.norm(trajectory.p_world_hold - dense.object.grasp_position[:, column], axis=1)
        closure.semilogy(dense.time, np.maximum(1e3 * gap, 1e-12), color=color, linewidth=1.2, label=trajectory.name)
    closure.axhline(1.0, color=LIMIT, linewidth=0.9, linestyle="--")
    closure.text(0.01, 1.3, "allowed between knots", fontsize=7.5, color=LIMIT)
    closure.set(ylim=(1e-9, 30), xlabel="time [s]", xlim=(0.0, knots.time[-1]))
    closure.legend(loc="lower right", ncols=2)
    closure.set_title("distance of hand and tool from their points on the object [mm]: zero at the knots")
    for axes in (angle, acceleration, force, closure):
        axes.set_xticks(knots.time, minor=True)
        axes.tick_params(axis="x", which="minor", length=3, color=INK)
    return figure
