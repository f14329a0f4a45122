"""Predicted angles over those of recorded lifts, by the height of the wrist."""

from __future__ import annotations

from matplotlib.figure import Figure

from liftopt.ergonomics.motion import motion_of
from liftopt.ergonomics.recorded_lifts import HEIGHTS, LIFTS, RECORDED
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.viz.plots_data import Lift
from liftopt.viz.plots_style import FAINT, INK, LIMIT, LINES, panels


def recorded_angles(lift: Lift, agent: AgentTrajectory) -> Figure:
    """Return elbow, upper arm, wrist and trunk of a person over the band of ``ergonomics.recorded_lifts``.

    Heights run along x; the lift begins at the filled mark. Where no lift was recorded there is no band.
    """
    motion = motion_of(lift.dense, agent)
    shown = {
        "elbow": ("Elbow flexion", motion.elbow),
        "humeral_elevation": ("Upper arm from the trunk's axis", motion.humeral_elevation),
        "wrist_extension": ("Wrist extension", -motion.wrist_flexion),
        "twist": ("Trunk turn to the left", motion.twist),
    }
    figure, grid = panels(2, 2, height=1.7)
    for index, (name, (title, values)) in enumerate(shown.items()):
        axes, line = grid[index // 2][index % 2], LINES[0]
        low, high = RECORDED[name].band()
        axes.fill_between(HEIGHTS, low, high, color=FAINT, alpha=0.30, linewidth=0, label="recorded, mean \N{PLUS-MINUS SIGN} s.d.")
        axes.plot(HEIGHTS, RECORDED[name].mean, color=LIMIT, linewidth=1.0, linestyle=(0, (4, 2)))
        axes.plot(motion.wrist_height, values, color=line.color, label="predicted")
        axes.plot(motion.wrist_height[0], values[0], color=line.color, marker=line.marker)
        axes.plot(
            motion.wrist_height[-1], values[-1], color=line.color, marker=line.marker, markerfacecolor="white"
        )
        axes.set_title(title)
        axes.set_ylabel("angle [deg]")
    for axes in grid[-1]:
        axes.set_xlabel("height of the wrist [m]")
    grid[0][0].legend(loc="upper left", fontsize=7.5)
    few = f"{LIFTS[-1]} above {HEIGHTS[-2] - 0.05:.2f} m"
    figure.text(
        0.995, 0.995, f"recorded: one person, {LIFTS[0]} two-handed lifts of a box, {few}: a trend, no norm",
        ha="right", va="top", fontsize=7.5, color=INK,
    )  # fmt: skip
    return figure
