"""Sawyer among the robots that are known by name: liftopt has it itself."""

from __future__ import annotations

from liftopt.multibody.placement import Placement
from liftopt.multibody.robots.known_robot import KnownRobot
from liftopt.multibody.robots.sawyer import NAME, VIRTUAL, sawyer_agent
from liftopt.multibody.robots.sawyer_description import PAYLOAD, PAYLOAD_SOURCE
from liftopt.multibody.urdf import joint_name

HEIGHT = 0.915  # of the arm's base on its pedestal [m]


def _urdf() -> str:
    return sawyer_agent(place=Placement(), base_height=HEIGHT, tool_length=0.0, tool_mass=0.0).urdf


SAWYER = KnownRobot(
    name="sawyer",
    title="Sawyer on its pedestal",
    maker="Rethink Robotics",
    file="",
    base="world",
    grasp_frame=f"{NAME}_grasp",
    locked={joint_name(NAME, row): 0.0 for row in VIRTUAL},
    payload=PAYLOAD,
    payload_source=PAYLOAD_SOURCE,
    own_urdf=_urdf,
)
