"""Plots as SVG inside a page."""

from __future__ import annotations

import re
from dataclasses import dataclass
from html import escape

from matplotlib.figure import Figure

from liftopt.viz.plots import drawn, plots_of, rendered
from liftopt.viz.plots_data import Lift
from liftopt.viz.report_section import ReportSection

# The second is as wide as the first, which few readers have; any other would shift the labels.
FONTS = "'DejaVu Sans', Verdana, Geneva, sans-serif"


@dataclass(frozen=True)
class InlineFigure:
    """One plot of the report: its name, what it shows, and its ``<svg>`` element."""

    name: str
    caption: str
    svg: str


def inline_figures(lift: Lift) -> dict[str, InlineFigure]:
    """Return all plots by name."""
    return {plot.name: _inline(plot.name, plot.caption, drawn(plot, lift)) for plot in plots_of(lift)}


def section_figures(section: ReportSection) -> dict[str, InlineFigure]:
    """Return the figures of an added section by name."""
    return {item.name: _inline(item.name, item.caption, item.figure) for item in section.figures}


def _inline(name: str, caption: str, figure: Figure) -> InlineFigure:
    """Return the element without prolog and size, with ids that no other figure of the page has."""
    svg = rendered(figure, "svg").decode()
    svg = svg[svg.index("<svg") :]
    for dropped in (r"<metadata>.*?</metadata>", r"<style.*?</style>"):
        svg = re.sub(dropped, "", svg, flags=re.DOTALL)
    for link in ('id="', "url(#", 'href="#'):
        svg = svg.replace(link, f"{link}{name}-")
    svg = svg.replace("'DejaVu Sans'", FONTS)
    head, rest = svg.split(">", 1)
    (view,) = re.findall(r'viewBox="[^"]*"', head)
    start = f'<svg xmlns:xlink="http://www.w3.org/1999/xlink" {view} role="img" aria-label="{escape(caption)}">'
    return InlineFigure(name, caption, start + rest)
