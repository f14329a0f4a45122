"""Predicted angles over those of recorded lifts, by the height of the wrist."""

from __future__ import annotations

from matplotlib.figure import Figure

from liftopt.ergonomics.motion import Motion, motion_of
from liftopt.ergonomics.recorded_lifts import HEIGHTS, RECORDED
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.types import Array
from liftopt.viz.plots_data import Lift
from liftopt.viz.plots_style import FAINT, LIMIT, LINES, panels

TITLES = {
    "elbow": "Elbow flexion",
    "humeral_elevation": "Upper arm from the trunk's axis",
    "wrist_extension": "Wrist extension",
    "twist": "Trunk turn to the left",
}


def recorded_angles(lift: Lift, agent: AgentTrajectory) -> Figure:
    """Return elbow, upper arm, wrist and trunk of a person over the band of ``ergonomics.recorded_lifts``.

    The height of the wrist runs along x; a lift begins at the filled mark. Where nothing was recorded there is no band.
    """
    motion = motion_of(lift.dense, agent)
    height, angles = motion.wrist_height, compared_angles(motion)
    figure, grid = panels(2, 2, height=1.7)
    line = LINES[0]
    for index, (name, title) in enumerate(TITLES.items()):
        axes, values = grid[index // 2][index % 2], angles[name]
        low, high = RECORDED[name].band()
        axes.fill_between(
            HEIGHTS, low, high, color=FAINT, alpha=0.30, linewidth=0, label="recorded: one person, a trend"
        )
        axes.plot(HEIGHTS, RECORDED[name].mean, color=LIMIT, linewidth=1.0, linestyle=(0, (4, 2)), label="its mean")
        axes.plot(height, values, color=line.color, label="predicted")
        axes.plot(height[:1], values[:1], color=line.color, marker=line.marker)
        axes.plot(height[-1:], values[-1:], color=line.color, marker=line.marker, markerfacecolor="white")
        axes.set_title(title)
        axes.set_ylabel("angle [deg]")
        axes.set_ylim(min(axes.get_ylim()[0], -15.0), axes.get_ylim()[1])
    for axes in grid[-1]:
        axes.set_xlabel("height of the wrist [m]")
    grid[0][0].legend(loc="upper left", fontsize=7.5)
    return figure


def compared_angles(motion: Motion) -> dict[str, Array]:
    """Return a person's angles (K,) as the recordings count them, by the names of ``RECORDED`` [deg]."""
    return {
        "elbow": motion.elbow,
        "humeral_elevation": motion.humeral_elevation,
        "wrist_extension": -motion.wrist_flexion,
        "twist": motion.twist,
    }
