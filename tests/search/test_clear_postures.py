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
from liftopt.search.postures import Posture
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


# At the start the forearm is in the case in every posture that is the cheapest near it, and clear in others.
CASE: dict[str, Any] = {
    "schema": 2,
    "name": "case",
    "duration": 1.858,
    "agents": {
        "human": {
            "kind": "person", "body": "whole", "hands": ["left"], "sex": "female", "stature": 1.794, "mass": 75.6,
        }
    },
    "object": {
        "name": "box", "mass": 6.339, "depth": 0.486, "width": 0.127, "height": 0.271,
        "grasps": {"human": {"place": "handle", "position": [0.0, 0.0, 0.1355]}},
    },
    "task": {
        "start": {"height": 1.581, "human_distance": 0.681},
        "end": {"height": 1.261, "human_distance": 0.681},
    },
}  # fmt: skip


def clear_of_all(session: Session, posture: Posture, coal_distance: Any) -> bool:
    """Return whether no two bodies come nearer than asked by more than 1 mm in a posture with a level object."""
    problem = session.problem(session.spline)
    (agent,) = problem.team.agents
    at, box = coal_distance.joint_placements(agent, posture.coordinates[:-6]), np.eye(4)
    box[:3, 3] = posture.coordinates[-6:-3]

    def placed(solid: Any) -> Any:
        return at[solid.joint] if solid.owner == "human" else box if solid.owner == "box" else np.eye(4)

    return all(
        coal_distance.distance(pair.one, placed(pair.one), pair.other, placed(pair.other)) >= pair.asked(0.0) - 1e-3
        for pair in session.cache.solids(session.scenario, problem.team).pairs
    )


def test_postures_at_both_ends_are_clear_and_motions_begin_and_end_there(coal_distance: Any) -> None:
    session, ends = searched()
    problem = session.problem(session.spline)
    assert [bool(end.postures) for end in ends] == [True, True]
    assert not any(end.reasons for end in ends)
    for end, height in zip(ends, (0.2, 0.95), strict=True):
        for posture in end.postures:
            # The hands hold the bottom edge of 0.3 m.
            assert posture.coordinates[-4] - 0.15 == pytest.approx(height, abs=1e-6)
            assert clear_of_all(session, posture, coal_distance)
    session.held = ends
    starts = starts_between(session, problem, 3)
    assert starts
    for start in starts:
        control = problem.unpack(start.x)[0]
        for at, end in ((control[0], ends[0]), (control[-1], ends[1])):
            assert min(np.abs(at - posture.coordinates).max() for posture in end.postures) < 1e-9


def test_clear_postures_far_from_the_cheapest_are_found(coal_distance: Any) -> None:
    session, (start, end) = searched(**CASE)
    assert start.postures and not start.reasons
    assert end.postures and not end.reasons
    assert all(clear_of_all(session, posture, coal_distance) for posture in start.postures)


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
