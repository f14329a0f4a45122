"""The load on the lumbar spine over the lift: compression, shear and net moments at L5/S1, beside their limits."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from liftopt.assessment.who import who_is
from liftopt.ergonomics.measures import ergonomics_of
from liftopt.ergonomics.spine import SHEAR_FREQUENT, SHEAR_LIMIT
from liftopt.multibody.person.lumbar_levers import COMPRESSION_LIMIT, COMPRESSION_MOST, EXTENSOR, LONG_EXTENSOR
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.viz.plots_data import Lift
from liftopt.viz.plots_style import FAINT, INK, LINES, VERMILION, draw, legend_above, panels, percent, time_axes

IN_SIGHT = 0.6  # a limit is drawn where a curve comes to this share of it, or where it is the first one


def spine_load(lift: Lift, agent: AgentTrajectory) -> Figure:
    """Return compression, shear and moments at L5/S1 of a person over time."""
    solution = lift.dense
    load, time, knots = ergonomics_of(solution, agent).spine, solution.time, lift.factor
    figure, grid = panels(3, height=1.4)
    pressing, sliding, moments = (line[0] for line in grid)
    compression, least = load.compression, load.compression_at(LONG_EXTENSOR)
    pressing.fill_between(
        percent(time), least, compression, color=FAINT, alpha=0.30, linewidth=0,
        label=f"muscle {100 * EXTENSOR:g} to {100 * LONG_EXTENSOR:g} cm behind the disc",
    )  # fmt: skip
    draw(pressing, time, compression, LINES[0], "compression", knots)
    draw(sliding, time, load.shear, LINES[0], "to the front", knots)
    draw(sliding, time, load.side_shear, LINES[1], "to the left", knots)
    for name, values, line in zip(
        ("extension", "bend to the right", "turn to the left"),
        (load.extension, load.lateral, load.twist),
        LINES,
        strict=False,
    ):
        draw(moments, time, values, line, name, knots)
    _limits(
        pressing,
        float(compression.max()),
        (COMPRESSION_LIMIT, COMPRESSION_MOST),
        ("action limit", "maximum permissible"),
    )
    if asked := solution.scenario.limits.spine_compression:
        pressing.axhline(asked, color=INK, linewidth=1.0, linestyle=(0, (1, 2)), zorder=1)
        pressing.annotate(
            f"limit of this lift {asked:g} N", (99.0, asked), (0, -2), textcoords="offset points", ha="right", va="top",
            fontsize=7, color=INK,
        )  # fmt: skip
    _limits(
        sliding, float(load.shear_size.max()), (SHEAR_FREQUENT, SHEAR_LIMIT), ("up to 1000 times a day", "up to 100")
    )
    pressing.set(title=f"Compression of L5/S1 of {who_is(agent, solution.agents).called}, estimate", ylabel="force [N]")
    sliding.set(title="Shear", ylabel="force [N]")
    moments.set(title="Net moment", ylabel="moment [Nm]")
    for axes in (sliding, moments):
        axes.axhline(0.0, color=FAINT, linewidth=0.8, zorder=1)
    for axes, columns in ((pressing, 2), (sliding, 2), (moments, 3)):
        legend_above(axes, columns, 0.3)
    time_axes(grid, float(time[-1]))
    return figure


def _limits(axes: Axes, peak: float, limits: tuple[float, float], words: tuple[str, str]) -> None:
    """Draw the first limit, and the second where the curve comes near it."""
    for i, (limit, word) in enumerate(zip(limits, words, strict=True)):
        if i == 0 or peak > IN_SIGHT * limit:
            axes.axhline(limit, color=VERMILION, linewidth=1.0, linestyle=(0, (6, 2)), zorder=1)
            axes.text(99.0, limit, f"{word} {limit:g} N", ha="right", va="bottom", fontsize=7, color=INK)
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, 0.0), high)
