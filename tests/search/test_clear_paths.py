"""Motions along clear postures. Oracles: coal pair by pair on Pinocchio's placements, and the verification."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from liftopt.collocation.solvers.result import Multipliers, SolverResult
from liftopt.scenario.model import scenario_from_dict
from liftopt.search.cache import SolverCache
from liftopt.search.candidate import Candidate
from liftopt.search.clear_paths import paths_between
from liftopt.search.clear_postures import clear_ends, starts_between
from liftopt.search.make_clear import Clearer
from liftopt.search.session import Session
from liftopt.types import Array

# A box with handles, from between the shanks to the height of the head, as far ahead as one likes.
TO_THE_HEAD: dict[str, Any] = {
    "schema": 2,
    "name": "to_the_head",
    "duration": 2.326,
    "agents": {"human": {"kind": "person", "body": "whole", "sex": "female", "stature": 1.776, "mass": 74.1}},
    "object": {
        "name": "box", "mass": 18.121, "depth": 0.224, "width": 0.349, "height": 0.26,
        "grasps": {"human_right": "handle", "human_left": "handle"},
    },
    "task": {
        "start": {"height": 0.384, "human_distance": "free"},
        "end": {"height": 1.537, "human_distance": "free"},
    },
    "solver": {"intervals": 10, "time_limit": 300.0, "workers": 1},
}  # fmt: skip


@pytest.fixture(scope="module")
def ready() -> tuple[Session, Clearer]:
    session = Session(scenario_from_dict(TO_THE_HEAD), SolverCache())
    problem = session.problem(session.spline)
    clearer = session.clearer(problem)
    assert clearer is not None
    session.held = clear_ends(session, clearer, problem, [])
    return session, clearer


def least_distance(session: Session, x: Array, coal_distance: Any) -> float:
    """Return how far the nearest two bodies are apart, at any of 21 times [m]."""
    problem, least = session.problem(session.spline), np.inf
    (agent,) = problem.team.agents
    solids = session.cache.solids(session.scenario, problem.team)
    for q in session.spline.basis(np.linspace(0.0, 1.0, 21)) @ problem.unpack(x)[0]:
        at = coal_distance.joint_placements(agent, q[:-6])
        turns = [pin.exp3(angle * axis) for angle, axis in zip(q[-3:], np.eye(3), strict=True)]
        box = pin.SE3(np.linalg.multi_dot(turns), q[-6:-3]).homogeneous
        for pair in solids.pairs:
            placed = [
                at[solid.joint] if solid.owner == "human" else box if solid.owner == "box" else np.eye(4)
                for solid in (pair.one, pair.other)
            ]
            least = min(least, coal_distance.distance(pair.one, placed[0], pair.other, placed[1]))
    return least


def test_a_path_along_clear_postures_leads_to_a_lift_where_blends_of_its_ends_overlap_deeply(
    ready: tuple[Session, Clearer], coal_distance: Any
) -> None:
    session, clearer = ready
    problem = session.problem(session.spline)
    blends = [least_distance(session, start.x, coal_distance) for start in starts_between(session, problem, 4)]
    nothing = Multipliers(np.zeros(problem.layout.n_x), np.zeros(problem.constraints.linear.shape[0]))
    for path in paths_between(session, clearer, problem, session.spline):
        control = problem.unpack(path.x)[0]
        # Handles are 0.08 m above the middle of the box.
        assert control[[0, -1], -4] == pytest.approx([0.304, 1.457], abs=1e-6)
        result = SolverResult(path.x, nothing, np.nan, 0, False, "", 0.0, 0.0)
        motion = Candidate(session.scenario, problem, session.spline, path.name, result)
        attempt = clearer.make_clear(motion, polish=False)
        if attempt.clear:
            break
    assert attempt.clear and attempt.candidate.usable
    assert least_distance(session, path.x, coal_distance) > max(blends) + 0.05
    assert least_distance(session, attempt.candidate.result.x, coal_distance) > -1e-3


def test_there_is_no_path_without_clear_postures_at_both_ends(ready: tuple[Session, Clearer]) -> None:
    session, clearer = ready
    problem, held = session.problem(session.spline), session.held
    session.held = ()
    assert not list(paths_between(session, clearer, problem, session.spline))
    session.held = (held[0], replace(held[1], postures=()))
    paths = paths_between(session, clearer, problem, session.spline)
    name = next(paths).name
    assert name.startswith("path from posture ") and name.endswith(" at the start")
    session.held = held
