"""Held off: bounds alone move, and a box in the lap comes out of it. Coal and NumPy are the oracles."""

from __future__ import annotations

import numpy as np
import pytest

from liftopt.collocation.batch import Batch
from liftopt.scenario.model import scenario_from_dict
from liftopt.search.cache import BANDED, SolverCache
from liftopt.search.candidate import Candidate
from liftopt.search.held_off import STEP, held_off
from liftopt.search.initial_guess import posture_starts
from liftopt.search.make_clear import Clearer
from liftopt.search.session import Session

FLOOR = {
    "schema": 2,
    "name": "floor",
    "duration": 2.0,
    "agents": {"human": {"kind": "person", "body": "whole", "sex": "male", "stature": 1.75, "mass": 75.0}},
    "object": {
        "name": "box", "mass": 15.0, "depth": 0.3, "width": 0.4, "height": 0.3,
        "grasps": {"human_right": "side", "human_left": "side"},
    },
    "task": {
        "standing_distance": 1.6,
        "start": {"height": 0.16, "human_distance": 0.45},
        "end": {"height": 0.95, "human_distance": 0.45},
    },
    "solver": {"intervals": 10, "time_limit": 300.0, "workers": 1},
}  # fmt: skip


@pytest.fixture(scope="module")
def session() -> Session:
    return Session(scenario_from_dict(FLOOR), SolverCache())


@pytest.fixture(scope="module")
def clearer(session: Session) -> Clearer:
    found = session.clearer(session.problem(session.spline))
    assert found is not None
    return found


@pytest.fixture(scope="module")
def free(session: Session) -> Candidate:
    problem = session.problem(session.spline)
    (start,) = posture_starts(problem, 1, 0, session.deadline, postures=session.postures)
    result = session.solver(problem, BANDED).solve(start.x, deadline=session.deadline)
    assert result.converged
    return Candidate(session.scenario, problem, session.spline, start.name, result)


def ahead(candidate: Candidate) -> float:
    """Return how far ahead of the feet the hands are at least [m]."""
    problem = candidate.problem
    g = Batch(problem).rows(candidate.result.x[None])[0]
    return float(min(g[block.rows].min() for block in problem.constraints.blocks if block.name == "workspace"))


def overlapping(clearer: Clearer, candidate: Candidate) -> list[int]:
    """Return the numbers of the pairs of the object and somebody that overlap."""
    _, least = clearer.look(candidate.problem, candidate.spline, candidate.result.x)
    deep = np.flatnonzero(least < clearer.asked)
    return [int(pair) for pair in deep if clearer.solids.pairs[pair].kind == "person-object"]


def test_nothing_is_held_off_where_nothing_overlaps(clearer: Clearer, free: Candidate) -> None:
    assert not list(held_off(clearer, free, ()))


def test_who_folds_has_less_of_the_ranges_of_hip_and_trunk(clearer: Clearer, free: Candidate) -> None:
    told = "left thigh of human and left chest of human"
    pair = next(n for n, each in enumerate(clearer.solids.pairs) if each.told == told)
    hip, columns = 2, free.problem.layout.control[:, 2]
    assert free.problem.team.agents[0].moving_joints[hip] == "human_hip"
    far = free.result.x[columns].max()
    bent = [candidate.result.x[columns].max() for candidate in held_off(clearer, free, [pair])]
    assert bent and bent[0] <= 0.9 * far + 1e-6 and (np.diff(bent) < 0.0).all()


def test_hands_are_farther_ahead_step_by_step_and_no_farther_than_the_task_has_them(
    clearer: Clearer, free: Candidate
) -> None:
    found = [free, *held_off(clearer, free, overlapping(clearer, free))]
    hands = [ahead(candidate) for candidate in found]
    assert len(found) > 3
    assert np.diff(hands[:-1]) == pytest.approx(STEP, abs=1e-3)
    assert hands[-1] <= 0.45
    # Less room costs more; the problem itself is the one that was asked.
    assert (np.diff([candidate.result.objective for candidate in found]) > 0.0).all()
    assert all(candidate.problem is free.problem for candidate in found)


def test_a_box_that_the_cheapest_way_has_in_the_lap_is_led_past_the_knees(
    session: Session, clearer: Clearer, free: Candidate
) -> None:
    _, least = clearer.look(free.problem, free.spline, free.result.x)
    deepest = clearer.solids.pairs[int(least.argmin())].told
    assert least.min() < -0.1 and deepest.endswith("thigh of human and box")
    starts = list(held_off(clearer, free, overlapping(clearer, free)))
    attempts = [clearer.make_clear(start, also=frozenset(np.flatnonzero(least < 0.0).tolist())) for start in starts]
    clear = [attempt.candidate for attempt in attempts if attempt.clear]
    assert clear and min(candidate.result.objective for candidate in clear) > free.result.objective
    assert all(candidate.verification.check("clearance").passed for candidate in clear)
