"""Files of schema 1 mean what they meant: oracle is the shipped scenarios as they were, word by word, in schema 1."""

from __future__ import annotations

from pathlib import Path

import pytest

from liftopt.errors import InputError
from liftopt.scenario.model import load_scenario, scenario_from_dict

AS_THEY_WERE = Path(__file__).with_name("schema1")


@pytest.mark.parametrize("name", ["table5", "table5_free", "table5_near"])
def test_the_shipped_scenarios_of_schema_1_are_those_of_today_as_the_paper_has_them(name: str) -> None:
    paper = {"objective.preset": "paper", "limits.clearance": "off"}
    assert load_scenario(AS_THEY_WERE / f"{name}.toml") == load_scenario(name, paper)


def test_without_rest_it_means_acceleration_and_the_paper_with_point_grasps(tmp_path: Path) -> None:
    text = (AS_THEY_WERE / "table5.toml").read_text(encoding="utf-8")
    (tmp_path / "old.toml").write_text(text.replace('rest = "velocity"', ""), encoding="utf-8")
    scenario = load_scenario(tmp_path / "old.toml", ["human.stature=1.6"])
    assert (scenario.task.rest, scenario.objective.preset, scenario.value("human.stature")) == (
        "acceleration", "paper", 1.6,
    )  # fmt: skip
    assert {agent.grasp for agent in scenario.agents.values()} == {"point"}
    assert "schema = 2" in scenario.to_toml()


def test_weights_go_to_the_agents() -> None:
    tables = {
        "schema": 1, "duration": 2.0, "human": {"stature": 1.7, "mass": 70.0, "sex": "male"},
        "robot": {"model": "sawyer"}, "table": {"mass": 2.0, "depth": 0.4, "width": 0.3, "height": 0.02},
        "task": {
            "standing_distance": 1.8, "start": {"height": 0.9, "human_distance": 0.4},
            "end": {"height": 1.2, "human_distance": 0.4},
        },
        "objective": {"human_weight": 2.0, "robot_weight": 0.5, "force_weight": 0.1},
    }  # fmt: skip
    scenario = scenario_from_dict(tables)
    assert {name: agent.weight for name, agent in scenario.agents.items()} == {"human": 2.0, "robot": 0.5}
    assert scenario.objective.force_weight == 0.1


@pytest.mark.parametrize(
    ("tables", "said"),
    [
        ({"schema": 1, "duration": 2.0}, "human.stature: is missing"),
        ({"schema": 1, "duration": 2.0, "human": 3}, "human = 3: must be a section of an agent"),
        ({"schema": 3}, "schema = 3: must be 2, or 1 in older files"),
        ({"schema": "1"}, "schema = '1': must be 2, or 1 in older files"),
        ({"schema": 1.0}, "schema = 1.0: must be 2, or 1 in older files"),
        ({}, "schema: is missing; must be 2"),
        (
            {"schema": 2, "duration": 2.0, "human": {"stature": 1.7}},
            "human: unknown key; in schema 2 it is a table of an agent, [agents.human]",
        ),
        (
            {"schema": 2, "duration": 2.0, "table": {"mass": 2.0}},
            "table.mass = 2.0: unknown key; did you mean object.mass",
        ),
    ],
)
def test_what_is_wrong_is_told_by_its_key(tables: dict[str, object], said: str) -> None:
    with pytest.raises(InputError) as caught:
        scenario_from_dict(tables)
    assert str(caught.value).startswith(said)
