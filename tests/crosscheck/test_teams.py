"""Independent checks of lifts by other teams; the oracles are MuJoCo and the conservation of energy."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from liftopt.crosscheck.energy import energy_books
from liftopt.crosscheck.mujoco_dynamics import inverse_dynamics
from liftopt.solution.solution import Solution


@pytest.fixture(params=["two_people", "two_robots"])
def lift(request: pytest.FixtureRequest, team_solution: Callable[[str], Any]) -> Solution:
    """A lift of everybody in it."""
    found: Solution = team_solution(request.param).solution
    return found


def test_mujoco_finds_everybodys_torques(lift: Solution) -> None:
    pytest.importorskip("mujoco")
    *agents, lifted = inverse_dynamics(lift)
    assert [found.name for found in agents] == [agent.name for agent in lift.agents]
    for found in (*agents, lifted):
        assert found.relative < 1e-6, (found.name, found.worst)
        assert found.gap < 1e-9


def test_everybodys_work_is_their_change_of_energy(lift: Solution) -> None:
    books = energy_books(lift, 8)
    assert [book.name for book in books] == [*(agent.name for agent in lift.agents), lift.object.name, "all"]
    for book in books:
        assert book.relative < 1e-6, book.name
