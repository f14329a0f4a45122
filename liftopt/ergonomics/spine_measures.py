"""What the load on the lumbar spine is compared with: a limit on compression, and one on shear."""

from __future__ import annotations

import numpy as np

from liftopt.ergonomics.measure import Measure
from liftopt.ergonomics.spine import SHEAR_FREQUENT, SHEAR_LIMIT, SHEAR_SOURCE, SpineLoad
from liftopt.multibody.person.lumbar_levers import (
    COMPRESSION_LIMIT,
    COMPRESSION_MOST,
    COMPRESSION_SOURCE,
    EXTENSOR,
    LONG_EXTENSOR,
)
from liftopt.multibody.person.lumbosacral import SACRAL_SLOPE
from liftopt.types import Array


def spine_measures(load: SpineLoad, time: Array) -> tuple[Measure, ...]:
    """Return compression and shear at L5/S1 at their largest; ``time`` is (K,) [s]."""
    return _compression(load, time), _shear(load, time)


def _compression(load: SpineLoad, time: Array) -> Measure:
    compression = load.compression
    k = int(np.argmax(compression))
    peak, long = float(compression[k]), float(load.compression_at(LONG_EXTENSOR)[k])
    above = (
        "" if peak <= COMPRESSION_MOST else f" It is above the maximum permissible limit of {COMPRESSION_MOST:g} N too."
    )
    return Measure(
        "spine_compression",
        "NIOSH action limit on L5/S1 compression",
        "indicative",
        f"{peak:.0f} N at most, with a net moment of {load.extension[k]:.0f} Nm to hold the trunk up",
        f"An estimate with one muscle, {100 * EXTENSOR:g} cm behind the disc ({long:.0f} N with "
        f"{100 * LONG_EXTENSOR:g} cm, the longest in use).{above} Muscles that work against each other are not in it; "
        "they can add up to 45 %.",
        COMPRESSION_SOURCE,
        value=peak,
        limit=COMPRESSION_LIMIT,
        unit="N",
        time=float(time[k]),
    )


def _shear(load: SpineLoad, time: Array) -> Measure:
    shear = load.shear_size
    k = int(np.argmax(shear))
    return Measure(
        "spine_shear",
        "Gallagher and Marras limit on L5/S1 shear",
        "indicative",
        f"{shear[k]:.0f} N at most",
        f"Of the net force, along a disc that is inclined by {SACRAL_SLOPE:g}° where the pelvis is upright; muscles "
        f"across the disc are left out. The limit is for up to 100 times a day, {SHEAR_FREQUENT:g} N for up to 1000.",
        SHEAR_SOURCE,
        value=float(shear[k]),
        limit=SHEAR_LIMIT,
        unit="N",
        time=float(time[k]),
    )
