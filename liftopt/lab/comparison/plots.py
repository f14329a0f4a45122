"""Predicted and recorded curves in one plot: Figs. 13 to 18 of the paper."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from liftopt.viz.plots_style import FAINT, LIMIT, LINES, STYLE, panels

if TYPE_CHECKING:
    from liftopt.lab.comparison.comparison import Comparison
    from liftopt.lab.comparison.experiment import Experiment

GROUPS = {
    "human_angle": "Person, joint angle",
    "human_torque": "Person, joint torque",
    "hand_path": "Hand, path",
    "hand_force": "Hand, force on the object",
    "ground": "Ground, what it bears",
    "robot_angle": "Robot, joint angle",
    "robot_torque": "Robot, joint torque",
}
QUANTITY = {"deg": "angle", "Nm": "torque", "m": "way", "mm": "way", "N": "force"}
# Shoulder and elbow flexion, the joints of Figs. 13 and 14; of a whole person on both sides.
ARM = ("Q5", "Q7", "right_Q5", "right_Q7", "left_Q5", "left_Q7")
LEGS_AND_TRUNK = ("ankle", "knee", "hip", "Q2")
NOTHING = "\N{EM DASH}"
LEAST = 5e-4  # in the units shown; less is shown as 0
HEADER = ("unit", "pred.", "rec.", "differ", "RMSE", "corr.", "phase", "spread")


@dataclass(frozen=True)
class ComparisonPlot:
    """One plot: the name of its file, what it shows, and which comparisons."""

    name: str
    caption: str
    shown: Callable[[Experiment], Sequence[Comparison]]


def _with_legs(joints: Sequence[Comparison]) -> list[Comparison]:
    """Return those of legs and trunk, if there are legs."""
    shown = [one for one in joints if one.name in LEGS_AND_TRUNK]
    return shown if any(one.name == "knee" for one in shown) else []


PLOTS = (
    ComparisonPlot(
        "compared_human_arm",
        "Shoulder and elbow flexion of the person, angle and torque, predicted and recorded. Figs. 13 and 14 of the "
        "paper.",
        lambda found: [one for one in found.group("human_angle", "human_torque") if one.name in ARM],
    ),
    ComparisonPlot(
        "compared_human_legs",
        "Ankle, knee, hip and trunk flexion of a whole person, angle and torque of both legs together, predicted and "
        "recorded.",
        lambda found: _with_legs(found.group("human_angle", "human_torque")),
    ),
    ComparisonPlot(
        "compared_human_angles",
        "All joint angles of the person, predicted and recorded.",
        lambda found: found.group("human_angle"),
    ),
    ComparisonPlot(
        "compared_human_torques",
        "All joint torques of the person, predicted and from the recorded motion by inverse dynamics.",
        lambda found: found.group("human_torque"),
    ),
    ComparisonPlot(
        "compared_hand",
        "Path of the hand and its force on the object, predicted and recorded. Fig. 15 of the paper.",
        lambda found: found.group("hand_path", "hand_force"),
    ),
    ComparisonPlot(
        "compared_ground",
        "What the ground bears of a whole person: vertical force and centre of pressure, predicted and recorded.",
        lambda found: found.group("ground"),
    ),
    ComparisonPlot(
        "compared_robot_angles",
        "Joint angles of the robot, predicted and recorded. Fig. 16 of the paper.",
        lambda found: found.group("robot_angle"),
    ),
    ComparisonPlot(
        "compared_robot_torques",
        "Joint torques of the robot: predicted, the trials, and their mean. Figs. 17 and 18 of the paper.",
        lambda found: found.group("robot_torque"),
    ),
)


def drawn_comparisons(found: Experiment) -> list[tuple[ComparisonPlot, Figure]]:
    """Return the plots that there is something to show in."""
    plots = [(plot, plot.shown(found)) for plot in PLOTS]
    with rc_context(STYLE):
        return [(plot, _grid(shown)) for plot, shown in plots if shown]


def experiment_tables(found: Experiment) -> dict[str, list[list[str]]]:
    """Return the rows of every kind of quantity that was recorded, by its title."""
    tables = {title: _rows(found.group(group)) for group, title in GROUPS.items()}
    return {title: rows for title, rows in tables.items() if rows}


def _rows(comparisons: Sequence[Comparison]) -> list[list[str]]:
    """Return a row of text a comparison, its name and the columns of ``HEADER``."""
    listed = []
    for one in comparisons:
        found = one.measures
        listed.append(
            [
                one.label.partition(" (Q")[0].partition(" (\N{MINUS SIGN}Q")[0],
                one.unit,
                _number(found.peak_predicted),
                _number(found.peak_recorded),
                _number(found.peak_difference, "+.1f"),
                _number(found.rmse),
                _number(found.correlation, ".2f"),
                _number(found.phase, "+.1f"),
                _number(float(one.spread.mean())) if len(one.trials) > 1 else NOTHING,
            ]
        )
    return listed


def _grid(shown: Sequence[Comparison]) -> Figure:
    columns = min(len(shown), 2)
    count = -(-len(shown) // columns)
    figure, grid = panels(count, columns, height=1.35)
    cells = [axes for line in grid for axes in line]
    for axes, one in zip(cells, shown, strict=False):
        _panel(axes, one)
    figure.legend(*cells[0].get_legend_handles_labels(), loc="upper left", ncols=3, borderaxespad=0.4)
    for axes in cells[len(shown) :]:
        axes.axis("off")
    for axes in cells[max(len(shown) - columns, 0) : len(shown)]:
        axes.tick_params(labelbottom=True)
        axes.set_xlabel("lift completed [%]")
    return figure


def _panel(axes: Axes, one: Comparison) -> None:
    from liftopt.lab.comparison.comparison import PERCENT

    predicted, recorded = LINES[:2]
    mean, spread, trials = one.mean, one.spread, len(one.trials)
    if trials > 1:
        for number, values in enumerate(one.trials):
            axes.plot(PERCENT, values, color=FAINT, linewidth=0.7, label=None if number else "trials")
        axes.fill_between(PERCENT, mean - spread, mean + spread, color=recorded.color, alpha=0.2, linewidth=0)
    axes.plot(PERCENT, one.predicted, color=predicted.color, linestyle=predicted.linestyle, label="predicted")
    label = f"recorded, mean of {trials} \N{PLUS-MINUS SIGN} sd" if trials > 1 else "recorded, one trial"
    axes.plot(PERCENT, mean, color=recorded.color, linestyle=recorded.linestyle, label=label)
    axes.set(title=one.label, ylabel=f"{QUANTITY[one.unit]} [{one.unit}]")
    axes.set_xlim(0.0, 100.0)
    axes.set_xticks([0, 25, 50, 75, 100])
    low, high = axes.get_ylim()
    axes.set_ylim(low - 0.25 * (high - low), high)
    found = one.measures
    text = (
        f"peak {_number(found.peak_difference, '+.1f', ' %')}, RMSE {_number(found.rmse)} {one.unit}, "
        f"r {_number(found.correlation, '.2f')}, phase {_number(found.phase, '+.1f', ' %')}"
    )
    axes.annotate(
        text, (1.0, 0.03), xycoords="axes fraction", ha="right", va="bottom", fontsize=6.8, color=LIMIT,
        bbox={"boxstyle": "round,pad=0.15", "facecolor": "white", "edgecolor": "none", "alpha": 0.8},
    )  # fmt: skip


def _number(value: float, form: str = ".3g", unit: str = "") -> str:
    if not np.isfinite(value):
        return NOTHING
    shown = f"{value if abs(value) > LEAST else 0.0:{form}}"
    return (shown if float(shown) else f"{0.0:{form}}") + unit  # no negative zero
