"""The Pareto front of human against robot effort as a figure."""

from __future__ import annotations

from matplotlib.figure import Figure
from matplotlib.ticker import LogFormatter, ScalarFormatter

from liftopt.pareto import Front, Point
from liftopt.viz.plots_style import BLUE, FAINT, INK, ORANGE, WIDTH

HEIGHT = 4.3  # [in]


def pareto_figure(front: Front) -> Figure:
    """Return the front on logarithmic axes, each point with its weights; call it in ``rc_context(STYLE)``."""
    figure = Figure(figsize=(WIDTH, HEIGHT))
    figure.subplots_adjust(left=0.1, right=0.97, top=0.93, bottom=0.12)
    axes = figure.subplots()
    human, robot = zip(*(point.efforts for point in front.points), strict=True)
    axes.plot(human, robot, color=BLUE, marker="o", markerfacecolor="white", markeredgewidth=1.3, zorder=3)
    if front.dominated:
        axes.plot(
            *zip(*(point.efforts for point in front.dominated), strict=True),
            color=FAINT, linestyle="none", marker="x", label="beaten in both efforts",
        )  # fmt: skip
    now = front.scenario.objective
    own = [p for p in front.points if abs(p.weights[0] - now.human_weight) <= 1e-9 * (1 + now.human_weight)]
    for point in own:
        axes.plot(
            *point.efforts, color=ORANGE, linestyle="none", marker="o", markersize=8, zorder=4,
            label="weights of the scenario",
        )  # fmt: skip
    for point in front.points:
        axes.annotate(_label(point), point.efforts, xytext=(6, 5), textcoords="offset points", fontsize=7.5, color=INK)
    axes.set(xscale="log", yscale="log", xlabel="effort of the person, ∫ Σ τ² dt [N² m² s]")
    axes.set_ylabel("effort of the robot, ∫ Σ τ² dt [N² m² s]")
    axes.set_title(
        f"{front.scenario.name}: who works more. At the points: weights person : robot, load the person bears"
    )
    axes.margins(x=0.14, y=0.1)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(ScalarFormatter())
        axis.set_minor_formatter(LogFormatter(minor_thresholds=(2, 0.5)))
    if front.dominated or own:
        axes.legend(loc="upper right")
    return figure


def _label(point: Point) -> str:
    human, robot = point.weights
    ratio = f"{human / robot:.3g} : 1" if human >= robot else f"1 : {robot / human:.3g}"
    return f"{ratio}, {100 * point.share:.0f} %"
