"""A solution, seen: playback, plots and report. Imports solutions, never the solver."""

FORMATS = ("svg", "png", "pdf")  # of figures
