"""What stands may stand wrong, a pedestal in a pallet or feet in a wall: no motion mends that."""

from __future__ import annotations

import numpy as np

from liftopt.collocation.problem import Problem
from liftopt.collocation.separating_planes import WORLD
from liftopt.search.infeasibility import MOST_REASONS
from liftopt.search.make_clear import WATCHED
from liftopt.search.session import Session
from liftopt.search.solid_distances import solid_distances
from liftopt.solution.checks import TOUCH
from liftopt.solution.infeasibility_report import InfeasibilityReason


def standing_overlaps(session: Session, problem: Problem) -> tuple[InfeasibilityReason, ...]:
    """Return which bodies that stand are too near each other, the nearest first; none with clearance off."""
    clearer = session.clearer(problem)
    if clearer is None:
        return ()
    solids = clearer.solids
    part = np.array([body.part for body in solids.bodies])
    standing = np.flatnonzero((part[solids.ends] == WORLD).all(axis=1))
    if not len(standing):
        return ()
    anywhere = np.zeros((1, problem.layout.control.shape[1]))
    distance = solid_distances(solids, problem, anywhere, clearer.clearance + WATCHED, standing).distance[0]
    short = clearer.asked - distance
    wrong = [pair for pair in np.argsort(-short) if short[pair] > TOUCH]
    return tuple(
        InfeasibilityReason(
            "clearance", told := solids.pairs[pair].told, amount := float(short[pair]), "m",
            f"{told} come {amount:.3f} m too near each other where they stand", static=True,
        )
        for pair in wrong[:MOST_REASONS]
    )  # fmt: skip
