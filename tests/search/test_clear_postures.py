"""Clear postures at both ends of a lift. Oracles: coal pair by pair on Pinocchio's placements, and a box by hand."""

from __future__ import annotations

from copy import deepcopy
from typing import Any

import numpy as np
import pytest

from liftopt.scenario.build import obstacles_of
from liftopt.scenario.model import scenario_from_dict
from liftopt.search.blocked import explain_blocked
from liftopt.search.cache import SolverCache
from liftopt.search.clear_end import ClearEnd
from liftopt.search.clear_postures import clear_ends, starts_between
from liftopt.search.make_clear import Attempt
from liftopt.search.session import Session

FLOOR: dict[str, Any] = {
    "schema": 2,
    "name": "floor",
    "duration": 2.0,
    "agents": {"human": {"kind": "person", "body": "whole", "sex": "male", "stature": 1.75, "mass": 75.0}},
    "object": {"name": "box", "mass": 8.0, "depth": 0.3, "width": 0.4, "height": 0.3},
    "task": {
        "standing_distance": 1.6,
        "start": {"height": 0.2, "human_distance": 0.5},
        "end": {"height": 0.95, "human_distance": 0.45},
    },
    "solver": {"intervals": 10, "time_limit": 300.0, "workers": 1},
}


def searched(**changes: object) -> tuple[Session, tuple[ClearEnd, ...]]:
    tables = deepcopy(FLOOR) | changes
    session = Session(scenario_from_dict(tables), SolverCache())
    problem = session.problem(session.spline)
    clearer = session.clearer(problem)
    assert clearer is not None
    return session, clear_ends(session, clearer, problem, [])


def test_postures_at_both_ends_are_clear_and_motions_begin_and_end_there(coal_distance: Any) -> None:
    session, ends = searched()
    problem = session.problem(session.spline)
    (agent,) = problem.team.agents
    solids = session.cache.solids(session.scenario, problem.team)
    assert [bool(end.postures) for end in ends] == [True, True]
    assert not any(end.reasons for end in ends)
    for end, height in zip(ends, (0.2, 0.95), strict=True):
        for posture in end.postures:
            q, pose = posture.coordinates[:-6], posture.coordinates[-6:]
            assert pose[2] - 0.15 == pytest.approx(height, abs=1e-6)  # the hands hold the bottom edge of 0.3 m
            box = np.eye(4)
            box[:3, 3] = pose[:3]
            at = coal_distance.joint_placements(agent, q)

            def placed(solid: Any, at: Any = at, box: Any = box) -> Any:
                return at[solid.joint] if solid.owner == "human" else box if solid.owner == "box" else np.eye(4)

            for pair in solids.pairs:
                apart = coal_distance.distance(pair.one, placed(pair.one), pair.other, placed(pair.other))
                assert apart >= pair.asked(0.0) - 1e-3, pair.told
    session.held = ends
    starts = starts_between(session, problem, 3)
    assert starts
    for start in starts:
        control = problem.unpack(start.x)[0]
        for at, end in ((control[0], ends[0]), (control[-1], ends[1])):
            assert min(np.abs(at - posture.coordinates).max() for posture in end.postures) < 1e-9


def test_what_leaves_hands_no_room_is_named_with_them() -> None:
    """A wall stands 1 cm before the near face, which hands at its lower edge are behind by 5 cm and more."""
    wall = {"name": "wall", "box": [0.2, 1.2, 0.5], "position": [0.39, 0.0, 0.25]}
    session, ends = searched(obstacles=[wall])
    assert len(obstacles_of(session.scenario)) == 1
    start, end = ends
    assert end.postures and not end.reasons
    assert start.reasons and all(reason.static and reason.time == 0.0 for reason in start.reasons)
    assert all("start of the lift, in every posture found" in reason.message for reason in start.reasons)
    walled = [reason.who for reason in start.reasons if reason.constraint == "clearance" and "wall" in reason.who]
    assert {who.split()[0] for who in walled} == {"left", "right"}
    session.held = ends
    assert session.blocked_at_rest
    assert starts_between(session, session.problem(session.spline), 3) == []
    session.blocked = [Attempt(None, None, False, frozenset())]  # type: ignore[arg-type]
    found = explain_blocked(session, session.spline)
    assert found is not None and found.reasons == start.reasons
    assert start.reasons[0].message in found.best.outcome
