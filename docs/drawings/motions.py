"""One panel a joint: the model at rest in grey, moved in one joint in colour, and an arrow along the way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from matplotlib.axes import Axes

from drawings.stage import PALE, Body, arrow, bare, paint_bodies
from liftopt.types import Array
from liftopt.viz.outlines import VIEWS
from liftopt.viz.plots_style import VERMILION


@dataclass(frozen=True)
class Motion:
    """How one joint is shown.

    Attributes:
        joint: its name in the model.
        view: from where it is seen.
        turn: how far it is moved [rad].
        rest: (nq,) the posture that it is moved from.
        tracer: (3,) a point of the world, carried by what the joint moves; the arrow is its path [m].
        window: left, right, bottom, top of what is shown [m].
    """

    joint: str
    view: str
    turn: float
    rest: Array
    tracer: Array
    window: tuple[float, float, float, float]


def show(axes: Axes, body: Body, motion: Motion, title: str) -> None:
    """Draw one joint's motion."""
    joint = body.model.getJointId(motion.joint)
    moved = motion.rest.copy()
    moved[body.model.idx_qs[joint]] += motion.turn
    carried = {child for child in range(joint, body.model.njoints) if joint in body.model.supports[child].tolist()}
    paint_bodies(axes, [(body, motion.rest)], motion.view, lambda link, color: PALE, linewidth=0.25)
    paint_bodies(
        axes, [(body, moved)], motion.view, lambda link, color: color if link in carried else PALE, linewidth=0.3,
        zorder=3,
    )  # fmt: skip
    path = _path(body, motion, joint)
    axes.plot(*path[:-1].T, color=VERMILION, linewidth=2.0, zorder=6)
    arrow(axes, path[-3], path[-1], VERMILION, mutation_scale=12)
    axes.set_title(title, fontsize=7.8, loc="center")
    fill(axes, motion.window)


def fill(axes: Axes, window: tuple[float, float, float, float]) -> None:
    """Show a window (left, right, bottom, top), and more of the world where the panel has another shape."""
    left, right, bottom, top = window
    width, height = axes.get_position().size * axes.get_figure().get_size_inches()
    scale = max((right - left) / width, (top - bottom) / height)
    across, up = (left + right) / 2, (bottom + top) / 2
    axes.set(
        xlim=(across - scale * width / 2, across + scale * width / 2),
        ylim=(up - scale * height / 2, up + scale * height / 2),
    )
    bare(axes)


def _path(body: Body, motion: Motion, joint: int) -> Array:
    """Return where the tracer goes (K, 2) as the joint turns."""
    data = body.model.createData()
    pin.forwardKinematics(body.model, data, motion.rest)
    local, path = data.oMi[joint].actInv(motion.tracer), []
    for share in np.linspace(0.0, 1.0, 25):
        q = motion.rest.copy()
        q[body.model.idx_qs[joint]] += share * motion.turn
        pin.forwardKinematics(body.model, data, q)
        path.append(VIEWS[motion.view][:2] @ data.oMi[joint].act(local))
    return np.array(path)
