"""The default lift at five moments, as the report has it."""

from __future__ import annotations

from matplotlib.figure import Figure

from drawings.stage import default_lift
from liftopt.viz.plots_data import Lift
from liftopt.viz.plots_snapshots import snapshots


def lift() -> Figure:
    """Return the snapshots of the default lift."""
    return snapshots(Lift.of(default_lift()))
