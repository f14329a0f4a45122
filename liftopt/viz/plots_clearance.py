"""How near bodies come: the smallest distances over time, and the relative speed of person and robot."""

from __future__ import annotations

from matplotlib.figure import Figure

from liftopt.viz.plots_data import Lift
from liftopt.viz.plots_style import (
    BLUE,
    FAINT,
    GREEN,
    LINES,
    ORANGE,
    PURPLE,
    SKY,
    VERMILION,
    Line,
    draw,
    legend_above,
    panels,
    time_axes,
)

FAR = 0.6  # [m]: what never comes nearer is left out
MOST = 8  # kinds of pairs in one panel
EIGHT = tuple(
    Line(colour, dashes, marker)
    for colour, (dashes, marker) in zip(
        (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, FAINT, BLUE),
        (*(line[1:] for line in LINES), ("-", "v"), ((0, (5, 1.5)), "P"), ("-", "X"), ((0, (1.2, 1.2)), "*")),
        strict=True,
    )
)


def clearance(lift: Lift) -> Figure:
    """Return the smallest distances by kind of pair, and where there are person and robot, distance and speed."""
    found = lift.dense.clearance
    assert found is not None
    moving = found.of_kind("person-robot")
    near = sorted((kind for kind in found.kinds if kind.distance.min() < FAR), key=lambda kind: kind.distance.min())
    figure, grid = panels(1 if moving is None else 3, height=1.5)
    apart = grid[0][0]
    for kind, line in zip(near[:MOST], EIGHT, strict=False):
        label = kind.kind if "-" in kind.kind else f"within {kind.kind}"
        draw(apart, found.time, 1e3 * kind.distance, line, label, lift.factor)
    apart.axhline(0.0, color=FAINT, linewidth=0.8, zorder=1)
    apart.set(title="Smallest distance by kind of pair", ylabel="distance [mm]")
    if near:
        legend_above(apart, 4, 0.4)
    if moving is not None:
        distance, speed = grid[1][0], grid[2][0]
        draw(distance, found.time, 1e3 * moving.distance, LINES[0], knots=lift.factor)
        distance.set(title="Person and robot: smallest distance", ylabel="distance [mm]")
        draw(speed, found.time, moving.speed, LINES[1], knots=lift.factor)
        speed.set(title="Person and robot: relative speed of their nearest points", ylabel="speed [m/s]")
        for axes in (distance, speed):
            axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    time_axes(grid, float(found.time[-1]))
    return figure
