"""Lifts by other teams than one person and one robot."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest


@pytest.fixture(scope="session")
def two_people(team_solution: Callable[[str], Any]) -> Any:
    """A woman and a man who face each other, one box between them."""
    return team_solution("two_people")


@pytest.fixture(scope="session")
def two_robots(team_solution: Callable[[str], Any]) -> Any:
    """A person and two Sawyers at the ends of a plank."""
    return team_solution("two_robots")


@pytest.fixture(scope="session", params=["two_people", "two_robots"])
def team(request: pytest.FixtureRequest) -> Any:
    """Either of them."""
    return request.getfixturevalue(request.param)
