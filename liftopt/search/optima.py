"""Optima on one mesh: which are the same, and which the mesh cannot tell from the best."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from liftopt.search.candidate import Candidate
from liftopt.solution.accuracy import Accuracy

# Optima further above the best one than this are not worth a solve on a finer mesh.
PROMISING = 1.1
SAME_OPTIMUM = 1e-4  # relative difference of two objectives


def same_optimum(objective: float, other: float) -> bool:
    """Return whether two objectives on one mesh are of the same optimum."""
    return abs(objective - other) <= SAME_OPTIMUM * objective


def is_known(objective: float, candidates: Sequence[Candidate]) -> bool:
    """Return whether an optimum with that objective is among those on the same mesh."""
    return any(same_optimum(objective, candidate.result.objective) for candidate in candidates)


def each_once(candidates: Sequence[Candidate]) -> list[Candidate]:
    """Return the different optima among those on one mesh, the best first."""
    distinct: list[Candidate] = []
    for candidate in sorted(candidates, key=objective_of):
        distinct += [] if is_known(candidate.result.objective, distinct) else [candidate]
    return distinct


def indistinguishable(candidates: Sequence[Candidate], best: Candidate, accuracy: Accuracy) -> list[Candidate]:
    """Return the optima that their mesh cannot tell from the best one, the best first, each once.

    Their objectives are within the estimated error of the best one's; where there is no estimate, all are.
    """
    within = best.result.objective * (1 + (accuracy.objective_error if accuracy.estimated else np.inf))
    chosen = [best]
    for candidate in candidates:
        here = candidate.result.objective
        if candidate.result.converged and here <= within and not is_known(here, chosen):
            chosen.append(candidate)
    return chosen


def objective_of(candidate: Candidate) -> float:
    """Return the objective of a candidate, to sort by."""
    return candidate.result.objective
