"""What a lift depends on as a figure: bars of what a usual change of each parameter does."""

from __future__ import annotations

from itertools import cycle

from matplotlib.figure import Figure

from liftopt.assessment.who import who_is
from liftopt.studies.sensitivity import Study, bearers
from liftopt.viz.plots_style import INK, LINES, WIDTH

ROW, MARGINS = 0.34, 0.9  # height of a parameter and of what is around all of them [in]
THICK = 0.36  # of a bar, at most, as a share of its row


def sensitivity_figure(study: Study) -> Figure:
    """Return bars for the efforts and for the load share, greatest first; call it in ``rc_context(STYLE)``.

    Hatched bars are of parameters whose slopes are not to be relied on.
    """
    lines = sorted(study.sensitivities, key=lambda s: abs(s.slopes["objective"] * s.change))
    height = MARGINS + ROW * len(lines)
    figure = Figure(figsize=(WIDTH, height))
    figure.subplots_adjust(left=0.26, right=0.98, top=1 - 0.3 / height, bottom=0.6 / height, wspace=0.12)
    left, right = figure.subplots(1, 2, sharey=True, width_ratios=(2, 1))
    agents, bearing = study.candidate.problem.team.agents, bearers(study)
    told = {agent.name: who_is(agent, agents) for agent in agents}
    colors = {agent.name: line.color for agent, line in zip(agents, cycle(LINES), strict=False)}
    panels = ((left, "effort", list(told)), (right, "share", bearing))
    for axes, quantity, names in panels:
        step = 0.8 / len(names)
        for i, name in enumerate(names):
            figured, shift = f"{quantity} {name}", step * ((len(names) - 1) / 2 - i)
            label = f"{told[name].label}'s" + (" effort" if i == 0 and quantity == "effort" else "")
            # Efforts relative to now, shares as they are: percent, or points of percent.
            scale = 100.0 / (study.figures[figured] if quantity == "effort" else 1.0)
            values = [scale * s.slopes[figured] * s.change for s in lines]
            rows, thick = [row + shift for row in range(len(lines))], min(THICK, 0.9 * step)
            bars = axes.barh(rows, values, thick, color=colors[name], label=label, alpha=0.9)
            for bar, sensitivity in zip(bars, lines, strict=True):
                bar.set_hatch("" if sensitivity.is_reliable else "////")
                bar.set_edgecolor("white")
        axes.axvline(0.0, color=INK, linewidth=0.8)
        axes.grid(axis="y", visible=False)
        axes.set_axisbelow(True)
    changes = [f"{s.parameter.name} +{s.change:.3g} {s.parameter.unit}" for s in lines]
    left.set_yticks(range(len(lines)), changes)
    left.set(title="Effort [%]", xlabel="change; hatched: not in proportion, a trend at best")
    left.legend(loc="lower right")
    whose = told[bearing[0]].called if len(bearing) == 1 else "each"
    right.set(title=f"Load {whose} bears", xlabel="points of percent")
    if len(bearing) > 1:
        right.legend(loc="lower right")
    return figure
