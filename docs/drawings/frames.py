"""World frame, where the two stand, and the distances and heights that a scenario gives."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from drawings.stage import arrow, bare, bodies, default_lift, measure, paint_bodies
from liftopt.viz.plots_style import BLUE, GREEN, INK, LIMIT, VERMILION

AXIS = 0.28  # length of a drawn axis [m]


def frames() -> Figure:
    """Return the lift from the person's right and from above, with axes and the scenario's measures."""
    figure = Figure(figsize=(7.6, 6.4))
    side, above = figure.subplots(2, 1, height_ratios=[2.05, 1.0])
    figure.subplots_adjust(left=0.01, right=0.99, top=0.99, bottom=0.01, hspace=0.04)
    _side(side)
    _above(above)
    return figure


def _side(axes: Axes) -> None:
    solution, cast = default_lift(), bodies()
    end = [(body, body.q[-1]) for body in cast.values()]
    paint_bodies(axes, end, "right", alpha=0.16, linewidth=0.2)
    paint_bodies(axes, [(body, body.q[0]) for body in cast.values()], "right")
    (person, robot), points = solution.agents, solution.object.grasp_position[:, :, [0, 2]]
    task, machine = solution.scenario.task, solution.scenario.agents["robot"]
    axes.plot([-0.45, 2.35], [0.0, 0.0], color=INK, linewidth=0.8)
    for column, (agent, color) in enumerate(zip((person, robot), (BLUE, VERMILION), strict=True)):
        axes.plot(*points[:, column].T, color=color, linewidth=1.2, linestyle=(0, (1, 1)), zorder=5)
        axes.plot(*points[[0, -1], column].T, "o", color=color, markersize=4, zorder=6)
        axes.annotate(
            f"{agent.name}_grasp", points[0, column], xytext=(0, -12), textcoords="offset points", fontsize=7.5,
            color=color, ha="center", zorder=7,
        )  # fmt: skip
    _axes_cross(axes, ("X", "Z"), (BLUE, GREEN))
    middle = points[:, :, 0].mean(axis=1)
    measure(axes, (middle[0], 0.0), (middle[0], task.start.height), f"task.start.height {task.start.height:g} m",
            ha="left", va="center", offset=(4, -8))  # fmt: skip
    measure(axes, (1.42, 0.0), (1.42, task.end.height), f"task.end.height\n{task.end.height:g} m", ha="right",
            va="center", offset=(-4, -44))  # fmt: skip
    axes.plot([middle[-1], 1.42], [task.end.height] * 2, color=LIMIT, linewidth=0.6, linestyle=":")
    base = task.standing_distance
    measure(axes, (2.16, 0.0), (2.16, machine.base_height), f"robot.base_height\n{machine.base_height:g} m", ha="left",
            va="center", offset=(4, 0))  # fmt: skip
    measure(axes, (0.0, -0.26), (base, -0.26), f"task.standing_distance {base:g} m", va="top", offset=(0, -3))
    measure(axes, (0.0, -0.12), (task.start.human_distance, -0.12), f"task.start.human_distance "
            f"{task.start.human_distance:g} m", ha="left", va="center", offset=(44, 0))  # fmt: skip
    for x, bottom in ((0.0, -0.3), (base, -0.3), (task.start.human_distance, -0.15)):
        axes.plot([x, x], [bottom, 0.0], color=LIMIT, linewidth=0.6, linestyle=":")
    axes.plot([task.start.human_distance] * 2, [0.0, task.start.height], color=LIMIT, linewidth=0.6, linestyle=":")
    axes.text(-0.45, 1.78, "from the person's right", fontsize=8, color=LIMIT)
    axes.set(xlim=(-0.5, 2.65), ylim=(-0.36, 1.86))
    bare(axes)


def _above(axes: Axes) -> None:
    solution, cast = default_lift(), bodies()
    paint_bodies(axes, [(body, body.q[0]) for body in cast.values()], "above")
    points = solution.object.grasp_position[0, :, :2]
    axes.plot(points[0, 0], points[0, 1], "o", color=BLUE, markersize=4, zorder=6)
    axes.plot(points[1, 0], points[1, 1], "o", color=VERMILION, markersize=4, zorder=6)
    box, x, y = solution.scenario.object, float(points[:, 0].mean()), float(points[0, 1])
    measure(axes, (x - box.depth / 2, y + box.width / 2 + 0.05), (x + box.depth / 2, y + box.width / 2 + 0.05),
            f"depth {box.depth:g} m")  # fmt: skip
    measure(axes, (x + 0.03, y - box.width / 2), (x + 0.03, y + box.width / 2), f"width {box.width:g} m", ha="left",
            va="center", offset=(4, 0))  # fmt: skip
    _axes_cross(axes, ("X", "Y"), (BLUE, VERMILION))
    axes.annotate("to the robot", (AXIS, 0.0), xytext=(-30, -40), textcoords="offset points", fontsize=7, color=LIMIT)
    axes.annotate("to the person's left", (0.0, AXIS), xytext=(8, 4), textcoords="offset points", fontsize=7,
                  color=LIMIT)  # fmt: skip
    axes.text(-0.45, 0.42, "from above", fontsize=8, color=LIMIT)
    axes.set(xlim=(-0.5, 2.65), ylim=(-0.5, 0.5))
    bare(axes)


def _axes_cross(axes: Axes, names: tuple[str, str], colors: tuple[str, str]) -> None:
    for name, color, direction in zip(names, colors, np.eye(2) * AXIS, strict=True):
        arrow(axes, (0.0, 0.0), direction, color, linewidth=2.0, zorder=8)
        axes.annotate(name, direction, xytext=tuple(np.sign(direction) * 7), textcoords="offset points", ha="center",
                      va="center", fontsize=9, fontweight="bold", color=color, zorder=8)  # fmt: skip
