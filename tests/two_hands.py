"""A small agent with two arms on one trunk, and the box that it holds: what tests of several grasps run on."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from liftopt.multibody.agent import Agent, Comfort, Grasp, HalfSpace, JointLimits, Stance
from liftopt.multibody.urdf import load_model

TRUNK = (("yaw", "0 0 1", "0 0 1.0"), ("pitch", "0 1 0", "0 0 0.1"))
ARM = (
    ("shoulder_pitch", "0 1 0", "0 {side} 0.4"),
    ("shoulder_roll", "1 0 0", "0 0 0"),
    ("shoulder_yaw", "0 0 1", "0 0 -0.1"),
    ("elbow", "0 1 0", "0 0 -0.2"),
    ("wrist", "0 1 0", "0 0 -0.25"),
)
SIDES = {"left": 0.2, "right": -0.2}
BODY = (
    '<inertial><mass value="{mass}"/><origin xyz="0.01 0.0 {com}"/>'
    '<inertia ixx="0.02" iyy="0.03" izz="0.01" ixy="0.001" ixz="0" iyz="-0.001"/></inertial>'
)
# Bent elbows with the hands ahead, by joint.
POSTURE = {"shoulder_pitch": -0.6, "elbow": -1.2, "wrist": 0.2}
LOOK_AHEAD = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])


def two_handed_urdf(name: str, x: float = 0.0, y: float = 0.0, yaw: float = 0.0) -> str:
    """Return the agent's URDF; its base is at (x, y) on the floor and faces along X turned by ``yaw`` [rad]."""
    links, joints = ['<link name="world"/>', f'<link name="{name}_base"/>'], []
    joints.append(
        f'<joint name="{name}_stands" type="fixed"><parent link="world"/><child link="{name}_base"/>'
        f'<origin xyz="{x} {y} 0" rpy="0 0 {yaw}"/></joint>'
    )

    def add(joint: str, parent: str, axis: str, at: str, mass: float) -> None:
        links.append(f'<link name="{name}_{joint}_link">{BODY.format(mass=mass, com=-0.08)}</link>')
        joints.append(
            f'<joint name="{name}_{joint}" type="revolute"><parent link="{name}_{parent}"/>'
            f'<child link="{name}_{joint}_link"/><origin xyz="{at}"/><axis xyz="{axis}"/>'
            '<limit lower="-2.6" upper="2.6" effort="200" velocity="6"/></joint>'
        )

    parent = "base"
    for joint, axis, at in TRUNK:
        add(joint, parent, axis, at, 8.0)
        parent = f"{joint}_link"
    for side, offset in SIDES.items():
        above = parent
        for joint, axis, at in ARM:
            add(f"{side}_{joint}", above, axis, at.format(side=offset), 1.0)
            above = f"{side}_{joint}_link"
        links.append(f'<link name="{name}_{side}_grasp"/>')
        joints.append(
            f'<joint name="{name}_{side}_holds" type="fixed"><parent link="{name}_{above}"/>'
            f'<child link="{name}_{side}_grasp"/><origin xyz="0.02 0 -0.12" rpy="0 0.1 0"/></joint>'
        )
    return f'<robot name="{name}">{"".join(links)}{"".join(joints)}</robot>'


def two_handed(
    name: str = "porter", hands: Sequence[str] = ("right", "left"), *, moments: bool = False, stands: bool = False,
    **place: float,
) -> Agent:  # fmt: skip
    """Return the agent, 12 joints, that holds with some of its two hands; with ``moments`` they transmit these too."""
    text = two_handed_urdf(name, **place)
    model = load_model(text)
    ones = np.ones(model.nq)
    joints = [joint.removeprefix(f"{name}_").removeprefix("left_").removeprefix("right_") for joint in model.names[1:]]
    frames = {side: f"{name}_{side}_grasp" for side in ("right", "left")}
    return Agent(
        name=name,
        kind="person",
        urdf=text,
        model=model,
        locked_joints=(),
        grasps=tuple(
            Grasp(f"{name}_{side}", frames[side], moments, 15.0 if moments else 0.0, 1.5, LOOK_AHEAD) for side in hands
        ),
        hands=tuple(frames.values()),
        limits=JointLimits(-2.6 * ones, 2.6 * ones, 6.0 * ones, -150.0 * ones, 200.0 * ones),
        posture=np.array([POSTURE.get(joint, 0.0) for joint in joints]),
        workspace=HalfSpace(np.array([1.0, 0.0, 0.0]), 0.05),
        comfort=Comfort(0.0 * ones, ones, ones, ones, 0.0 * ones),
        stance=Stance(((-0.1, 0.2, 0.2),), 0.5, 2.0, np.array([0.05, 0.0, 0.05])) if stands else None,
    )
