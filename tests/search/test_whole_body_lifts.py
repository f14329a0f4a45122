"""The shipped lifts of whole bodies, solved; oracles: Newton by hand, coal on a ten times finer grid, the KKT error."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from liftopt.solution.solution import Solution

pytestmark = pytest.mark.long
GRAVITY = 9.81
ENOUGH = "solver.time_limit=600.0"  # a busy machine is slower than the one the limit is for


@pytest.fixture(scope="module", params=["floor_box", "pallet", "two_people"])
def lift(request: pytest.FixtureRequest, solved: Callable[..., Any]) -> Solution:
    solution: Solution = solved(request.param, ENOUGH).solution
    return solution


def test_it_is_verified_and_clear(lift: Solution) -> None:
    assert lift.solved, lift.status
    assert lift.verification.kkt_error <= 1e-6
    assert lift.verification.check("clearance").passed
    assert lift.clearance is not None
    assert min(item.distance for item in lift.clearance.closest) >= -0.001


def test_hands_carry_what_the_object_weighs_and_its_motion_takes(lift: Solution) -> None:
    force = sum(agent.grasp_force.sum(axis=1) for agent in lift.agents)
    expected = lift.scenario.object.mass * (lift.object.acceleration[:, :3] + [0.0, 0.0, GRAVITY])
    np.testing.assert_allclose(force, expected, atol=1e-4)
    for agent in lift.agents:
        np.testing.assert_allclose(agent.q[:, ~agent.moving], 0.0)


def test_hands_are_where_the_scenario_says_at_both_ends(lift: Solution) -> None:
    """By hand from the file: names, and heights."""
    names = [grasp.name for agent in lift.agents for grasp in agent.grasps]
    hands = ["human_right", "human_left"]
    both = {
        "floor_box": (hands, (0.25, 0.95)),
        "pallet": ([*hands, "robot"], (0.45, 1.05)),
        "two_people": (["anna_right", "anna_left", "ben_right", "ben_left"], (0.5, 0.95)),
    }[lift.scenario.name]
    assert names == both[0]
    for k, height in zip((0, -1), both[1], strict=True):
        np.testing.assert_allclose(lift.agents[0].grasp_position[k, :, 2], height, atol=1e-6)


def test_who_lifts_from_below_the_knees_bends_and_stands_up(lift: Solution) -> None:
    for person in lift.persons:
        knee, hip = (
            np.degrees(person.q[:, person.joint_names.index(f"{person.name}_{joint}")]) for joint in ("knee", "hip")
        )
        assert hip[0] > hip[-1] and hip[0] > 60.0
        assert knee[-1] < 45.0
