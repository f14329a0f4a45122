"""Where the object is held, by which frames, and what a grasp transmits."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from drawings.stage import agents, arrow, bare, bodies, default_lift, paint_bodies
from liftopt.types import Array
from liftopt.viz.outlines import VIEWS
from liftopt.viz.plots_style import BLUE, GREEN, INK, LIMIT, VERMILION

PER_NEWTON = 0.009  # length of a drawn force [m/N]
AXES = (("x", VERMILION), ("y", GREEN), ("z", BLUE))


def grasp() -> Figure:
    """Return the held object with its frames and forces, and the hands' frames in a wrench grasp."""
    figure = Figure(figsize=(7.6, 5.2))
    forces, hands = figure.subplots(2, 1, height_ratios=[1.9, 1.0])
    figure.subplots_adjust(left=0.01, right=0.99, top=0.95, bottom=0.01, hspace=0.12)
    _forces(forces)
    _hands(hands)
    return figure


def _forces(axes: Axes) -> None:
    """Show the start of the default lift: frames of the object, and the forces of both hands and of gravity."""
    solution, cast = default_lift(), bodies()
    lifted = cast[solution.object.name]
    paint_bodies(axes, [(body, body.q[0]) for body in cast.values() if body is not lifted], "right", alpha=0.25)
    paint_bodies(axes, [(lifted, lifted.q[0])], "right")
    centre = solution.object.pose[0, [0, 2]]
    for agent, color, side in zip(solution.agents, (BLUE, VERMILION), (-1, 1), strict=True):
        point, force = agent.p_world_hold[0, [0, 2]], agent.load[0, [0, 2]]
        arrow(axes, point, point + PER_NEWTON * force, color, linewidth=2.0)
        axes.plot(*point, "o", color=color, markersize=5, zorder=8)
        axes.annotate(
            f"{agent.name}: {np.linalg.norm(agent.load[0]):.0f} N", point + PER_NEWTON * force,
            xytext=(6 * side, 3), textcoords="offset points", ha="left" if side > 0 else "right", fontsize=8,
            color=color, zorder=8,
        )  # fmt: skip
        axes.annotate(
            f"frame grasp_{agent.name} of the object\n"
            f"= frame {agent.name}_grasp of the {'hand' if side < 0 else 'tool'}",
            point, xytext=(30 * side, -36), textcoords="offset points", ha="center", va="top", fontsize=7.5,
            color=color, arrowprops={"arrowstyle": "-", "color": color, "linewidth": 0.6}, zorder=8,
        )  # fmt: skip
    weight = 9.81 * solution.scenario.object.mass
    arrow(axes, centre, centre - [0.0, PER_NEWTON * weight], INK, linewidth=2.0)
    axes.annotate(f"weight {weight:.0f} N", centre - [0.0, PER_NEWTON * weight], xytext=(0, -9),
                  textcoords="offset points", ha="center", fontsize=8, zorder=8)  # fmt: skip
    axes.set_title("A force at each grasp (default lift at t = 0)")
    axes.set(xlim=(-0.02, 1.32), ylim=(0.64, 1.12))
    bare(axes)


def _hands(axes: Axes) -> None:
    """Show the hands' frames in their natural hold of a level object: what a wrench grasp keeps near."""
    solution = default_lift()
    lifted = bodies()[solution.object.name]
    paint_bodies(axes, [(lifted, lifted.q[0])], "right")
    for agent, column in zip(agents(), range(2), strict=True):
        point = solution.object.grasp_position[0, column]
        _triad(axes, point, np.asarray(agent.grasps[0].R_hand_object.T), f"{agent.name}_grasp", column)
    centre = solution.object.pose[0, :3]
    _triad(axes, centre, np.eye(3), solution.object.name, 2)
    axes.text(0.02, 0.805, "Circle with a dot: towards the reader. Circle with a cross: away from the reader.",
              fontsize=7.5, color=LIMIT)  # fmt: skip
    axes.set_title("Wrench grasp: a moment too, and the hand stays near this hold")
    axes.set(xlim=(-0.02, 1.32), ylim=(0.8, 1.03))
    bare(axes)


def _triad(axes: Axes, origin: Array, rotation: Array, name: str, column: int) -> None:
    """Draw a frame from the person's right; ``rotation`` has its axes as columns, in the world."""
    view, length = VIEWS["right"], 0.075
    start = view[:2] @ origin
    for (label, color), along in zip(AXES, rotation.T, strict=True):
        seen, depth = view[:2] @ along, float(view[2] @ along)
        if abs(depth) > 0.5:
            axes.plot(*start, "o", color=color, markersize=9, markerfacecolor="white", markeredgewidth=1.6, zorder=7)
            axes.plot(*start, "x" if depth > 0 else ".", color=color, markersize=5, zorder=8)
            tip, shift = start, (9, 9)
        else:
            tip = start + length * seen
            arrow(axes, start, tip, color, linewidth=2.0, shrinkA=5)
            shift = tuple(6 * np.sign(np.round(seen)))
        axes.annotate(label, tip, xytext=shift, textcoords="offset points", ha="center", va="center", fontsize=8.5,
                      color=color, fontweight="bold", zorder=8)  # fmt: skip
    axes.annotate(name, start, xytext=((-14, 14, 0)[column], (-20, -20, -20)[column]), textcoords="offset points",
                  ha=("right", "left", "center")[column], fontsize=8, color=INK)  # fmt: skip
