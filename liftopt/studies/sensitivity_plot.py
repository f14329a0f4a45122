"""What a lift depends on as a figure: bars of what a usual change of each parameter does."""

from __future__ import annotations

from matplotlib.figure import Figure

from liftopt.studies.sensitivity import Study
from liftopt.viz.plots_style import BLUE, INK, VERMILION, WIDTH

ROW, MARGINS = 0.34, 0.9  # height of a parameter and of what is around all of them [in]


def sensitivity_figure(study: Study) -> Figure:
    """Return bars for the efforts and for the load share, greatest first; call it in ``rc_context(STYLE)``.

    Hatched bars are of parameters whose slopes are not to be relied on.
    """
    lines = sorted(study.sensitivities, key=lambda s: abs(s.slopes["objective"] * s.change))
    height = MARGINS + ROW * len(lines)
    figure = Figure(figsize=(WIDTH, height))
    figure.subplots_adjust(left=0.26, right=0.98, top=1 - 0.3 / height, bottom=0.6 / height, wspace=0.12)
    left, right = figure.subplots(1, 2, sharey=True, width_ratios=(2, 1))
    human, robot = (agent.name for agent in study.candidate.problem.team.agents)
    panels = (
        (left, (("effort " + human, BLUE, "person's effort", 0.2), ("effort " + robot, VERMILION, "robot's", -0.2))),
        (right, (("share " + human, BLUE, None, 0.0),)),
    )
    for axes, series in panels:
        for name, color, label, shift in series:
            # Efforts relative to now, shares as they are: percent, or points of percent.
            scale = 100.0 / (study.figures[name] if name.startswith("effort") else 1.0)
            values = [scale * s.slopes[name] * s.change for s in lines]
            bars = axes.barh(
                [row + shift for row in range(len(lines))], values, 0.36, color=color, label=label, alpha=0.9
            )
            for bar, sensitivity in zip(bars, lines, strict=True):
                bar.set_hatch("" if sensitivity.is_reliable else "////")
                bar.set_edgecolor("white")
        axes.axvline(0.0, color=INK, linewidth=0.8)
        axes.grid(axis="y", visible=False)
        axes.set_axisbelow(True)
    names = [f"{s.parameter.name} +{s.change:.3g} {s.parameter.unit}" for s in lines]
    left.set_yticks(range(len(lines)), names)
    left.set(title="Effort [%]", xlabel="change; hatched: not in proportion, a trend at best")
    left.legend(loc="lower right")
    right.set(title="Load the person bears", xlabel="points of percent")
    return figure
