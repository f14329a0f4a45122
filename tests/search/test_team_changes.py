"""What may be changed where others lift than one person and one robot: oracle is the scenario itself."""

from __future__ import annotations

from pathlib import Path

import pytest

from liftopt.scenario.model import Scenario, load_scenario
from liftopt.search.adjustables import Adjustable, adjustables
from liftopt.solution.infeasibility_report import InfeasibilityReason

TEAMS = Path(__file__).parents[1] / "scenario" / "teams"


def by_keys(scenario: Scenario) -> dict[str, Adjustable]:
    return {" ".join(found.keys): found for found in adjustables(scenario)}


@pytest.mark.parametrize(
    ("team", "key", "nearer", "farther"),
    [
        ("two_people", "task.start.human_distance", "nearer to anna", "farther from anna"),
        ("two_sawyers", "task.end.x", "nearer to near", "farther from near"),
        ("person_two_sawyers", "task.end.x", "nearer to the person", "farther from the person"),
        ("two_people", "task.standing_distance", "ben {change:.2f} m nearer", "ben {change:.2f} m farther away"),
        ("person_two_sawyers", "right.base.y", "right base {change:.2f} m towards -Y", "towards +Y"),
    ],
)
def test_changes_are_told_by_who_is_meant(team: str, key: str, nearer: str, farther: str) -> None:
    found = by_keys(load_scenario(TEAMS / f"{team}.toml"))[key]
    assert found.less.endswith(nearer)
    assert found.more.endswith(farther)


def test_an_object_before_someone_turned_moves_along_the_axes() -> None:
    scenario = load_scenario(TEAMS / "two_sawyers.toml", {"near.base.yaw_deg": 10.0})
    found = by_keys(scenario)["task.start.x"]
    assert found.less.endswith("m towards -X")
    assert found.more.endswith("m towards +X")


def test_a_third_robot_out_of_reach_may_come_nearer_by_what_it_lacks() -> None:
    """On the grid of 1 cm, along either axis; where no robot but the partner stands, there is none to move."""
    scenario = load_scenario(TEAMS / "person_two_sawyers.toml", {"right.base.x": 3.2})
    short = InfeasibilityReason(
        "grasp_closure", "right", 1.115, "m", "right's grasp stays 1.115 m short", 0.0, static=True
    )
    found = by_keys(scenario)["right.base.x"]
    steps = found.hint(scenario, [short])
    assert steps == 112
    moved = found.changed(scenario, -steps)
    assert moved is not None
    assert moved.value("right.base.x") == pytest.approx(3.2 - 1.12)
    others = {key for key in by_keys(scenario) if ".base." in key}
    assert others == {"right.base.x", "right.base.y", "right.base.z"}
    assert not [key for key in by_keys(load_scenario()) if ".base." in key]
