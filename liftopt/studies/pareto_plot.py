"""The Pareto front of two efforts as a figure."""

from __future__ import annotations

from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator, ScalarFormatter

from liftopt.solution.effort import effort_in
from liftopt.studies.pareto import Front, Point, ratio_text, who_of
from liftopt.viz.plots_labels import label_points
from liftopt.viz.plots_style import BLUE, FAINT, INK, ORANGE, WIDTH

HEIGHT = 4.3  # [in]
EVEN, MANY = 3.0, 9.0  # ratios of an axis' ends: below, even steps; above, of a decade's numbers only 2 and 5


def pareto_figure(front: Front) -> Figure:
    """Return the front on logarithmic axes, points with their weights; call it in ``rc_context(STYLE)``."""
    figure = Figure(figsize=(WIDTH, HEIGHT))
    figure.subplots_adjust(left=0.1, right=0.97, top=0.93, bottom=0.12)
    axes = figure.subplots()
    one, other = (who_of(front, name) for name in front.between)
    ours, theirs = zip(*(point.efforts for point in front.points), strict=True)
    axes.plot(ours, theirs, color=BLUE, marker="o", markerfacecolor="white", markeredgewidth=1.3, zorder=3)
    if front.dominated:
        axes.plot(
            *zip(*(point.efforts for point in front.dominated), strict=True),
            color=FAINT, linestyle="none", marker="x", label="beaten in both efforts",
        )  # fmt: skip
    now = front.scenario.agents[front.between[0]].weight
    own = [p for p in front.points if abs(p.weights[0] - now) <= 1e-9 * (1 + now)]
    for point in own:
        axes.plot(
            *point.efforts, color=ORANGE, linestyle="none", marker="o", markersize=8, zorder=4,
            label="weights of the scenario",
        )  # fmt: skip
    effort = effort_in(front.scenario)
    measure = f"{effort.formula} [{effort.signs}]"
    axes.set(xscale="log", yscale="log", xlabel=f"effort of {one.called}, {measure}")
    axes.set_ylabel(f"effort of {other.called}, {measure}")
    axes.set_title(
        f"{front.scenario.name}: who works more. At the points: weights {one.label} : {other.label}, load {one.called} "
        "bears"
    )
    axes.margins(x=0.14, y=0.1)
    for axis, limits in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
        _mark(axis, limits[1] / limits[0])
    if front.dominated or own:
        axes.legend(loc="upper right")
    # Those that tell most first: where there are many points, not all labels find room.
    first = [*own, front.points[0], front.points[-1]]
    order = sorted(front.points, key=lambda point: point not in first)
    at, texts = [point.efforts for point in order], [_label(point) for point in order]
    curve = [point.efforts for point in front.points]
    label_points(axes, at, texts, curve, fontsize=7.5, color=INK)
    return figure


def _mark(axis: Axis, ratio: float) -> None:
    """Give a logarithmic axis numbers that do not run into each other; ``ratio`` of its greatest to its least."""
    axis.set_major_formatter(ScalarFormatter())
    if ratio < EVEN:
        axis.set_major_locator(MaxNLocator(5))
        axis.set_minor_locator(NullLocator())
        return
    axis.set_minor_locator(LogLocator(subs=(2.0, 5.0) if ratio > MANY else tuple(map(float, range(2, 10)))))
    axis.set_minor_formatter(ScalarFormatter())


def _label(point: Point) -> str:
    return f"{ratio_text(point.weights)}, {100 * point.share:.0f} %"
