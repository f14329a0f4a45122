"""Scores of a posture by an observer's method, over time and side by side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from liftopt.types import Array

Scores = npt.NDArray[np.int64]


@dataclass(frozen=True)
class PostureScores:
    """Scores (K,) of the steps of a method with one arm, whose fields are its steps.

    Attributes:
        side: of the arm, ``"right"`` or ``"left"``.
        grand: the result.
    """

    side: str
    grand: Scores

    def at(self, k: int) -> dict[str, int]:
        """Return all scores of time ``k`` by name."""
        return {field.name: int(getattr(self, field.name)[k]) for field in fields(self) if field.name != "side"}

    @property
    def worst(self) -> int:
        """The index of the first time with the highest grand score."""
        return int(np.argmax(self.grand))


AnyScores = TypeVar("AnyScores", bound=PostureScores)


def worse_side(sides: Sequence[AnyScores]) -> AnyScores:
    """Return the scores of the worse side: by the highest grand score, then by the mean; the first if equal."""
    return max(sides, key=lambda scores: (int(scores.grand.max()), float(scores.grand.mean())))


def bands(values: Array, ends: tuple[float, ...]) -> Scores:
    """Return 1 up to the first of ``ends``, 2 up to the second, and so on."""
    return 1 + np.searchsorted(np.array(ends), values, side="left")
