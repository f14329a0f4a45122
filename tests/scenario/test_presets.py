"""Presets of the objective: what a scenario leaves out is its preset's; oracle: the tables of presets, by hand."""

from __future__ import annotations

from itertools import permutations
from typing import Any

import pytest

from liftopt.errors import InputError
from liftopt.files.toml_text import toml
from liftopt.scenario.agents import Person
from liftopt.scenario.build import task_of
from liftopt.scenario.model import Scenario, load_scenario, scenario_from_dict
from liftopt.scenario.robot import Robot
from liftopt.scenario.settings import Objective

TABLES: dict[str, Any] = {
    "schema": 2,
    "duration": 2.0,
    "agents": {
        "anna": {"kind": "person", "stature": 1.65, "mass": 60.0, "sex": "female"},
        "near": {"kind": "robot", "model": "sawyer"},
    },
    "object": {"mass": 2.0, "depth": 0.45, "width": 0.31, "height": 0.02},
    "task": {
        "standing_distance": 1.9,
        "start": {"height": 0.9, "human_distance": 0.4},
        "end": {"height": 1.3, "human_distance": 0.4},
    },
}
KEYS = (
    "anna.weight", "anna.grasp", "anna.grasp_turn_deg", "near.weight", "near.grasp", "near.grasp_turn_deg",
    "objective.acceleration_weight", "objective.force_weight", "objective.range_weight", "objective.tilt_weight",
)  # fmt: skip
NATURAL = (1600.0, "wrench", 60.0, 16.0, "wrench", 30.0, 12.0, 0.1, 250.0, 50.0)
PAPER = (1.0, "point", 30.0, 1.0, "point", 30.0, 0.5, 0.01, 0.0, 0.0)


def values(scenario: Scenario) -> tuple[Any, ...]:
    """Return what presets differ in, in the order of ``KEYS``."""
    return tuple(scenario.value(key) for key in KEYS)


@pytest.mark.parametrize(
    ("objective", "expected"), [({}, NATURAL), ({"preset": "natural"}, NATURAL), ({"preset": "paper"}, PAPER)]
)
def test_a_file_that_leaves_it_out_has_what_its_preset_says(
    objective: dict[str, str], expected: tuple[Any, ...]
) -> None:
    scenario = scenario_from_dict({**TABLES, "objective": objective} if objective else TABLES)
    assert values(scenario) == expected
    assert scenario.objective.preset == objective.get("preset", "natural")
    assert task_of(scenario).shares == (scenario.objective.preset == "natural")


def test_it_is_the_same_in_python() -> None:
    made = {"anna": Person(stature=1.65, mass=60.0, sex="female"), "near": Robot(model="sawyer")}
    others = {key: scenario_from_dict(TABLES).value(key) for key in ("object", "task")}
    assert values(Scenario(agents=made, **others)) == NATURAL
    paper = Scenario(agents=made, objective=Objective(preset="paper"), **others)
    assert values(paper) == PAPER == values(Scenario(agents=made, objective={"preset": "paper"}, **others))
    said = {**made, "near": Robot(model="sawyer", weight=3.0)}
    assert Scenario(agents=said, objective=Objective(preset="paper"), **others).value("near.weight") == 3.0
    assert Objective().range_weight == 250.0 and Objective(preset="paper").range_weight == 0.0


@pytest.mark.parametrize("order", list(permutations(("objective.preset", "anna.weight", "near.grasp"))))
def test_another_preset_drops_what_the_same_changes_do_not_say(order: tuple[str, ...]) -> None:
    """In any order; all else stays."""
    wanted = {"objective.preset": "natural", "anna.weight": 2.0, "near.grasp": "point"}
    paper = scenario_from_dict({**TABLES, "objective": {"preset": "paper", "force_weight": 0.7}})
    base = paper.replace({"near.weight": 5.0, "anna.max_grasp_moment": 7.0, "object.mass": 4.0})
    changed = base.replace({key: wanted[key] for key in order})
    expected = dict(zip(KEYS, NATURAL, strict=True)) | {"anna.weight": 2.0, "near.grasp": "point"}
    assert dict(zip(KEYS, values(changed), strict=True)) == expected
    assert (changed.value("anna.max_grasp_moment"), changed.object.mass) == (7.0, 4.0)
    assert values(base)[3] == 5.0


