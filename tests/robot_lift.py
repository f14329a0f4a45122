"""A cheap lift with a robot from outside, and a small robot whose first joint slides."""

from __future__ import annotations

UR10 = """
schema = 2
name = "ur10"
duration = 2.0
agents.human = { kind = "person", stature = 1.75, mass = 75.0, sex = "male" }
agents.robot = { kind = "robot", model = "ur10", base_height = 0.8 }
object = { name = "box", mass = 3.0, depth = 0.4, width = 0.3, height = 0.2 }
solver = { intervals = 10, starts = 1, time_limit = 3600.0 } # however busy the machine is

[task]
standing_distance = 1.6
start = { height = 0.8, human_distance = 0.4 }
end = { height = 1.1, human_distance = 0.4 }
"""
LINK = """<link name="{child}"><inertial><origin xyz="{com}"/><mass value="{mass}"/>
<inertia ixx="0.03" iyy="0.03" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="{name}" type="{kind}"><origin xyz="{origin}"/><parent link="{parent}"/><child link="{child}"/>
<axis xyz="{axis}"/><limit lower="{lower}" upper="{upper}" effort="{effort}" velocity="{velocity}"/></joint>
"""
# Name, kind, origin, axis, centre of mass, mass, range, effort and speed of each joint and the link that it moves.
JOINTS = (
    ("column", "prismatic", "0 0 0.2", "0 0 1", "0 0 0.1", 8.0, (0.0, 0.5), 900.0, 0.4),
    ("turn", "revolute", "0 0 0.3", "0 0 1", "0 0 0.05", 3.0, (-2.9, 2.9), 120.0, 2.0),
    ("shoulder", "revolute", "0 0 0.1", "0 1 0", "0 0 0.2", 3.0, (-2.5, 2.5), 120.0, 2.0),
    ("elbow", "revolute", "0 0 0.45", "0 1 0", "0 0 0.2", 2.0, (-2.6, 2.6), 90.0, 2.0),
    ("bend", "revolute", "0 0 0.45", "0 1 0", "0 0 0.05", 1.0, (-2.5, 2.5), 40.0, 3.0),
    ("swing", "revolute", "0 0 0.1", "1 0 0", "0 0 0.05", 1.0, (-2.5, 2.5), 40.0, 3.0),
    ("roll", "revolute", "0 0 0.08", "0 0 1", "0 0 0.03", 0.5, (-3.0, 3.0), 30.0, 3.0),
)


def column_robot() -> str:
    """Return the URDF of an arm on a lifting column, which reaches 1 m ahead of it; it holds at ``tool0``."""
    text, parent = '<robot name="on_a_column"><link name="base"/>', "base"
    for name, kind, origin, axis, com, mass, (lower, upper), effort, velocity in JOINTS:
        text += LINK.format(
            name=name, kind=kind, origin=origin, axis=axis, com=com, mass=mass, lower=lower, upper=upper, effort=effort,
            velocity=velocity, parent=parent, child=f"{name}_link",
        )  # fmt: skip
        parent = f"{name}_link"
    flange = '<joint name="flange" type="fixed"><origin xyz="0 0 0.08"/><parent link="roll_link"/><child link="tool0"/>'
    return f'{text}<link name="tool0"/>{flange}</joint></robot>'


def on_a_column(file: str) -> str:
    """Return a scenario for the robot of ``column_robot``, whose URDF is the file."""
    model = f'"{file}", grasp_frame = "tool0", base_height = 0.0'
    return UR10.replace('"ur10"', '"column"', 1).replace('"ur10", base_height = 0.8', model)
