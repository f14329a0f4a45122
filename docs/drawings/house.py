"""How data flows through the rooms of the code."""

from __future__ import annotations

from itertools import pairwise

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch

from drawings.stage import arrow, bare
from liftopt.viz.plots_style import BLUE, GREEN, INK, LIMIT, ORANGE

WIDE, HIGH = 1.62, 0.56
# Room or thing, place, what stands below its name.
ROOMS: dict[str, tuple[float, float, str]] = {
    "scenario": (0.0, 3.0, "what is asked"),
    "multibody": (2.1, 3.0, "who lifts, and what"),
    "collocation": (4.2, 3.0, "the problem"),
    "search": (6.3, 3.0, "starts, meshes, choice"),
    "solution": (8.4, 3.0, "what was found"),
    "banded": (4.2, 4.1, "interior point, C++"),
    "pinocchio_casadi": (6.3, 4.1, "equations on symbols"),
    "assessment": (8.4, 1.9, "what it means"),
    "ergonomics": (6.3, 1.9, "measures and sources"),
    "storage": (6.3, 0.8, "solution.nc"),
    "viz": (8.4, 0.8, "scene, plots, report"),
    "lab": (4.2, 0.8, "robot, mocap, forces"),
    "studies": (2.1, 1.9, "many lifts"),
    "control": (4.2, 1.9, "lift after lift"),
    "crosscheck": (2.1, 0.8, "independent checks"),
    "face": (0.0, 4.1, "import liftopt"),
    "commands": (0.0, 1.9, "the command line"),
    "files": (0.0, 0.8, "whole files, safely"),
}
AROUND = ("face", "commands", "files")
MAIN = ("scenario", "multibody", "collocation", "search", "solution")
FLOWS = (
    *pairwise(MAIN),
    ("banded", "collocation"),
    ("pinocchio_casadi", "collocation"),
    ("solution", "assessment"),
    ("ergonomics", "assessment"),
    ("assessment", "viz"),
)


def house() -> Figure:
    """Return the rooms; data flows along the first row, and from its end to those who use it."""
    figure = Figure(figsize=(8.8, 4.3))
    axes = figure.subplots()
    figure.subplots_adjust(left=0.005, right=0.995, top=0.995, bottom=0.005)
    for name, (x, y, what) in ROOMS.items():
        color = BLUE if name in MAIN else LIMIT if name in AROUND else GREEN if y > 3 else ORANGE
        _room(axes, name, what, x, y, color)
    for start, end in FLOWS:
        _flow(axes, ROOMS[start][:2], ROOMS[end][:2])
    words = ("Scenario", "agents, object, task", "problem", "candidate")
    for (start, end), word in zip(pairwise(MAIN), words, strict=True):
        axes.text((ROOMS[start][0] + ROOMS[end][0]) / 2, 3.36, word, ha="center", fontsize=7, color=INK, style="italic")
    key = "Blue: the way of a lift. Green: what it is computed with. Orange: who uses solutions. Grey: around them."
    axes.text(-0.8, 0.2, key, fontsize=8, color=LIMIT)
    axes.set(xlim=(-0.9, 9.3), ylim=(0.1, 4.5))
    bare(axes)
    return figure


def _room(axes: Axes, name: str, what: str, x: float, y: float, color: str) -> None:
    box = (x - WIDE / 2, y - HIGH / 2)
    axes.add_patch(FancyBboxPatch(box, WIDE, HIGH, boxstyle="round,pad=0,rounding_size=0.08", facecolor="white",
                                  edgecolor=color, linewidth=1.6))  # fmt: skip
    axes.text(x, y + 0.08, name, ha="center", va="center", fontsize=9, fontweight="bold", color=INK)
    axes.text(x, y - 0.14, what, ha="center", va="center", fontsize=7.2, color=LIMIT)


def _flow(axes: Axes, start: tuple[float, float], end: tuple[float, float]) -> None:
    (x, y), (u, v) = start, end
    if y == v:
        arrow(axes, (x + WIDE / 2, y), (u - WIDE / 2, v))
    else:
        arrow(axes, (x, y - HIGH / 2), (u, v + HIGH / 2))
