"""Lifts that begin or end falling. Oracles: the verification, and the same lift with no acceleration at its ends."""

from __future__ import annotations

from typing import Any

import numpy as np

from liftopt.scenario.model import scenario_from_dict
from liftopt.search.cache import SolverCache
from liftopt.search.session import Session
from liftopt.search.solve import find_lift

# To hold the box still takes 1.06 times what the wrists bear.
HEAVY: dict[str, Any] = {
    "schema": 2,
    "name": "heavy",
    "duration": 3.104,
    "agents": {"human": {"kind": "person", "body": "whole", "sex": "male", "stature": 1.645, "mass": 63.6}},
    "object": {"name": "box", "mass": 19.313, "depth": 0.224, "width": 0.442, "height": 0.38},
    "task": {
        "start": {"height": 0.719, "human_distance": 0.35},
        "end": {"height": 1.164, "human_distance": 0.35},
    },
    "solver": {"time_limit": 300.0, "workers": 1, "tries": 8},
}  # fmt: skip


def test_what_cannot_quite_be_held_still_is_lifted_from_a_fall_into_a_fall() -> None:
    scenario = scenario_from_dict(HEAVY)
    found = find_lift(Session(scenario, SolverCache()))
    assert found.best.usable
    ends = found.best.at(np.array([0.0, scenario.duration])).object.acceleration[:, 2]
    assert (ends < 0.0).all()
    still = find_lift(Session(scenario.replace({"task.rest": "acceleration"}), SolverCache()))
    assert not still.best.usable
    assert {reason.constraint for reason in still.reasons} == {"grasp_moment"}
    assert all(0.03 < reason.share < 0.1 for reason in still.reasons)