def test_the_command_line_does_the_same() -> None:
    natural = load_scenario("table5_paper", ["robot.weight=2", "objective.preset=natural", "object.mass=3"])
    assert (natural.value("human.weight"), natural.value("human.grasp")) == (1600.0, "wrench")
    assert (natural.value("robot.weight"), natural.objective.range_weight) == (2.0, 250.0)
    assert load_scenario("table5_paper", ["objective.preset=paper"]) == load_scenario("table5_paper")


def test_a_section_of_the_objective_brings_its_preset_too() -> None:
    natural = load_scenario("table5_paper", {"objective": {"preset": "natural", "tilt_weight": 1.0}})
    assert (natural.value("human.weight"), natural.objective.tilt_weight, natural.objective.force_weight) == (
        1600.0, 1.0, 0.1,
    )  # fmt: skip
    again = natural.replace({"objective": Objective(preset="paper", force_weight=0.2)})
    assert again == load_scenario("table5_paper", {"objective.force_weight": 0.2})


def test_the_same_preset_changes_nothing_and_what_is_written_stays() -> None:
    scenario = scenario_from_dict(TABLES).replace({"anna.weight": 7.0, "objective.force_weight": 0.3})
    for again in (
        scenario.replace({"objective.preset": "natural"}),
        scenario.replace({}),
        scenario_from_dict(toml(scenario.to_toml())),
        scenario_from_dict(scenario.to_dict()),
    ):
        assert again == scenario
    assert values(scenario.replace({"object.mass": 3.0})) == values(scenario)


def test_back_and_forth_is_where_it_began() -> None:
    natural = load_scenario("table5_near")
    assert natural.replace({"objective.preset": "paper"}).replace({"objective.preset": "natural"}) == natural


def test_schema_1_means_the_paper() -> None:
    human, robot = TABLES["agents"]["anna"], TABLES["agents"]["near"]
    old = {key: TABLES[key] for key in ("duration", "task")} | {"schema": 1, "table": TABLES["object"]}
    for name, agent in (("human", human), ("robot", robot)):
        old[name] = {key: value for key, value in agent.items() if key != "kind"}
    for objective in ({}, {"objective": {"force_weight": 0.2}}):
        scenario = scenario_from_dict({**old, **objective})
        assert scenario.objective.preset == "paper"
        assert (scenario.value("human.weight"), scenario.value("robot.grasp")) == (1.0, "point")
    natural = scenario_from_dict({**old, "objective": {"force_weight": 0.2}}).replace({"objective.preset": "natural"})
    assert natural.objective.force_weight == 0.1


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"objective.preset": "papr"}, 'objective.preset = \'papr\': must be "natural" or "paper"'),
        ({"objective.preset": 3}, 'objective.preset = 3: must be "natural" or "paper"'),
        ({"objective": 3}, "objective = 3: must be a section"),
        ({"objective": {"presett": "paper"}}, "objective.presett = 'paper': unknown key"),
        ({"objective.range_weight": -1.0}, "objective.range_weight = -1.0: must be a number from 0"),
    ],
)
def test_what_is_wrong_is_told_by_its_key(changes: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError) as caught:
        load_scenario("table5", changes)
    assert str(caught.value).startswith(said)


def test_help_tells_the_default_by_preset() -> None:
    told = dict(scenario_from_dict(TABLES).describe())
    assert told["anna.weight"].endswith("; default 1600.0 (natural), 1.0 (paper)")
    assert told["near.grasp"].endswith("; default wrench (natural), point (paper)")
    assert told["objective.tilt_weight"].endswith("; default 50.0 (natural), 0.0 (paper)")
    assert told["objective.preset"].endswith("; default natural")
