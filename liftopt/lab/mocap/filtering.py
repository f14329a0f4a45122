"""Low-pass filters without lag: a Butterworth filter run forth and back."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import make_interp_spline
from scipy.signal import butter, sosfiltfilt

from liftopt.errors import InputError
from liftopt.lab.mocap.gaps import runs
from liftopt.types import Array

ORDER = 2  # of one pass; both make it the fourth
SHORTEST = 10  # samples; the filter's transient is mirrored at both ends of a stretch


def low_pass(values: Array, rate: float, cutoff: float, filters: int = 1) -> Array:
    """Return ``values`` (F, ...) filtered along their first axis without lag, 3 dB down at ``cutoff``.

    Every stretch between NaNs is filtered by itself; NaNs stay, and stretches under ten samples stay as they are.

    Args:
        values: samples; a column is not a number where any of it is NaN.
        rate: samples a second [Hz].
        cutoff: [Hz].
        filters: how many such filters the signal goes through from the recording to its end; together they are 3 dB
            down.

    Raises:
        InputError: the cut-off is not between 0 and half the rate.
    """
    if not 0.0 < cutoff < 0.5 * rate:
        raise InputError("cutoff", cutoff, f"must be above 0 and below half the rate, {0.5 * rate:g} Hz")
    # All passes together may take half the power at the cut-off, so one pass is cut higher (Winter, Biomechanics and
    # Motor Control of Human Movement, 4th ed., eq. 3.9, for two of them), on the frequency scale of the bilinear
    # transform.
    higher = (2.0 ** (1.0 / (2 * filters)) - 1.0) ** (-1.0 / (2 * ORDER))
    warped = np.arctan(np.tan(np.pi * cutoff / rate) * higher) * rate / np.pi
    sections = butter(ORDER, warped, fs=rate, output="sos")
    flat = values.reshape(len(values), -1)
    filtered = flat.copy()
    for column in range(flat.shape[1]):
        for first, last in runs(np.isfinite(flat[:, column])):
            count = last - first + 1
            if count >= SHORTEST:
                reach = min(count - 1, max(SHORTEST - 1, int(rate / cutoff)))
                filtered[first : last + 1, column] = sosfiltfilt(sections, flat[first : last + 1, column], padlen=reach)
    return filtered.reshape(values.shape)


def angles_and_rates(
    time: Array, q: Array, rate: float, cutoff: float, lower: Array, upper: Array
) -> tuple[Array, Array, Array]:
    """Return filtered angles and their rates; a filter overshoots a limit that held, by what is clipped here."""
    spline = make_interp_spline(time, low_pass(q, rate, cutoff, filters=2), k=5)
    return np.clip(spline(time), lower, upper), spline.derivative(1)(time), spline.derivative(2)(time)
