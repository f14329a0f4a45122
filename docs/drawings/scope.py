"""What of the scene is modelled and how: coloured by what moves it in the models."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from drawings.stage import PALE, Body, bare, bodies, default_lift, joint_place, paint_bodies
from liftopt.types import Array
from liftopt.viz.plots_style import BLUE, INK, ORANGE, SKY, VERMILION

STANDS, TRUNK, ARM, ROBOT, OBJECT = PALE, SKY, BLUE, VERMILION, ORANGE


def scope() -> Figure:
    """Return the middle of the default lift, every part in the colour of what it is to the model."""
    solution, cast = default_lift(), bodies()
    figure = Figure(figsize=(8.2, 4.9))
    axes = figure.subplots()
    figure.subplots_adjust(left=0.01, right=0.99, top=0.99, bottom=0.01)
    middle = len(solution.time) // 2
    for body in cast.values():
        paint_bodies(axes, [(body, body.q[middle])], "right", lambda link, color, body=body: _paint(body.name, link))
    axes.plot([-0.45, 2.35], [0.0, 0.0], color=INK, linewidth=0.8)
    person, robot = cast["human"], cast["robot"]
    spine, elbow, wrist = (_seen(person, f"human_{joint}", middle) for joint in ("Q1", "Q7", "Q9"))
    base, arm = (_seen(robot, f"robot_{joint}", middle) for joint in ("Q1", "Q4"))
    points = solution.object.grasp_position[middle, :, [0, 2]].T
    axes.plot(*points.T, "o", color=INK, markersize=4, zorder=7)
    _note(axes, "head and left arm are\none body with the trunk", (spine[0], spine[1] + 0.55), (-0.98, 1.72))
    _note(axes, "three joints at one point\nfor the whole spine", spine, (-0.98, 1.16))
    _note(axes, "legs and pelvis stand still;\ntheir weight and the ground\nreaction count", (-0.02, 0.5), (-0.98, 0.5))
    _note(axes, "seven joints from\nshoulder to wrist", (elbow + wrist) / 2, (0.5, 1.72))
    _note(axes, "no fingers: one grasp point\nat the middle of the hand", points[0], (0.12, 0.62))
    _note(
        axes, "a rigid box of even density;\nnothing keeps it out\nof body or robot", points.mean(axis=0), (0.75, 0.28)
    )
    _note(axes, "rigid links, torques at the\njoints; no friction, no motors", arm, (1.12, 1.72))
    _note(axes, "gripper: length and mass", points[1], (0.95, 0.78))
    _note(axes, "the screen looks\nstraight ahead", base + np.array([0.0, 0.45]), (2.15, 1.75))
    _note(axes, "pedestal: stands still", base - np.array([0.0, 0.5]), (2.15, 0.62))
    names = ("stands still", "trunk: Q1 to Q3", "right arm: Q4 to Q10", "robot: Q1 to Q7", "object: six coordinates")
    patches = [Patch(facecolor=color, edgecolor=INK, linewidth=0.4, label=name)
               for name, color in zip(names, (STANDS, TRUNK, ARM, ROBOT, OBJECT), strict=True)]  # fmt: skip
    axes.legend(handles=patches, loc="lower center", ncols=5, fontsize=7.5, bbox_to_anchor=(0.5, -0.01))
    axes.set(xlim=(-1.0, 2.65), ylim=(-0.22, 1.95))
    bare(axes)
    return figure


def _paint(body: str, link: int) -> tuple[float, float, float]:
    """Return the colour of a part from the joint that carries it; of both chains the first three are held."""
    if body == default_lift().object.name:
        return OBJECT
    if link <= 3:
        return STANDS
    if body == "robot":
        return ROBOT
    return TRUNK if link <= 6 else ARM


def _seen(body: Body, joint: str, knot: int) -> Array:
    return joint_place(body, joint, body.q[knot])[[0, 2]]


def _note(axes: Axes, text: str, point: Array | tuple[float, float], place: tuple[float, float]) -> None:
    line = {"arrowstyle": "-", "color": INK, "linewidth": 0.6, "shrinkB": 0}
    axes.annotate(text, point, xytext=place, fontsize=7.5, va="center", color=INK, arrowprops=line, zorder=8,
                  bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.0, "alpha": 0.85})  # fmt: skip
