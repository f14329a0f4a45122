"""What is told of a person's stand; the oracle is the ground's force and moment by hand, from the trajectory."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from liftopt.assessment.standing import standing_findings
from liftopt.assessment.who import Who
from liftopt.solution.finding import Finding
from liftopt.solution.solution import Solution


@pytest.fixture
def squat(team_solution: Callable[[str], Any]) -> Any:
    return team_solution("squat")


def _found(solution: Solution, shift: np.ndarray | None = None) -> dict[str, Finding]:
    """Return the findings by code, with the ground's moment shifted by (3,)."""
    (person,) = solution.persons
    moved = person if shift is None else replace(person, ground_moment=person.ground_moment + shift)
    found = standing_findings(replace(solution, agents=(moved,)), moved, Who("person", person.name, True))
    return {finding.code: finding for finding in found}


def test_the_least_margin_is_told_with_its_edge_and_time(squat: Any) -> None:
    solution, (agent,) = squat.solution, squat.agents
    (person,), (back, ahead, aside) = solution.persons, agent.stance.support
    force, moment = person.ground_force, person.ground_moment
    x, y = -moment[:, 1] / force[:, 2], moment[:, 0] / force[:, 2]
    margin = np.min([x - back, ahead - x, aside - np.abs(y)], axis=0)
    balance = _found(solution)["person.balance"]
    assert balance.value == pytest.approx(margin.min(), abs=1e-12)
    assert balance.time == solution.time[margin.argmin()]
    edge = ("heels", "balls of the feet")[int(ahead - x[margin.argmin()] < x[margin.argmin()] - back)]
    assert edge in balance.message


def test_one_who_leans_past_an_edge_is_told_so(squat: Any) -> None:
    (agent,) = squat.agents
    balance = _found(squat.solution, np.array([0.0, 300.0, 0.0]))["person.balance"]  # as if pulled backwards
    assert balance.severity == "caution"
    assert balance.value is not None and balance.value < 0.0
    assert f"{-1000 * balance.value:.0f} mm beyond the heels" in balance.title
    assert agent.stance is not None


def test_friction_that_is_needed_is_that_of_the_ground_force(squat: Any) -> None:
    (person,), (agent,) = squat.solution.persons, squat.agents
    needed = np.linalg.norm(person.ground_force[:, :2], axis=1) / person.ground_force[:, 2]
    friction = _found(squat.solution)["person.floor_friction"]
    assert friction.value == pytest.approx(needed.max())
    assert friction.limit == agent.stance.friction


def test_of_the_papers_person_nothing_is_told(people: Solution) -> None:
    for person in people.persons:
        assert not list(standing_findings(people, person, Who("person", person.name, False)))
