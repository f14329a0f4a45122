"""Predicted and recorded curves over the same lift, and how far apart they are (Figs. 13 to 18)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from liftopt.types import Array

SAMPLES = 201  # of the normalised time: every 0.5 % of the lift
# Percent of the lift. Sawyer's velocity mode is late by up to 1 / kp = 0.5 s, a quarter of a lift of 2 s.
LONGEST_LAG = 35.0
RELATED = 0.8  # correlation below which even the best shift is none: the curves differ in shape
SHARE = np.linspace(0.0, 1.0, SAMPLES)
PERCENT = 100.0 * SHARE
FLAT = 1e-9  # a curve that varies by less, as a share of the larger of two, is constant


@dataclass(frozen=True)
class Measures:
    """How a predicted curve differs from the mean of the recorded ones; NaN where a measure says nothing.

    Attributes:
        peak_recorded: value of the recorded mean that is largest in magnitude.
        peak_predicted: the predicted extreme on the same side of zero.
        peak_difference: the predicted peak less the recorded one, in percent of the recorded; above 0 where the
            prediction is the larger. The paper (section 4) gives "peak value differences" in percent without a formula
            and without a sign; that of the record is taken as the whole, and its figures are magnitudes of this. Where
            the two peaks are does not matter, and for an angle it depends on where the model has its zero.
        rmse: root mean square of the difference over the lift.
        correlation: Pearson's, over the lift.
        phase: by how much the record is late, in percent of the lift: the shift within +-35 % at which the overlapping
            parts correlate best. NaN for constant curves, where the best shift is at the end of that range (curves that
            only rise have no phase), and where they correlate by less than 0.8 even then.
    """

    peak_recorded: float
    peak_predicted: float
    peak_difference: float
    rmse: float
    correlation: float
    phase: float


@dataclass(frozen=True)
class Comparison:
    """One quantity over the lift, at the shares ``SHARE`` (S,) of its duration.

    Attributes:
        group: kind of quantity, ``"human_angle"``.
        name: short name within the group, ``"Q7"``.
        label: for a reader, ``"Elbow flexion (-Q7)"``.
        unit: of the values.
        predicted: (S,).
        trials: (T, S) recorded, one row a trial.
    """

    group: str
    name: str
    label: str
    unit: str
    predicted: Array
    trials: Array

    @property
    def mean(self) -> Array:
        """(S,) over the trials."""
        return np.asarray(self.trials.mean(axis=0), float)

    @property
    def spread(self) -> Array:
        """(S,) standard deviation over the trials; 0 for one trial, which shows none."""
        if len(self.trials) == 1:
            return np.zeros(self.trials.shape[1])
        return np.asarray(self.trials.std(axis=0, ddof=1), float)

    @cached_property
    def measures(self) -> Measures:
        """How far apart they are."""
        return measures(self.predicted, self.mean)


def measures(predicted: Array, recorded: Array) -> Measures:
    """Return how two curves (S,) over the same lift differ."""
    at = int(np.argmax(np.abs(recorded)))
    side = 1.0 if recorded[at] >= 0.0 else -1.0
    peak_recorded, peak_predicted = float(recorded[at]), side * float((side * predicted).max())
    whole = peak_recorded or np.nan
    return Measures(
        peak_recorded=peak_recorded,
        peak_predicted=peak_predicted,
        peak_difference=100.0 * (peak_predicted - peak_recorded) / whole,
        rmse=float(np.sqrt(np.mean((predicted - recorded) ** 2))),
        correlation=_correlation(predicted, recorded),
        phase=_phase(predicted, recorded),
    )


def _correlation(left: Array, right: Array) -> float:
    if min(np.ptp(left), np.ptp(right)) <= FLAT * max(np.abs(left).max(), np.abs(right).max()):
        return float("nan")
    return float(np.corrcoef(left, right)[0, 1])


def _phase(predicted: Array, recorded: Array) -> float:
    count = len(predicted)
    most = round(LONGEST_LAG / 100.0 * (count - 1))
    lags = range(-most, most + 1)
    fits = [
        _correlation(predicted[max(-lag, 0) : count - max(lag, 0)], recorded[max(lag, 0) : count - max(-lag, 0)])
        for lag in lags
    ]
    if np.isnan(fits).all():
        return float("nan")
    best = int(np.nanargmax(fits))
    if abs(lags[best]) == most or fits[best] < RELATED:
        return float("nan")
    return 100.0 * lags[best] / (count - 1)
