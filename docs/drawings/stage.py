"""What all drawings share: the default lift and its models, their outlines, arrows and labels."""

from __future__ import annotations

import atexit
import shutil
import tempfile
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
from matplotlib.axes import Axes
from matplotlib.patches import FancyArrowPatch, Polygon

import liftopt as lo
from liftopt.scenario.build import agents_of, object_of
from liftopt.types import Array
from liftopt.viz.outlines import outlines
from liftopt.viz.plots_style import INK

PALE = (0.86, 0.87, 0.89)
Paint = Callable[[int, tuple[float, float, float]], tuple[float, float, float]]


class Body(NamedTuple):
    """A model, its shapes, and where it is at the knots of the default lift."""

    name: str
    model: pin.Model
    visual: pin.GeometryModel
    q: Array


@cache
def default_lift() -> lo.Solution:
    """Return the default lift, solved once for all drawings."""
    return lo.solve(lo.load_scenario("table5"))


@cache
def default_result() -> Path:
    """Return the folder that the default lift is saved in, for as long as the build takes."""
    folder = Path(tempfile.mkdtemp(prefix="liftopt-docs-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return default_lift().save(folder)


@cache
def bodies() -> dict[str, Body]:
    """Return person, robot and object of the default lift by name."""
    solution = default_lift()
    lifted = object_of(solution.scenario, solution.urdfs)
    poses = np.hstack([solution.object.pose[:, :3], solution.object.quaternion])
    pairs = zip(agents(), solution.agents, strict=True)
    found = [Body(agent.name, agent.model, _shapes(agent.model, agent.urdf), motion.q) for agent, motion in pairs]
    return {
        body.name: body for body in [*found, Body(lifted.name, lifted.model, _shapes(lifted.model, lifted.urdf), poses)]
    }


@cache
def agents() -> tuple[Any, ...]:
    """Return the person and the robot of the default lift as the optimal-control problem knows them."""
    solution = default_lift()
    return agents_of(solution.scenario, solution.urdfs)


def joint_place(body: Body, joint: str, q: Array) -> Array:
    """Return where a joint of a body stands in the world at q (nq,): its origin (3,) [m]."""
    data = body.model.createData()
    pin.forwardKinematics(body.model, data, q)
    return np.array(data.oMi[body.model.getJointId(joint)].translation)


def _shapes(model: pin.Model, urdf: str) -> pin.GeometryModel:
    return pin.buildGeomFromUrdfString(model, urdf, pin.GeometryType.VISUAL)


def paint_bodies(
    axes: Axes, posed: Sequence[tuple[Body, Array]], view: str, paint: Paint | None = None, **style: Any
) -> None:
    """Fill the outlines of bodies at their q (nq,) as seen from one side, the farthest first.

    Args:
        axes: to draw on.
        posed: bodies and their joint angles.
        view: one of ``VIEWS`` in ``liftopt.viz.outlines``.
        paint: from the joint that carries a part and the part's colour to the colour drawn; None keeps it.
        style: of the edges and the fill, as matplotlib takes it.
    """
    parts = [part for body, q in posed for part in outlines(body.model, body.visual, q, view)]
    style = {"edgecolor": INK, "linewidth": 0.35} | style
    for part in sorted(parts, key=lambda part: -part.depth):
        color = part.color if paint is None else paint(part.link, part.color)
        axes.add_patch(Polygon(part.polygon, facecolor=color, **style))


def arrow(axes: Axes, start: Sequence[float], end: Sequence[float], color: str = INK, **style: Any) -> None:
    """Draw an arrow between two points in data coordinates."""
    shape = {"arrowstyle": "-|>", "mutation_scale": 9, "linewidth": 1.4, "shrinkA": 0, "shrinkB": 0, "zorder": 6}
    axes.add_patch(FancyArrowPatch(tuple(start), tuple(end), color=color, **(shape | style)))


def measure(axes: Axes, start: tuple[float, float], end: tuple[float, float], text: str, **at: Any) -> None:
    """Draw a dimension: a line with two heads, and its name and value beside the middle."""
    arrow(axes, start, end, arrowstyle="<|-|>", linewidth=0.9, mutation_scale=7)
    middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
    style = {"ha": "center", "va": "bottom", "fontsize": 7.5, "color": INK, "zorder": 7} | at
    offset = style.pop("offset", (0, 2))
    background = {"facecolor": "white", "edgecolor": "none", "pad": 0.6, "alpha": 0.8}
    axes.annotate(text, middle, xytext=offset, textcoords="offset points", bbox=background, **style)


def bare(axes: Axes) -> None:
    """Leave nothing of the axes but what is drawn, at one scale in both directions."""
    axes.set_aspect("equal")
    axes.set_axis_off()
