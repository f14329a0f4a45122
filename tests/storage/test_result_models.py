"""Models of a result that are another robot's, another person's or another object's end in one line, however opened.

What counts as the same is judged by hand: each change below is made in one number or name of the URDF text.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from liftopt.commands.cli import main
from liftopt.errors import InputError
from liftopt.multibody.placement import facing
from liftopt.multibody.robots.sawyer import sawyer_agent
from liftopt.storage.reader import load_result

Retext = Callable[..., None]
# Seven hinges and a hand: the outline of another maker's arm.
LINKS = ("world", "panda_link0", *(f"panda_link{i}" for i in range(1, 8)), "robot_grasp")
BODY = (
    '<inertial><origin xyz="0 0 0" rpy="0 0 0"/><mass value="2.0"/>'
    '<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>'
)


def panda() -> str:
    """Return a URDF with the joints of a Franka Panda."""
    joints = []
    for k, (parent, child) in enumerate(pairwise(LINKS)):
        ends = f'<parent link="{parent}"/><child link="{child}"/><origin xyz="0 0 0.2" rpy="0 {k % 2} 0"/>'
        if child.startswith("panda") and k:
            moving = '<axis xyz="0 0 1"/><limit effort="87" velocity="2" lower="-2.8" upper="2.8"/>'
            joints.append(f'<joint name="panda_joint{k}" type="revolute">{ends}{moving}</joint>')
        else:
            joints.append(f'<joint name="{child}_fixed" type="fixed">{ends}</joint>')
    links = "".join(f'<link name="{name}">{BODY if "panda" in name else ""}</link>' for name in LINKS)
    return f'<robot name="panda">{links}{"".join(joints)}</robot>'


def swap(pattern: str, replacement: str) -> Callable[[str], str]:
    """Return a function that replaces a name everywhere in a text, and anything else where it first stands."""

    def swapped(text: str) -> str:
        new, count = re.subn(pattern, replacement, text, count=0 if pattern.startswith('"robot') else 1)
        assert count >= 1
        return new

    return swapped


def words(command: str, folder: Path, out: Path) -> list[str]:
    """Return a command line that opens a result."""
    bag = out / "none.bag"
    return {
        "export": ["export", str(folder), "--out", str(out), "--format", "csv"],
        "dry-run": ["dry-run", str(folder), "--out", str(out)],
        "compare": ["compare", str(folder), "--robot", str(bag), "--out", str(out)],
        "report": ["report", str(folder), "--html", str(out)],
        "plot": ["plot", str(folder), "--out", str(out)],
        "view": ["view", str(folder), "--html", str(out)],
        "crosscheck": ["crosscheck", str(folder)],
    }[command]


@pytest.mark.parametrize("command", ["export", "dry-run", "compare", "report", "plot", "view", "crosscheck"])
def test_another_robot_is_refused_by_every_command(
    command: str, folder: Path, retext: Retext, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for package in ("rosbags", "mujoco") if command in ("dry-run", "crosscheck") else ():
        pytest.importorskip(package, reason=f"{package} is in an extra")
    retext(folder, "urdf_robot", lambda text: panda())
    assert main(words(command, folder, tmp_path / "out")) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "solution.nc: the model of robot is not that of the result's scenario" in error
    assert "its joint 1 is panda_joint1, not robot_GT1 (7 joints, not 10)" in error
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("model", "pattern", "replacement", "told"),
    [
        ("robot", '"robot_Q4"', '"robot_elbow"', "its joint 7 is robot_elbow, not robot_Q4; solve again"),
        ("robot", '"robot_grasp"', '"tip"', "it has no frame robot_grasp"),
        ("human", '0.27029[0-9]+" rpy="-1.57', '0.37029" rpy="-1.57', r"its joint human_Q9 is 0\.100 m and 0 deg"),
        ("human", 'mass value="1.2[0-9]+"', 'mass value="1.9"', r"at human_Q8 has 1\.90 kg, not 1\.2\d kg"),
        (
            "robot",
            'xyz="0.0200067[0-9]+ ',
            'xyz="0.220006787829 ',
            r"at robot_Q1 has its centre of mass 0\.200 m from where it should be",
        ),
        ("table", 'mass value="[0-9.]+"', 'mass value="7.0"', r"has 7\.00 kg, not 2\.00 kg"),
        ("table", '"-0.225 0.0', '"-0.325 0.0', r"its frame grasp_human is 0\.100 m and 0 deg from where it should be"),
    ],
)
def test_what_makes_a_model_anothers(
    folder: Path, retext: Retext, model: str, pattern: str, replacement: str, told: str
) -> None:
    retext(folder, f"urdf_{model}", swap(pattern, replacement))
    with pytest.raises(InputError, match=told):
        load_result(folder)


def test_a_scenario_of_another_lift_with_the_models_is_refused(folder: Path, retext: Retext) -> None:
    retext(folder, "scenario", swap(r"base_height = [0-9.]+", "base_height = 1.2"))
    with pytest.raises(InputError, match=r"the model of robot is not that of the result's scenario: its joint"):
        load_result(folder)


@pytest.mark.parametrize("name", ["human", "robot"])
def test_small_numbers_of_another_version_open(folder: Path, kept: Any, retext: Retext, name: str) -> None:
    """Every length that is not zero 0.4 % longer, every mass 2 % larger."""

    def longer(found: re.Match[str]) -> str:
        return 'xyz="' + " ".join(repr(1.004 * float(number)) for number in found[1].split()) + '" rpy'

    def of_another_version(text: str) -> str:
        text = re.sub(r'xyz="([^"]+)" rpy', longer, text)
        return re.sub(r'mass value="([^"]+)"', lambda m: f'mass value="{1.02 * float(m[1])!r}"', text)

    retext(folder, f"urdf_{name}", of_another_version)
    read = load_result(folder)
    assert read.solved
    assert read.urdfs[name] != kept.solution.urdfs[name]


def test_the_same_robot_is_the_same() -> None:
    """A description read back from its own text is no other robot's."""
    from liftopt.multibody.likeness import difference

    given: dict[str, Any] = dict(place=facing(1.9), base_height=0.9, tool_length=0.15, tool_mass=0.4)
    one = sawyer_agent(**given)
    again, longer = sawyer_agent(**given, urdf=one.urdf), sawyer_agent(**given | {"tool_length": 0.2})
    assert difference(again.model, one.model, ("robot_grasp",)) == ""
    told = difference(longer.model, one.model, ("robot_grasp",))
    assert told == "its frame robot_grasp is 0.050 m and 0 deg from where it should be"
