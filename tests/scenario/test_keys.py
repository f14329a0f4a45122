"""Dotted keys: oracle is the entry that stands there, addressed in every way that a user may write it."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from pydantic import ValidationError

from liftopt.errors import InputError
from liftopt.scenario.agents import Person
from liftopt.scenario.box import Box
from liftopt.scenario.keys import changes_in
from liftopt.scenario.model import Scenario, load_scenario
from liftopt.scenario.robot import Pose, Robot, Tool
from liftopt.scenario.robot_defaults import OF_MODEL
from liftopt.scenario.task import Lift

DEFAULT = load_scenario()


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("object.mass", 3.0),
        ("table.mass", 3.0),  # an alias in every scenario
        ("human.stature", 1.6),
        ("agents.human.stature", 1.6),
        ("robot.tool.length", 0.2),
        ("task.end.height", 1.3),
        ("duration", 3.0),
        ("refine.on", True),
        ("human.position", (0.1, 0.2)),
    ],
)
def test_what_replace_writes_value_reads_and_nothing_else_changes(key: str, value: object) -> None:
    changed = DEFAULT.replace({key: value, "task.start.human_distance": None, "task.end.human_distance": None})
    assert changed.value(key) == value
    assert changed.replace({key: DEFAULT.value(key)}) == DEFAULT.replace(
        {"task.start.human_distance": "free", "task.end.human_distance": "free"}
    )


def test_an_object_of_another_name_is_addressed_by_it_too() -> None:
    crate = DEFAULT.replace({"object.name": "crate", "crate.mass": 4.0})
    assert crate.object.name == "crate"
    assert (crate.value("crate.mass"), crate.value("object.mass"), crate.value("table.mass")) == (4.0, 4.0, 4.0)


def test_whole_sections_are_values_too() -> None:
    changed = DEFAULT.replace({"robot.tool": Tool(length=0.0, mass=0.0), "human": DEFAULT.first("person")})
    assert changed.value("robot.tool") == Tool(length=0.0, mass=0.0)
    assert changed.first("person") == DEFAULT.first("person")


def test_numpys_numbers_are_numbers() -> None:
    changed = DEFAULT.replace(
        {"object.mass": np.float32(3.0), "solver.intervals": np.int64(12), "duration": np.int8(3)}
    )
    assert (changed.object.mass, changed.solver.intervals, changed.duration) == (3.0, 12, 3.0)
    assert type(changed.solver.intervals) is int
    with pytest.raises(InputError, match=r"solver\.intervals = 12\.5"):
        DEFAULT.replace({"solver.intervals": np.float64(12.5)})


def test_a_scenario_is_made_in_python_as_in_a_file() -> None:
    made = Scenario(
        name="table5",
        agents={
            "human": Person(stature=1.75, mass=75.0, sex="male"),
            "robot": Robot(model="sawyer"),
        },
        object=Box(mass=2.0, depth=0.45, width=0.31, height=0.02),
        task=Lift(
            standing_distance=1.9,
            start={"height": 0.9, "human_distance": 0.4},
            end={"height": 1.4, "human_distance": 0.4},
        ),
    )
    assert made == DEFAULT
    assert pickle.loads(pickle.dumps(made)) == DEFAULT


def test_a_base_given_in_z_counts_instead_of_the_base_height() -> None:
    raised = DEFAULT.replace({"robot.base": Pose(z=1.1)})
    assert (raised.first("robot").height, raised.first("robot").height_key) == (1.1, "base.z")
    assert (DEFAULT.first("robot").height, DEFAULT.first("robot").height_key) == (0.915, "base_height")


def test_a_scenario_cannot_be_changed_in_place() -> None:
    with pytest.raises(ValidationError, match="frozen"):
        DEFAULT.duration = 3.0
    with pytest.raises(TypeError):
        DEFAULT.agents["human"] = DEFAULT.agents["robot"]  # type: ignore[index]


@pytest.mark.parametrize(
    ("key", "said"),
    [
        ("human.statur", "human.statur: is no entry of the scenario"),
        ("nobody.stature", "nobody.stature: is no entry of the scenario"),
        ("duration.x", "duration.x: is no entry of the scenario"),
    ],
)
def test_a_key_that_leads_nowhere_is_told(key: str, said: str) -> None:
    with pytest.raises(InputError) as caught:
        DEFAULT.value(key)
    assert str(caught.value) == said


def test_entries_are_all_values_by_the_keys_that_help_lists() -> None:
    found, listed = DEFAULT.entries(), dict(DEFAULT.describe())
    assert set(found) <= set(listed)
    unset = {"human.position", "human.heading_deg", "robot.base.x", "robot.base.z", "object.grasps", "obstacles"}
    unset |= {"robot.tool.direction", *(f"robot.{key}" for key in (*OF_MODEL, "grasp_frame"))} - {"robot.tool"}
    assert set(listed) - set(found) - unset == {f"task.{end}.{axis}" for end in ("start", "end") for axis in "xyz"}
    assert (found["human.stature"], found["object.mass"], found["schema"]) == (1.75, 2.0, 2)


def test_texts_of_the_command_line_are_toml_values() -> None:
    texts = ["a.b=3", "a.c=free", 'a.d="x y"', "a.e=[1, 2.5]", "a.f={g=true}", "a.h=1e-3"]
    assert changes_in(texts) == [
        ("a.b", 3),
        ("a.c", "free"),
        ("a.d", "x y"),
        ("a.e", [1, 2.5]),
        ("a.f", {"g": True}),
        ("a.h", 1e-3),
    ]


def test_an_agent_that_is_not_there_is_told_with_those_that_are() -> None:
    with pytest.raises(KeyError, match="there are human, robot; did you mean human"):
        DEFAULT.agents["humen"]
    with pytest.raises(InputError, match="hold no robot"):
        DEFAULT.replace(
            {
                "agents": {"human": DEFAULT.first("person").plain() | {"grasp": "wrench"}},
            }
        ).first("robot")
