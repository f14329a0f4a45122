"""Motions along clear static postures: the object led from one end to the other, each posture begun from the last.

A blend of two postures takes arms through what they hold and thighs through what they pass. Where each posture is only
a little off the last, planes keep it clear by a few iterations. The object's place is free where the task leaves it
free, so that it moves out ahead where knees are in the way.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from liftopt.collocation.layout import OBJECT_SIZE
from liftopt.collocation.problem import Problem
from liftopt.collocation.spline import RestToRestSpline
from liftopt.collocation.transfer import nearest
from liftopt.search.clear_still import ClearStill
from liftopt.search.initial_guess import InitialGuess
from liftopt.search.make_clear import Clearer
from liftopt.search.moves import quintic
from liftopt.search.postures import Posture
from liftopt.search.session import Session
from liftopt.search.turned_farther import with_turn
from liftopt.types import Array

FROM_EACH_END = 4  # postures that are led to the other end
FINER = 2  # postures for each interval
HALVINGS = 3  # of a step that leads to no clear posture


def paths_between(
    session: Session, clearer: Clearer, problem: Problem, spline: RestToRestSpline, farther: float = 0.0
) -> Iterator[InitialGuess]:
    """Yield motions of a problem along clear postures, from those at its ends in turns, the cheapest first.

    Args:
        session: of the search, with clear postures at an end or at both; without them there are none.
        clearer: of the team.
        problem: the lift, on any mesh.
        spline: its space of motions.
        farther: by how much hands may turn farther on the object than the scenario allows [rad].
    """
    if not session.held:
        return
    still = ClearStill(clearer, with_turn(session.postures.problem, farther))
    phase = np.linspace(0.0, 1.0, FINER * spline.intervals + 1)
    ends = ("start", problem.task.start), ("end", problem.task.end)
    for n in range(FROM_EACH_END):
        for held, (name, begin), (_, finish) in zip(session.held, ends, reversed(ends), strict=True):
            if held.reasons or n >= len(held.postures) or clearer.deadline.passed:
                continue
            way = _followed(still, held.postures[n], begin, finish, quintic(phase))
            if way is None:
                continue
            way = way if name == "start" else way[::-1]
            coordinates = np.array([posture.coordinates for posture in way])
            force = np.array([posture.force for posture in way])
            x = nearest(problem, spline, phase, coordinates, force)
            yield InitialGuess(f"path from posture {n + 1} at the {name}", x)


def _followed(still: ClearStill, first: Posture, begin: Array, finish: Array, shares: Array) -> list[Posture] | None:
    """Return clear postures with the object at each of the shares of its way; None where the way ends before."""
    way = [first]
    for here, there in pairwise(shares.tolist()):
        after = _step(still, way[-1], begin, finish, (here, there), HALVINGS)
        if after is None:
            return None
        way.append(after)
    return way


def _step(
    still: ClearStill, last: Posture, begin: Array, finish: Array, shares: tuple[float, float], halvings: int
) -> Posture | None:
    """Return the clear posture at the second share of the object's way that one at the first leads to, or None."""
    here, there = shares
    pose = finish if there == 1.0 else begin + there * (finish - begin)
    after = _moved(still, still.postures.problem.at_pose(pose), last, pose)
    if after is not None or not halvings or still.clearer.deadline.passed:
        return after
    middle = (here + there) / 2.0
    between = _step(still, last, begin, finish, (here, middle), halvings - 1)
    return between and _step(still, between, begin, finish, (middle, there), halvings - 1)


def _moved(still: ClearStill, problem: Problem, last: Posture, pose: Array) -> Posture | None:
    """Return the clear posture with the object at a pose that one nearby leads to, or None."""
    coordinates = last.coordinates.copy()
    coordinates[-OBJECT_SIZE:] = np.where(np.isnan(pose), coordinates[-OBJECT_SIZE:], pose)
    after, _ = still.cleared(problem, problem.pack(coordinates[None], last.force[None]))
    return after
