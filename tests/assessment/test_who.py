"""How somebody who lifts is told: oracle is a reader who knows names from words."""

from __future__ import annotations

import pytest

from liftopt.assessment.who import who_in, whose
from liftopt.scenario.agents import Person
from liftopt.scenario.robot import Robot

ANNA = Person(stature=1.62, mass=58.0, sex="female")
SAWYER = Robot(model="sawyer")


@pytest.mark.parametrize(
    ("name", "told"),
    [("human", "the human's"), ("robot", "the robot's"), ("anna", "anna's"), ("left", "left's"), ("arm", "the arm's")],
)
def test_only_words_have_an_article(name: str, told: str) -> None:
    assert whose(name) == told


def test_a_name_is_told_where_several_are_of_a_kind() -> None:
    team: dict[str, Person | Robot] = {"anna": ANNA, "left": SAWYER, "right": SAWYER}
    assert [who_in(team, name).called for name in team] == ["the person", "left", "right"]
    assert [who_in(team, name).of for name in team] == ["", " of left", " of right"]
