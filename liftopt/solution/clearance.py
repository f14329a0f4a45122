"""How far bodies keep apart over a lift, as a solution carries it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from liftopt.multibody.solid_pairs import SolidPair
from liftopt.types import Array

WITHIN_BODIES = ("person", "robot")  # kinds of pairs whose solids are one body's


@dataclass(frozen=True)
class PairClearance:
    """How near two solids come.

    Attributes:
        pair: the two.
        distance: the smallest [m]; below 0 they overlap, and it is how deep.
        time: when [s].
        points: (2, 3) closest points on the one and the other in the world [m].
    """

    pair: SolidPair
    distance: float
    time: float
    points: Array


@dataclass(frozen=True)
class KindClearance:
    """The nearest pair of one kind at K times.

    Attributes:
        kind: of the pairs, ``"person-robot"``; see ``SolidPair``. Empty where pairs of several kinds stand in.
        distance: (K,) smallest of the kind [m]; below 0 the two overlap.
        pair: (K,) which pair it is, an index into ``Clearance.pairs``.
        points: (K, 2, 3) its closest points in the world [m].
        speed: (K,) relative speed of these two points, each fixed to its solid [m/s].
    """

    kind: str
    distance: Array = field(repr=False)
    pair: npt.NDArray[np.int64] = field(repr=False)
    points: Array = field(repr=False)
    speed: Array = field(repr=False)


@dataclass(frozen=True)
class Clearance:
    """How far bodies keep apart at K times, ten a mesh interval, by coal.

    A line between the closest points of the nearest two bodies is drawn by::

        nearest = solution.clearance.between_bodies
        k = np.searchsorted(solution.clearance.time, now)
        nearest.points[k]  # (2, 3), from the one to the other

    Attributes:
        time: (K,) [s].
        pairs: all pairs that must keep apart, indexed by ``KindClearance.pair``.
        kinds: the nearest pair over time, one entry a kind.
        closest: the smallest distance of each pair that comes near, and of the nearest pair of each kind; the nearest
            first.
    """

    time: Array = field(repr=False)
    pairs: tuple[SolidPair, ...] = field(repr=False)
    kinds: tuple[KindClearance, ...]
    closest: tuple[PairClearance, ...]

    @property
    def smallest(self) -> PairClearance | None:
        """The pair that comes nearest; None where nothing must keep apart."""
        return self.closest[0] if self.closest else None

    @property
    def between_bodies(self) -> KindClearance | None:
        """The nearest pair of two bodies over time, pairs within one body left out; None where there is none."""
        kinds = [kind for kind in self.kinds if kind.kind not in WITHIN_BODIES]
        if not kinds:
            return None
        first, times = np.argmin([kind.distance for kind in kinds], axis=0), np.arange(len(self.time))
        distance, pair, points, speed = (
            np.array([getattr(kind, name) for kind in kinds])[first, times]
            for name in ("distance", "pair", "points", "speed")
        )
        return KindClearance("", distance, pair, points, speed)

    def of_kind(self, kind: str) -> KindClearance | None:
        """Return the nearest pair of a kind over time; None if there is none."""
        return next((item for item in self.kinds if item.kind == kind), None)

    def closest_of(self, kind: str) -> PairClearance | None:
        """Return the pair of a kind that comes nearest; None if there is none."""
        return next((item for item in self.closest if item.pair.kind == kind), None)
