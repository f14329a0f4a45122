"""Obstacles and clearance in a scenario: oracle is what a user wrote, in a file, by name and in Python."""

from __future__ import annotations

from pathlib import Path

import pytest

from liftopt.errors import InputError
from liftopt.scenario.model import load_scenario, scenario_from_dict
from liftopt.scenario.obstacles import Obstacle

DEFAULT = load_scenario()
TWO = """
[[obstacles]]
name = "shelf"
box = [0.4, 1.2, 0.14]
position = [0.6, 0, 0.5]

[[obstacles]]
box = [1.2, 0.8, 0.144]
position = [0.9, 0.0, 0.0]
yaw_deg = 90
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a scenario that has two obstacles."""
    made = tmp_path_factory.mktemp("obstacles")
    (made / "shelves.toml").write_text(DEFAULT.to_toml() + TWO, encoding="utf-8")
    return made


def test_a_file_keeps_its_obstacles(folder: Path) -> None:
    scenario = load_scenario(folder / "shelves.toml")
    assert scenario.obstacles == (
        Obstacle(name="shelf", box=(0.4, 1.2, 0.14), position=(0.6, 0.0, 0.5)),
        Obstacle(name="obstacle_2", box=(1.2, 0.8, 0.144), position=(0.9, 0.0, 0.0), yaw_deg=90.0),
    )
    assert scenario_from_dict(scenario.to_dict()) == scenario
    assert DEFAULT.replace({"obstacles": list(scenario.obstacles)}) == scenario
    assert "obstacles" not in DEFAULT.to_dict()


def test_an_obstacle_is_addressed_by_its_name(folder: Path) -> None:
    moved = load_scenario(folder / "shelves.toml", ["obstacles.shelf.position=[0.7, 0, 0.5]"])
    assert moved.value("obstacles.shelf.position") == (0.7, 0.0, 0.5)
    assert moved.entries()["obstacles.obstacle_2.yaw_deg"] == 90.0
    back = moved.replace({"obstacles.shelf.position": [0.6, 0.0, 0.5]})
    assert back == load_scenario(folder / "shelves.toml")


def test_clearance_is_a_length_or_off() -> None:
    assert DEFAULT.limits.clearance == 0.0
    assert DEFAULT.replace({"limits.clearance": 0.01}).limits.clearance == 0.01
    off = load_scenario("table5", ["limits.clearance=off"])
    assert off.limits.clearance is None
    assert 'clearance = "off"' in off.to_toml()
    assert scenario_from_dict(off.to_dict()) == off


BOX = {"box": [1.0, 1.0, 1.0], "position": [0.0, 0.0, 0.0]}


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("limits.clearance", -0.01, 'limits.clearance = -0.01: must be a number from 0 to 1 m, or "off"'),
        ("limits.clearance", "OFF", "; write off"),
        ("obstacles", 3, "obstacles = 3: must be tables [[obstacles]] of box, position, yaw_deg and name"),
        ("obstacles", [{"box": [1.0, 1.0]}], "obstacles.obstacle_1.box = [1.0, 1.0]: must be three lengths"),
        ("obstacles", [{"box": [1.0, 1.0, 1.0]}], "obstacles.obstacle_1.position: is missing; must be three numbers"),
        ("obstacles", [BOX | {"name": "wall", "box": [1.0, 1.0, 0.0]}], "obstacles.wall.box = 0.0: must be three"),
        ("obstacles", [BOX | {"yaw": 3.0}], "obstacles.obstacle_1.yaw = 3.0: unknown key; known here: name, box,"),
        ("obstacles", [BOX | {"name": "a b"}], "obstacles.name = 'a b': must be 1 to 32 letters"),
        ("obstacles", [BOX | {"name": "human"}], "obstacles.name = 'human': is the name of something else"),
        ("obstacles", [BOX | {"name": "floor"}], "obstacles.name = 'floor': is the name of something else"),
        ("obstacles", [BOX | {"name": "a"}, BOX | {"name": "a"}], "obstacles.name = 'a': is the name of something"),
        ("obstacles.shelf.box", [1, 1, 1], "obstacles.shelf.box = [1, 1, 1]: there is no obstacle 'shelf'"),
    ],
)
def test_what_is_wrong_is_told_by_its_key(key: str, value: object, said: str) -> None:
    with pytest.raises(InputError) as caught:
        DEFAULT.replace({key: value})
    assert said in str(caught.value)
