"""The plot of solve time against the number of intervals."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib
import numpy as np

STYLES = {"ipopt": ("IPOPT with MUMPS", "o", "#7a7a7a"), "banded": ("banded", "s", "#0b6e99")}


def plot_scaling(details: dict[str, Any], path: Path) -> None:
    """Draw the times of a ``scaling`` row; a dashed line goes through the first point of each with slope 1."""
    matplotlib.use("Agg")
    from matplotlib import pyplot
    from matplotlib.ticker import NullFormatter, ScalarFormatter

    meshes = np.array(details["N"], dtype=float)
    figure, axes = pyplot.subplots(figsize=(6.0, 4.0), layout="constrained")
    for name in filter(details.__contains__, STYLES):
        label, marker, colour = STYLES[name]
        times = np.array(details[name]["ms"])
        axes.loglog(meshes, times, marker=marker, color=colour, label=label)
        axes.loglog(meshes, times[0] * meshes / meshes[0], "--", color=colour, linewidth=0.8)
        for n, ms, iterations in zip(meshes, times, details[name]["iterations"], strict=True):
            axes.annotate(f"{iterations} it.", (n, ms), (0, 6), textcoords="offset points", ha="center", fontsize=7)
    stepwise = details["banded"]["stepwise_ms"]
    axes.loglog(meshes, stepwise, marker="^", color="#c8553d", label="banded, from mesh to mesh")
    axes.set_xticks(meshes)
    axes.xaxis.set_major_formatter(ScalarFormatter())
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_xlabel("intervals N")
    axes.set_ylabel("from the same start to the optimum [ms]")
    axes.legend(title="dashed: linear in N")
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path)
    pyplot.close(figure)
