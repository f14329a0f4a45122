"""Parts of the load and forces against each other; oracles: the closed form for two hands, equilibrium, a triangle."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.solution.grasp_loads import internal_forces, shares, squeeze

ANGLES = np.radians([0.0, 120.0, 240.0])
CORNERS = np.stack([np.cos(ANGLES), np.sin(ANGLES), 0.0 * ANGLES], axis=1)


@pytest.fixture
def three(team_solution: Callable[[str], Any]) -> Callable[[np.ndarray], list[AgentTrajectory]]:
    """Return a function that gives three hands at the corners of a triangle, which do (3, 3) forces."""
    agents = team_solution("two_robots").solution.agents

    def hands(force: np.ndarray) -> list[AgentTrajectory]:
        knots = len(agents[0].load)
        return [
            replace(agent, grasp_position=np.tile(point, (knots, 1, 1)), grasp_force=np.tile(one, (knots, 1, 1)))
            for agent, point, one in zip(agents, CORNERS, force, strict=True)
        ]

    return hands


def test_hands_that_press_a_triangle_together_press_with_their_own_force(three: Callable[..., Any]) -> None:
    """Forces to the middle are in equilibrium: all of them is internal, and positive; outwards is negative."""
    hands = three(-7.0 * CORNERS)
    np.testing.assert_allclose(squeeze(hands), 7.0, rtol=1e-12)
    for agent in hands:
        np.testing.assert_allclose(squeeze(hands, agent.name), 7.0, rtol=1e-12)
    np.testing.assert_allclose(squeeze(three(3.0 * CORNERS)), -3.0, rtol=1e-12)


def test_what_lifts_or_turns_the_object_presses_nothing(three: Callable[..., Any]) -> None:
    up = np.tile([0.0, 0.0, 5.0], (3, 1))
    around = 4.0 * np.cross([0.0, 0.0, 1.0], CORNERS)
    np.testing.assert_allclose(internal_forces(three(up + around)), 0.0, atol=1e-12)


def test_internal_forces_move_nothing_and_leave_the_smallest_forces(three: Callable[..., Any]) -> None:
    """No force and no moment, and at right angles to what is left."""
    force = np.random.default_rng(3).normal(size=(3, 3))
    inner = internal_forces(three(force))[:, 0]
    np.testing.assert_allclose(inner.sum(axis=0), 0.0, atol=1e-12)
    np.testing.assert_allclose(np.cross(CORNERS, inner).sum(axis=0), 0.0, atol=1e-12)
    assert float((inner * (force - inner)).sum()) == pytest.approx(0.0, abs=1e-12)


def test_of_two_hands_it_is_half_the_difference_along_their_line(team_solution: Callable[[str], Any]) -> None:
    """And the internal forces of two are the same thing."""
    agents = team_solution("two_people").solution.agents
    line = agents[1].p_world_hold - agents[0].p_world_hold
    line /= np.linalg.norm(line, axis=1, keepdims=True)
    expected = 0.5 * ((agents[0].load - agents[1].load) * line).sum(axis=1)
    np.testing.assert_allclose(squeeze(agents), expected, rtol=1e-12)
    np.testing.assert_allclose(internal_forces(agents)[0], expected[:, None] * line, atol=1e-9)


@pytest.mark.parametrize("name", ["two_people", "two_robots"])
def test_shares_of_all_make_one(team_solution: Callable[[str], Any], name: str) -> None:
    agents = team_solution(name).solution.agents
    parts = shares(agents)
    assert len(parts) == len(agents)
    np.testing.assert_allclose(parts.sum(axis=0), 1.0, rtol=1e-12)
