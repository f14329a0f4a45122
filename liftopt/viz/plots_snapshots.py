"""Snapshots of the lift (Fig. 11 of the paper): bodies as the viewer shows them, with forces and paths of all hands."""

from __future__ import annotations

from itertools import cycle
from textwrap import wrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch

from liftopt.assessment.who import listed, who_is
from liftopt.multibody.trajectory import grasps_of
from liftopt.solution.solution import Solution
from liftopt.types import Array
from liftopt.viz.camera import Camera, straight
from liftopt.viz.picture import bodies_at
from liftopt.viz.playback import playback_at
from liftopt.viz.plots_data import Lift
from liftopt.viz.plots_style import BLUE, GREEN, INK, PURPLE, VERMILION
from liftopt.viz.scene import Cast, parts_of
from liftopt.viz.shading import render
from liftopt.viz.viewer_views import views_of
from liftopt.viz.who import lead_of, stand_opposite

MOMENTS = (0.0, 0.25, 0.5, 0.75, 1.0)
PANEL = (480, 380)  # width and height of each [pixels]
# From where, as the lead sees it: two who face each other from the lead's right; others so that none hides another.
SIDE, OBLIQUE, ROOM = (0.0, -1.0, 0.1), (0.5, -1.0, 0.55), 0.02
KEY_LENGTH, LONGEST = 0.2, 0.6  # of the arrow that the key shows, and of any [m]
KEY_FORCES = (5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0)  # N
# Color and head of the arrow by agent, and both in words.
ARROWS = (
    (BLUE, "-|>", "blue, filled head"),
    (VERMILION, "->", "red, open head"),
    (GREEN, "-|>", "green, filled head"),
    (PURPLE, "->", "pink, open head"),
)
WORDS, LINE = 160, 0.2  # that a line below the panels holds, and its height [in]


def snapshots(lift: Lift) -> Figure:
    """Return the lift at five moments, side by side."""
    solution = lift.dense
    figure = Figure(figsize=(12.0, 2.6))
    figure.subplots_adjust(left=0.005, right=0.995, top=0.9, bottom=0.13, wspace=0.02)
    panels = figure.subplots(1, len(MOMENTS))
    frames = [round(moment * (len(solution.time) - 1)) for moment in MOMENTS]
    cast = Cast(solution, playback_at(lift.knots, solution.time[frames]), "/lift", figures=lift.figures)
    facing = stand_opposite(solution.scenario)
    camera = _camera(cast, SIDE if facing else OBLIQUE)
    key = _key_force(max(float(np.linalg.norm(agent.grasp_force, axis=2).max()) for agent in solution.agents))
    parts = parts_of(cast)
    for i, (axes, moment, k) in enumerate(zip(panels, MOMENTS, frames, strict=True)):
        axes.imshow(render(bodies_at(cast, parts, i), camera, PANEL), interpolation="antialiased")
        for agent, (color, head, _) in zip(solution.agents, cycle(ARROWS), strict=False):
            for point, force in zip(agent.grasp_position.swapaxes(0, 1), agent.grasp_force.swapaxes(0, 1), strict=True):
                path = camera.project(point)[:, :2]
                axes.plot(*path.T, color=color, linewidth=0.6, alpha=0.5)
                axes.plot(*path[: k + 1].T, color=color, linewidth=1.0, linestyle=(0, (1, 1)), zorder=3)
                _arrow(axes, camera, point[k], KEY_LENGTH / key * force[k], color, head)
        axes.set_title(f"{100 * moment:.0f} %, {solution.time[k]:.2f} s", loc="center", fontsize=11)
        axes.set(xlim=(0, PANEL[0]), ylim=(PANEL[1], 0))
        axes.grid(False)
        axes.spines[["left", "bottom"]].set_visible(False)
        axes.tick_params(left=False, bottom=False, labelleft=False, labelbottom=False)
    _key(figure, panels[0], camera.scale, key, solution, facing)
    return figure


def _camera(cast: Cast, side: tuple[float, float, float]) -> Camera:
    """Return the camera from a side (3,), as the one sees it from whom pictures are looked at, that has all in view."""
    whole = next(view for view in views_of([cast]) if view.name == "side")
    low, high = (np.array(corner) for corner in whole.box)
    lead = lead_of(cast.solution.agents)
    from_lead: Array = cast.playback.bases[lead.name][:3, :3] @ side
    return straight(from_lead, low - ROOM, high + ROOM, PANEL)


def _key_force(largest: float) -> float:
    """Return the force [N] whose arrow is ``KEY_LENGTH`` long, so that no arrow is longer than ``LONGEST``."""
    return next((key for key in KEY_FORCES if largest * KEY_LENGTH <= LONGEST * key), KEY_FORCES[-1])


def _key(figure: Figure, axes: Axes, scale: float, force: float, solution: Solution, facing: bool) -> None:
    """Say how long an arrow is, below the first panel, and what the arrows and lines are."""
    left, length, low = 0.03 * PANEL[0], KEY_LENGTH * scale, 0.96 * PANEL[1]
    axes.plot([left, left + length], [low, low], color=INK, linewidth=1.2, marker="|", markersize=6)
    axes.text(left + length + 0.03 * PANEL[0], low, f"{force:g} N", va="center", fontsize=10, color=INK)
    agents = solution.agents
    arrows = [
        f"by {who_is(agent, agents).called} ({words})"
        for agent, (_, _, words) in zip(agents, cycle(ARROWS), strict=False)
    ]
    side = "the person's right" if facing else f"{who_is(lead_of(agents), agents).called}'s right, from ahead and above"
    paths = "Lines: paths of the hands." if len(list(grasps_of(agents))) > 1 else "Line: path of the hand."
    text = f"Seen from {side}. Arrows: force on the {solution.object.name} {listed(arrows)}. {paths}"
    lines = wrap(text, WORDS)
    old, room, at = figure.get_figheight(), LINE * (len(lines) - 1), figure.subplotpars
    figure.set_figheight(old + room)
    figure.subplots_adjust(top=1 - (1 - at.top) * old / (old + room), bottom=(at.bottom * old + room) / (old + room))
    figure.supxlabel("\n".join(lines), fontsize=10.5, color=INK, y=0.01)


def _arrow(axes: Axes, camera: Camera, point: Array, along: Array, color: str, head: str) -> None:
    start, tip = camera.project(np.stack([point, point + along]))[:, :2].tolist()
    arrow = FancyArrowPatch(
        start, tip, arrowstyle=head, mutation_scale=7, color=color, linewidth=1.7, shrinkA=0, shrinkB=0, zorder=5
    )
    axes.add_patch(arrow)
