"""One ergonomic measure as a reader should take it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from liftopt.multibody.sources import Source

Scope = Literal["applies", "indicative", "out of scope"]


@dataclass(frozen=True)
class Measure:
    """One measure.

    Attributes:
        code: a word for it.
        name: of the method.
        scope: whether it applies to this lift.
        result: in one line.
        reading: what the result says, or why there is none.
        source: of the method and its tables.
        value: the result as a number, if there is one.
        limit: the method's own limit on it; None where it has none for this lift.
        unit: of both.
        time: of the value [s]; None where it is not of one moment.
    """

    code: str
    name: str
    scope: Scope
    result: str
    reading: str
    source: Source
    value: float | None = None
    limit: float | None = None
    unit: str = ""
    time: float | None = None
