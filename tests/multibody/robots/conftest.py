"""A small arm as URDF text, sound unless a test makes a fault in it."""

from __future__ import annotations

from collections.abc import Callable

import pytest

LINK = """<link name="{name}"><inertial><origin xyz="0 0 0.1"/><mass value="{mass}"/>
<inertia ixx="{ixx}" iyy="0.02" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
JOINT = """<joint name="{name}" type="{kind}"><origin xyz="0 0 0.3" rpy="0.1 0.2 0.3"/><parent link="{parent}"/>
<child link="{child}"/><axis xyz="{axis}"/><limit lower="{lower}" upper="{upper}" effort="{effort}" velocity="2"/>
{extra}</joint>"""
FRAME = """<link name="{name}"/><joint name="{name}_mount" type="fixed"><origin xyz="0 0 0.1"/><parent link="{parent}"/>
<child link="{name}"/></joint>"""


@pytest.fixture
def arm() -> Callable[..., str]:
    """Return a function that gives the arm: joints j1 to j4, links l1 to l4, the frame ``tool0`` and a finger."""

    def text(*faults: tuple[str, str]) -> str:
        parts = ['<link name="base"/>']
        for number, axis in enumerate(("0 0 1", "0 1 0", "0 1 0", "1 0 0"), start=1):
            parent = f"l{number - 1}" if number > 1 else "base"
            parts.append(LINK.format(name=f"l{number}", mass=f"{5 - number}.0", ixx=f"0.02{number}"))
            parts.append(
                JOINT.format(name=f"j{number}", kind="revolute", parent=parent, child=f"l{number}", axis=axis,
                             lower=-2.5, upper=f"2.{number}", effort=f"{100 - number}", extra="")
            )  # fmt: skip
        parts.append(FRAME.format(name="tool0", parent="l4"))
        parts.append(LINK.format(name="finger", mass="0.1", ixx="0.02"))
        parts.append(
            JOINT.format(name="finger_joint", kind="prismatic", parent="l4", child="finger", axis="1 0 0", lower="0.01",
                         upper="0.05", effort="20", extra="")
        )  # fmt: skip
        made = f'<robot name="arm">{"".join(parts)}</robot>'
        for sound, faulty in faults:
            assert sound in made, sound
            made = made.replace(sound, faulty)
        return made

    return text
