"""The experiment as a section of the report of its lift."""

from __future__ import annotations

from liftopt.lab.comparison.experiment import Experiment
from liftopt.lab.comparison.plots import drawn_comparisons, experiment_tables
from liftopt.viz.report_section import ReportSection, SectionFigure, SectionTable

COLUMNS = (
    "unit",
    "predicted peak",
    "recorded peak",
    "differs [%]",
    "RMSE",
    "correlation",
    "phase [%]",
    "spread",
)
TEXT = (
    "Recordings of this lift beside its prediction, each over its own duration from 0 to 100 %. The peaks are those of "
    "the prediction and of the recorded mean, and how much the first differs from the second in percent of it; phase "
    "is by how much the record is late, in percent of the lift; spread is the standard deviation over the trials, "
    "averaged over the lift."
)


def experiment_section(found: Experiment) -> ReportSection:
    """Return tables and plots of an experiment, with what to know of the recordings."""
    return ReportSection(
        name="experiment",
        title="Experiment",
        holds="what was measured",
        text=TEXT,
        tables=tuple(
            SectionTable((title, *COLUMNS), rows, words=2) for title, rows in experiment_tables(found).items()
        ),
        figures=tuple(SectionFigure(plot.name, plot.caption, figure) for plot, figure in drawn_comparisons(found)),
        notes_title="What to know of the recordings",
        notes=found.notes,
    )
