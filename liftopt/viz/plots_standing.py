"""Where the floor bears a person over the lift: the centre of pressure under the feet, and its margin."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch, Rectangle

from liftopt.assessment.who import who_is
from liftopt.ergonomics.lift import model_of, subject_in
from liftopt.multibody.person.anthropometry import HEEL_BEHIND_ANKLE, HIP_JOINT_SPREAD, dimension
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.standing import pressure_in_base, support_margin
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.viz.plots_data import Lift
from liftopt.viz.plots_style import FAINT, INK, LIMIT, LINES, VERMILION, draw, panels, time_axes

SHARE = 0.36  # of the figure's width that the feet take
CM = 100.0  # per metre


def centre_of_pressure(lift: Lift, agent: AgentTrajectory) -> Figure:
    """Return the way of the centre of pressure under a person's feet, seen from above, and its margin over time."""
    solution, model = lift.dense, model_of(lift.dense, agent.name)
    figure, grid = panels(1, height=2.3)
    margin = grid[0][0]
    left, bottom, width, height = margin.get_position().bounds
    feet = figure.add_axes((left, bottom, SHARE * width, height))
    margin.set_position((left + (SHARE + 0.13) * width, bottom, (0.87 - SHARE) * width, height))
    margin.yaxis.set_label_coords(-0.1, 0.5)
    _feet(feet, subject_in(solution, agent.name))
    assert model.stance is not None
    back, ahead, aside = (CM * value for value in model.stance.support)
    feet.add_patch(
        Rectangle((-aside, back), 2 * aside, ahead - back, fill=False, edgecolor=VERMILION, linestyle=(0, (6, 2)))
    )
    path = CM * pressure_in_base(model, agent)
    across, line = -path[:, 1], LINES[0]  # seen from above with the toes up, the left foot is on the left
    feet.plot(across, path[:, 0], color=line.color)
    feet.plot(across[:1], path[:1, 0], color=line.color, marker="o", linestyle="", label="start")
    feet.plot(
        across[-1:], path[-1:, 0], color=line.color, marker="o", markerfacecolor="white", linestyle="", label="end"
    )
    feet.set_aspect("equal", adjustable="box", anchor="W")
    feet.set(xlabel="to the right [cm]", ylabel="ahead of the ankles [cm]")
    feet.set_title("Centre of pressure from above", pad=27)
    feet.legend(loc="lower center", ncols=2, fontsize=7, borderaxespad=0.0)
    draw(margin, solution.time, CM * support_margin(model, agent), line, knots=lift.factor)
    margin.axhline(0.0, color=VERMILION, linewidth=1.0, linestyle=(0, (6, 2)))
    margin.set_ylim(min(0.0, margin.get_ylim()[0]) - 0.5, margin.get_ylim()[1])
    margin.text(99.0, 0.0, "edge of the soles", ha="right", va="bottom", fontsize=7, color=INK)
    margin.set(title=f"Margin of {who_is(agent, solution.agents).called} within the soles", ylabel="margin [cm]")
    time_axes(grid, float(solution.time[-1]))
    return figure


def _feet(axes: Axes, subject: Subject) -> None:
    """Draw both soles from above, toes up."""
    length, breadth = (CM * dimension(subject, name) for name in ("footlength", "footbreadthhorizontal"))
    heel, beside = -HEEL_BEHIND_ANKLE * length, CM * HIP_JOINT_SPREAD * dimension(subject, "hipbreadth")
    for middle, word in ((-beside, "left"), (beside, "right")):
        shape = FancyBboxPatch(
            (middle - breadth / 2, heel), breadth, length, boxstyle=f"round,pad=0,rounding_size={0.45 * breadth}",
            facecolor="#efefef", edgecolor=FAINT, linewidth=1.0, zorder=0,
        )  # fmt: skip
        axes.add_patch(shape)
        axes.text(middle, heel + 0.9 * length, word, ha="center", va="top", fontsize=7, color=LIMIT)
    room = np.array([-0.25, 0.12]) * length
    axes.set_ylim(heel + room[0], heel + length + room[1])
    axes.set_xlim(-beside - breadth, beside + breadth)
