"""How plots look: colours that colour-blind readers tell apart, line styles that survive a grey print, time axes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from liftopt.types import Array

Grid = tuple[Figure, list[list[Axes]]]

# Okabe & Ito (2008), "Color Universal Design": distinguishable with any common colour vision.
BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY = "#0072B2", "#D55E00", "#009E73", "#E69F00", "#CC79A7", "#56B4E9"
INK, FAINT, LIMIT = "#222222", "#9a9a9a", "#666666"

WIDTH = 7.2  # of a full-width figure [in]
KNOT_EVERY = 10  # points of a refined solution between two markers

STYLE: Any = {
    "font.family": "DejaVu Sans",  # comes with matplotlib
    "font.size": 8.5,
    "axes.titlesize": 9,
    "axes.titlelocation": "left",
    "axes.titley": 1.0,
    "axes.titlepad": 4,
    "axes.labelsize": 8.5,
    "axes.edgecolor": FAINT,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.unicode_minus": True,
    "grid.color": "#e4e4e4",
    "grid.linewidth": 0.6,
    "xtick.color": INK,
    "ytick.color": INK,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "legend.fontsize": 8,
    "legend.frameon": False,
    "lines.linewidth": 1.6,
    "lines.markersize": 4.0,
    "svg.fonttype": "none",
    "svg.hashsalt": "liftopt",
    "pdf.fonttype": 42,
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
}


class Line(NamedTuple):
    """How one series is drawn: no two share colour, dashes and marker."""

    color: str
    linestyle: Any
    marker: str


LINES = (
    Line(BLUE, "-", "o"),
    Line(VERMILION, (0, (5, 1.5)), "s"),
    Line(GREEN, (0, (4, 1.3, 1, 1.3)), "^"),
    Line(PURPLE, (0, (1.2, 1.2)), "D"),
)


def draw(axes: Axes, time: Array, values: Array, line: Line, label: str | None = None, knots: int = KNOT_EVERY) -> None:
    """Draw values (K,) at ``time`` (K,) [s] over percent of the lift, with a marker at every other knot."""
    axes.plot(
        percent(time), values, color=line.color, linestyle=line.linestyle, marker=line.marker, label=label,
        markevery=2 * knots, markerfacecolor="white", markeredgewidth=1.1,
    )  # fmt: skip


def percent(time: Array) -> Array:
    """Return ``time`` as percent of the lift."""
    share: Array = 100.0 * time / time[-1]
    return share


def panels(rows: int, columns: int = 1, height: float = 1.0, left: float = 0.62, right: float = 0.12) -> Grid:
    """Return a figure of full width and its grid of panels, each ``height`` high, in fixed margins [in].

    Fixed margins take half the time of a layout that matplotlib works out, and look the same every time.
    """
    top, bottom, between, beside = 0.62, 0.44, 0.36, 0.66
    total = top + bottom + rows * height + (rows - 1) * between
    simd = (WIDTH - left - right - (columns - 1) * beside) / columns
    figure = Figure(figsize=(WIDTH, total))
    figure.subplots_adjust(
        left=left / WIDTH, right=1 - right / WIDTH, top=1 - top / total, bottom=bottom / total,
        hspace=between / height, wspace=beside / simd,
    )  # fmt: skip
    grid = [list(line) for line in figure.subplots(rows, columns, sharex=True, squeeze=False)]
    for axes in (axes for line in grid for axes in line):
        axes.yaxis.set_label_coords(-0.44 / simd, 0.5)
    return figure, grid


def head(figure: Figure, text: str) -> None:
    """Write a line above all that is in a figure of ``panels``, which grows by it."""
    old, room, at = figure.get_figheight(), 0.22, figure.subplotpars
    new = old + room
    figure.set_figheight(new)
    figure.subplots_adjust(top=1 - (1 - at.top) * old / new - room / new, bottom=at.bottom * old / new)
    figure.text(0.08 / WIDTH, 1 - 0.06 / new, text, ha="left", va="top", fontsize=10, fontweight="bold", color=INK)


def legend_above(axes: Axes, columns: int, room: float = 0.22) -> None:
    """Put the legend into ``room`` made above the curves, a share of the height they take."""
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + room * (high - low))
    axes.legend(ncols=columns, loc="upper right", fontsize=7.5, borderaxespad=0.1)


def time_axes(grid: list[list[Axes]], duration: float) -> None:
    """Give panels percent of the lift below and seconds above, at the outer ones only."""
    grid[0][0].set_xlim(0.0, 100.0)  # which all share
    grid[0][0].set_xticks([0, 25, 50, 75, 100])
    for axes in grid[0]:
        above = axes.secondary_xaxis("top", functions=(_scaled(duration / 100), _scaled(100 / duration)))
        above.set_xticks([duration * part / 4 for part in range(5)])
        above.tick_params(labelsize=7, colors=LIMIT, length=2, pad=1)
        above.xaxis.set_major_formatter(lambda value, _: f"{value:.3g}")
        above.spines["top"].set_color(FAINT)
        above.set_xlabel("time [s]", fontsize=7.5, color=LIMIT, labelpad=2)
        axes.set_title(axes.get_title(loc="left"), pad=27)
    for axes in grid[-1]:
        axes.set_xlabel("lift completed [%]")


def _scaled(factor: float) -> Callable[[Any], Any]:
    return lambda values: factor * np.asarray(values)
