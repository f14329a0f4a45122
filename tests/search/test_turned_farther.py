"""Hands that may turn farther at first. Oracle: the verification, by Pinocchio, against the scenario's own limits."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from liftopt.collocation.solvers.result import Multipliers, SolverResult
from liftopt.scenario.model import scenario_from_dict
from liftopt.search.cache import SolverCache
from liftopt.search.candidate import Candidate
from liftopt.search.clear_paths import paths_between
from liftopt.search.clear_postures import clear_ends
from liftopt.search.session import Session
from liftopt.search.turned_farther import FARTHER, limits_turns, turned_back, with_turn

# Fists that come from above are at the limit of their turn where the box is as high as the shoulders.
TO_THE_SHOULDERS: dict[str, Any] = {
    "schema": 2,
    "name": "to_the_shoulders",
    "duration": 3.639,
    "agents": {
        "human": {"kind": "person", "body": "whole", "sex": "male", "stature": 1.742, "mass": 71.3},
        "robot": {"kind": "robot", "model": "sawyer", "base_height": 0.48},
    },
    "object": {
        "name": "box", "mass": 9.308, "depth": 0.226, "width": 0.354, "height": 0.307,
        "grasps": {"human_right": "handle", "human_left": "handle"},
    },
    "task": {
        "standing_distance": 1.66,
        "start": {"height": 0.226, "human_distance": 0.644},
        "end": {"height": 1.333, "human_distance": 0.644},
    },
    "solver": {"intervals": 10, "time_limit": 300.0, "workers": 1},
}  # fmt: skip


def turned_too_far(candidate: Candidate) -> float:
    """Return by how much a hand is turned farther than it may at a knot [rad]."""
    return max(check.value for check in candidate.verification.checks if check.name == "hand on the object")


def test_a_lift_at_the_limit_of_a_grip_follows_from_an_easy_one_beyond_it() -> None:
    session = Session(scenario_from_dict(TO_THE_SHOULDERS), SolverCache())
    problem, spline = session.problem(session.spline), session.spline
    clearer = session.clearer(problem)
    assert clearer is not None and limits_turns(problem)
    session.held = clear_ends(session, clearer, problem, [])
    eased = with_turn(problem, FARTHER)
    start = next(paths_between(session, clearer, eased, spline, FARTHER))
    nothing = Multipliers(np.zeros(problem.layout.n_x), np.zeros(problem.constraints.linear.shape[0]))
    motion = SolverResult(start.x, nothing, np.nan, 0, False, "", 0.0, 0.0)
    beyond = clearer.make_clear(Candidate(session.scenario, eased, spline, start.name, motion), polish=False)
    assert beyond.clear
    as_asked = problem.apart(beyond.candidate.problem.planes)
    assert turned_too_far(replace(beyond.candidate, problem=as_asked)) > np.radians(5.0)
    within = turned_back(clearer, problem, beyond.candidate)
    assert within is not None and within.usable
    assert turned_too_far(within) < 1e-6
    for one, two in zip(within.problem.team.agents, problem.team.agents, strict=True):
        assert one is two
    assert within.result.objective > beyond.candidate.result.objective


def test_only_limits_of_turns_differ() -> None:
    tables = TO_THE_SHOULDERS | {"agents": {"human": TO_THE_SHOULDERS["agents"]["human"]}}
    session = Session(scenario_from_dict(tables), SolverCache())
    problem = session.problem(session.spline)
    assert with_turn(problem, 0.0) is problem
    eased = with_turn(problem, FARTHER)
    assert eased.interchangeable(problem)
    for one, two in zip(eased.team.grasps, problem.team.grasps, strict=True):
        assert one == replace(two, max_turn=two.max_turn + FARTHER)
