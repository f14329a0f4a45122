"""Descriptions of the package robot_descriptions. Oracle: a package of that shape with a folder as its cache."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

pytest.importorskip("yourdfpy")

from liftopt.errors import InputError
from liftopt.multibody.robots.chosen_robot import chosen_robot
from liftopt.multibody.robots.public_description import public_description
from liftopt.scenario.model import load_scenario

MODULE = """from ._cache import clone_to_cache as _clone_to_cache
REPOSITORY_PATH = _clone_to_cache(
    "{repository}",
    commit=None,
)
{path} = REPOSITORY_PATH + "/{file}"
{more}
"""
CACHE = """import os
from ._repositories import REPOSITORIES
def clone_to_cache(name, commit=None):
    return os.path.join(os.environ["ROBOT_DESCRIPTIONS_CACHE"], REPOSITORIES[name].cache_path)
"""
XACRO = """<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="kind" default="short"/>
<link name="$(arg kind)"/></robot>"""


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arm: Callable[..., str]) -> Path:
    """Make the package and its cache, which has one of two repositories."""
    for name in [name for name in sys.modules if name.partition(".")[0] == "robot_descriptions"]:
        monkeypatch.delitem(sys.modules, name)
    inside = tmp_path / "site" / "robot_descriptions"
    inside.mkdir(parents=True)
    (inside / "__init__.py").write_text("")
    (inside / "_cache.py").write_text(CACHE)
    (inside / "_repositories.py").write_text(
        "class R:\n    def __init__(self, path): self.cache_path = path\n"
        "REPOSITORIES = {'here': R('here_repository'), 'away': R('away_repository')}\n"
    )
    for name, repository, path, file, more in (
        ("arm_description", "here", "URDF_PATH", "arm.urdf", ""),
        ("long_description", "here", "XACRO_PATH", "arm.urdf.xacro", "XACRO_ARGS = {'kind': 'long'}"),
        ("away_description", "away", "URDF_PATH", "arm.urdf", ""),
        ("mujoco_description", "here", "MJCF_PATH", "arm.xml", ""),
    ):
        (inside / f"{name}.py").write_text(MODULE.format(repository=repository, path=path, file=file, more=more))
    cached = tmp_path / "cache" / "here_repository"
    cached.mkdir(parents=True)
    (cached / "arm.urdf").write_text(arm())
    (cached / "arm.urdf.xacro").write_text(XACRO)
    monkeypatch.syspath_prepend(str(tmp_path / "site"))
    monkeypatch.setenv("ROBOT_DESCRIPTIONS_CACHE", str(tmp_path / "cache"))
    return tmp_path


def test_a_description_in_the_cache_is_read(package: Path) -> None:
    assert chosen_robot("arm_description", grasp_frame="tool0").description.name == "arm"
    scenario = load_scenario("table5", {"robot.model": "arm_description", "robot.grasp_frame": "tool0"})
    assert scenario.to_dict()["agents"]["robot"]["model"] == "arm_description"


def test_arguments_of_the_package_are_those_of_its_xacro_file(package: Path) -> None:
    pytest.importorskip("xacro")
    assert [link.name for link in chosen_robot("long_description").description.links] == ["long"]
    named = chosen_robot("long_description", arguments={"kind": "mine"}).description
    assert [link.name for link in named.links] == ["mine"]


@pytest.mark.parametrize(
    ("name", "told"),
    [
        (
            "away_description",
            "is not in the cache of robot_descriptions; this fetches it: robot_descriptions pull away_d",
        ),
        ("arn_description", "robot_descriptions has no such description; did you mean arm_description"),
        ("mujoco_description", "robot_descriptions has no URDF or xacro file of it"),
    ],
)
def test_one_that_is_not_there_is_refused_with_what_helps(name: str, told: str, package: Path) -> None:
    with pytest.raises(InputError) as caught:
        public_description(name)
    assert told in str(caught.value)


def test_without_the_package_its_name_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(InputError, match="pip install robot_descriptions"):
        public_description("iiwa14_description")
