"""What the lift costs the person: strength used by each joint, and RULA by its parts, over time."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from liftopt.assessment.joints import NEAR_LIMIT
from liftopt.assessment.who import who_is
from liftopt.ergonomics.measures import ergonomics_of
from liftopt.ergonomics.scores import PostureScores
from liftopt.multibody.joint_curves import anatomy_of
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.types import Array
from liftopt.viz.plots_data import Lift
from liftopt.viz.plots_style import FAINT, INK, LINES, VERMILION, panels, percent, time_axes

ONE_ARM = 10  # joints of a person with one arm
Levels = tuple[tuple[float, str], ...]
ACTION_LEVELS: Levels = ((2.5, "acceptable"), (4.5, "investigate"), (6.5, "change soon"), (7.5, "change now"))
REBA_LEVELS: Levels = ((3.5, "low risk"), (7.5, "investigate"), (10.5, "change soon"), (12.5, "change now"))


def strength_used(lift: Lift, agent: AgentTrajectory) -> Figure:
    """Return a map of the share of strength by joint and time, darker for more."""
    solution = lift.dense
    uses = ergonomics_of(solution, agent).strength
    share = 100 * np.stack([use.share for use in uses])
    figure, grid = panels(1, height=0.29 * len(uses), left=2.45 if len(uses) > ONE_ARM else 2.15, right=1.2)
    axes = grid[0][0]
    top = max(50.0, float(share.max()))
    edges = np.concatenate([[0.0], (percent(solution.time)[1:] + percent(solution.time)[:-1]) / 2, [100.0]])
    image = axes.pcolormesh(edges, np.arange(len(uses) + 1), share, cmap="Blues", vmin=0.0, vmax=top, rasterized=True)
    axes.set_yticks(np.arange(len(uses)) + 0.5, [joint.label for joint in anatomy_of(agent)])
    axes.invert_yaxis()
    axes.grid(False)
    for row, use in enumerate(uses):
        axes.text(101.5, row + 0.5, f"{100 * use.peak:.0f} %", va="center", fontsize=8, color=INK)
        axes.axhline(row, color="white", linewidth=1.2)
        if use.peak >= NEAR_LIMIT:
            axes.contour(
                (edges[1:] + edges[:-1]) / 2, [row, row + 1], share[[row, row]], [100 * NEAR_LIMIT], colors=VERMILION
            )
    axes.text(103.5, -0.25, "peak", va="bottom", fontsize=7.5, color=INK)
    figure.colorbar(image, cax=axes.inset_axes((1.16, 0.0, 0.03, 1.0)), label="strength used [%]")
    axes.set_title(f"Strength used by each joint of {who_is(agent, solution.agents).called}")
    time_axes(grid, float(solution.time[-1]))
    return figure


def posture_score(lift: Lift, agent: AgentTrajectory) -> Figure:
    """Return the grand score of RULA over time, the scores it is made of, and REBA's of a person with legs."""
    solution = lift.dense
    ergonomics, time = ergonomics_of(solution, agent), percent(solution.time)
    scores, entire = ergonomics.rula, ergonomics.reba
    figure, grid = panels(2 + (entire is not None), height=1.5)
    grand, parts = (line[0] for line in grid[:2])
    _grand(grand, time, scores, ACTION_LEVELS)
    grand.set(title="RULA grand score", ylabel="score", yticks=range(1, 8))
    if entire is not None:
        _grand(grid[2][0], time, entire, REBA_LEVELS)
        grid[2][0].set(title="REBA grand score", ylabel="score", yticks=range(1, 13, 2))
    for values, line, label, shift in (
        (scores.upper_arm, LINES[0], "upper arm", 0.09),
        (scores.lower_arm, LINES[1], "lower arm", 0.03),
        (scores.wrist, LINES[2], "wrist", -0.03),
        (scores.trunk, LINES[3], "trunk", -0.09),
    ):
        parts.step(
            time, values + shift, where="post", color=line.color, linestyle=line.linestyle, label=label,
            marker=line.marker, markevery=3 * lift.factor, markerfacecolor="white",
        )  # fmt: skip
    parts.step(time, scores.force, where="post", color=FAINT, linewidth=1.2, label="force")
    parts.set(title="Scores of the parts", ylabel="score", yticks=range(7), ylim=(-0.4, 6.4))
    parts.legend(ncols=5, loc="upper center", fontsize=7.5)
    time_axes(grid, float(solution.time[-1]))
    return figure


def _grand(axes: Axes, time: Array, scores: PostureScores, levels: Levels) -> None:
    """Draw a grand score over percent of the lift, above bands of what it asks for."""
    low = 0.5
    for level, (high, action) in enumerate(levels):
        axes.axhspan(low, high, facecolor=str(0.97 - 0.07 * level), zorder=0)
        axes.text(99.0, (low + high) / 2, action, ha="right", va="center", fontsize=7.5, color=INK)
        low = high
    axes.step(time, scores.grand, where="post", color=INK, linewidth=2.2)
    axes.set_ylim(0.5, low)
