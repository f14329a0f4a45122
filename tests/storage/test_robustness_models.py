"""Models made to harm, in a solution.nc with a checksum that fits: one line on stderr; nothing is written or run."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

MODEL = "urdf_robot"


def _bomb(text: str) -> str:
    entities = "".join(f'<!ENTITY a{i + 1} "{f"&a{i};" * 10}">' for i in range(12))
    return text.replace("<robot", f'<!DOCTYPE robot [<!ENTITY a0 "a">{entities}]><robot', 1).replace(
        'name="robot_base"', 'name="&a12;"', 1
    )


def _nested(text: str) -> str:
    return text.replace("</robot>", "<link>" * 30_000 + "</link>" * 30_000 + "</robot>")


def _swapped(old: str, new: str) -> Callable[[str], str]:
    def change(text: str) -> str:
        assert old in text
        return text.replace(old, new)

    return change


HOSTILE_MODEL: dict[str, Callable[[str], str]] = {
    "entities": _bomb,
    "a file as an entity": lambda text: text.replace(
        "<robot", '<!DOCTYPE robot [<!ENTITY a SYSTEM "/etc/passwd">]><robot', 1
    ),
    "a mesh": _swapped("<sphere radius", '<mesh filename="/etc/passwd" radius'),
    "a texture": _swapped("<color rgba", '<texture filename="/etc/passwd"/><color rgba'),
    "nested": _nested,
    "not a number": _swapped('xyz="0.0 0.0 0.0"', 'xyz="0.0 nan 0.0"'),
    "an infinite mass": lambda text: text.replace('<mass value="', '<mass value="1e999', 1),
    "an enormous limit": lambda text: text.replace('effort="', 'effort="9e99', 1),
    "a floating joint": _swapped('type="revolute"', 'type="floating"'),
    "a loop": _swapped('<child link="robot_grasp"/>', '<child link="robot_base"/>'),
    "a link of itself": _swapped('<child link="robot_grasp"/>', '<child link="world"/>'),
    "a parent that is none": _swapped('<parent link="world"/>', '<parent link="nobody"/>'),
    "two of one name": _swapped('<link name="robot_grasp"/>', '<link name="robot_base"/>'),
    "another robot": lambda text: '<robot name="a"><link name="world"/></robot>',
    "another XML": lambda text: "<html/>",
    "a name to run": _swapped('name="liftopt_robot"', 'name="&lt;script&gt;"'),
    "a plug-in": lambda text: text.replace("</robot>", '<gazebo><plugin filename="libx.so"/></gazebo></robot>'),
    "large": lambda text: text.replace("</robot>", " " * 1_000_000 + "</robot>"),
    "nothing": lambda text: "",
}


@pytest.mark.parametrize("case", HOSTILE_MODEL)
def test_a_hostile_model_is_refused(
    case: str, folder: Path, refused: Callable[[list[str]], str], retext: Callable[..., None]
) -> None:
    retext(folder, MODEL, HOSTILE_MODEL[case])
    line = refused(["view", str(folder), "--html", str(folder.parent / "page.html")])
    assert line
    assert line.strip().isprintable()
    assert len(line) < 1000
