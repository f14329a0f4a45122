"""Snapshots of the lift from the person's right side (Fig. 11): the models' own shapes in outline, forces as arrows."""

from __future__ import annotations

from itertools import cycle
from textwrap import wrap

import numpy as np
import pinocchio as pin
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, Polygon

from liftopt.assessment.who import listed, who_is
from liftopt.ergonomics.lift import subject_in
from liftopt.scenario.build import agents_of, object_of
from liftopt.solution.solution import Solution
from liftopt.types import Array
from liftopt.viz.base import base_of
from liftopt.viz.outlines import outlines
from liftopt.viz.plots_data import Lift
from liftopt.viz.plots_style import BLUE, GREEN, INK, PURPLE, VERMILION
from liftopt.viz.who import stand_opposite

MOMENTS = (0.0, 0.25, 0.5, 0.75, 1.0)
KEY_LENGTH, LONGEST = 0.2, 0.6  # of the arrow that the key shows, and of any [m]
KEY_FORCES = (5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0)  # N
# Color and head of the arrow by agent, and both in words.
ARROWS = (
    (BLUE, "-|>", "blue, filled head"),
    (VERMILION, "->", "red, open head"),
    (GREEN, "-|>", "green, filled head"),
    (PURPLE, "->", "pink, open head"),
)
HEADROOM = 0.15  # [m]
WORDS, LINE = 160, 0.2  # that a line below the panels holds, and its height [in]


def snapshots(lift: Lift) -> Figure:
    """Return the lift at five moments, side by side."""
    solution = lift.dense
    figure = Figure(figsize=(12.0, 2.6))
    figure.subplots_adjust(left=0.005, right=0.995, top=0.9, bottom=0.13, wspace=0.02)
    panels = figure.subplots(1, len(MOMENTS), sharex=True, sharey=True)
    path = solution.object.grasp_position[:, 0]
    bodies = _bodies(lift)
    key = _key_force(max(float(np.linalg.norm(agent.grasp_force, axis=1).max()) for agent in solution.agents))
    for axes, moment in zip(panels, MOMENTS, strict=True):
        k = round(moment * (len(solution.time) - 1))
        parts = [part for model, visual, q in bodies for part in outlines(model, visual, q[k])]
        for part in sorted(parts, key=lambda part: -part.depth):
            axes.add_patch(Polygon(part.polygon, facecolor=part.color, edgecolor=INK, linewidth=0.35))
        axes.plot(path[: k + 1, 0], path[: k + 1, 2], color=INK, linewidth=1.0, linestyle=(0, (1, 1)), zorder=3)
        for agent, (color, head, _) in zip(solution.agents, cycle(ARROWS), strict=False):
            _arrow(axes, agent.grasp_position[k], KEY_LENGTH / key * agent.grasp_force[k], color, head)
        axes.axhline(0.0, color=INK, linewidth=1.0)
        axes.set_title(f"{100 * moment:.0f} %, {solution.time[k]:.2f} s", loc="center", fontsize=11)
        axes.grid(False)
        axes.set_aspect("equal")
        axes.spines[["left", "bottom"]].set_visible(False)
        axes.tick_params(left=False, bottom=False, labelleft=False, labelbottom=False)
    ahead = np.concatenate([agent.grasp_position[:, 0] for agent in solution.agents] + [_standing(solution)])
    tall = [subject_in(solution, person.name).stature for person in solution.persons]
    panels[0].set_xlim(float(ahead.min()) - 0.35, float(ahead.max()) + 0.4)
    panels[0].set_ylim(-0.16, max(1.7, *tall, 0.0) + HEADROOM)
    _key(figure, panels[0], key, solution)
    return figure


def _standing(solution: Solution) -> Array:
    """Return X of the base of every agent [m]."""
    return np.array([base_of(agent)[0, 3] for agent in agents_of(solution.scenario, solution.urdfs)])


def _key_force(largest: float) -> float:
    """Return the force [N] whose arrow is ``KEY_LENGTH`` long, so that no arrow is longer than ``LONGEST``."""
    return next((key for key in KEY_FORCES if largest * KEY_LENGTH <= LONGEST * key), KEY_FORCES[-1])


def _key(figure: Figure, axes: Axes, force: float, solution: Solution) -> None:
    """Say how long an arrow is, below the first panel, and what the arrows and the dotted line are."""
    left, length = axes.get_xlim()[0] + 0.05, KEY_LENGTH
    axes.plot([left, left + length], [-0.1, -0.1], color=INK, linewidth=1.2, marker="|", markersize=6)
    axes.text(left + length + 0.05, -0.1, f"{force:g} N", va="center", fontsize=10, color=INK)
    agents = solution.agents
    arrows = [
        f"by {who_is(agent, agents).called} ({words})"
        for agent, (_, _, words) in zip(agents, cycle(ARROWS), strict=False)
    ]
    side = "the person's right" if stand_opposite(solution.scenario) else "the side, x to the right"
    first = who_is(agents[0], agents)
    whose = f"the {first.hand}" if stand_opposite(solution.scenario) else f"the {first.hand} of {first.called}"
    lines = wrap(
        f"Seen from {side}. Arrows: force on the {solution.object.name} {listed(arrows)}. Dotted: path of {whose}.",
        WORDS,
    )
    old, room, at = figure.get_figheight(), LINE * (len(lines) - 1), figure.subplotpars
    figure.set_figheight(old + room)
    figure.subplots_adjust(top=1 - (1 - at.top) * old / (old + room), bottom=(at.bottom * old + room) / (old + room))
    figure.supxlabel("\n".join(lines), fontsize=10.5, color=INK, y=0.01)


def _bodies(lift: Lift) -> list[tuple[pin.Model, pin.GeometryModel, Array]]:
    """Return each model with its shapes and its q (K, nq); all are drawn in one picture."""
    solution = lift.dense
    lifted = object_of(solution.scenario, solution.urdfs)
    poses = np.hstack([solution.object.pose[:, :3], solution.object.quaternion])
    models = [
        *((agent.model, agent.urdf) for agent in agents_of(solution.scenario, solution.urdfs)),
        (lifted.model, lifted.urdf),
    ]
    motions = [*(agent.q for agent in solution.agents), poses]
    return [
        (model, pin.buildGeomFromUrdfString(model, urdf, pin.GeometryType.VISUAL), q)
        for (model, urdf), q in zip(models, motions, strict=True)
    ]


def _arrow(axes: Axes, point: Array, along: Array, color: str, head: str) -> None:
    tip = point + along
    arrow = FancyArrowPatch(
        (point[0], point[2]), (tip[0], tip[2]), arrowstyle=head, mutation_scale=9, color=color, linewidth=2.0,
        shrinkA=0, shrinkB=0, zorder=5,
    )  # fmt: skip
    axes.add_patch(arrow)
