"""A robot that is known by name: which file describes it, where it holds, and what its maker says it lifts."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from liftopt.errors import NO_VALUE, InputError
from liftopt.multibody.robots.description import RobotDescription
from liftopt.multibody.robots.example_robot_data import PACKAGE, share_folder
from liftopt.multibody.robots.read_robot import read_robot
from liftopt.multibody.robots.xacro_text import INSTALL
from liftopt.multibody.sources import Source


@dataclass(frozen=True)
class KnownRobot:
    """One robot, or one arm of a robot.

    Attributes:
        name: by which it is known here.
        title, maker: what it is, and whose.
        file: of its URDF, in the folder ``robots`` of example-robot-data; empty for one that liftopt has itself.
        base, grasp_frame: names of links; with the other arm's frame the same file is another entry.
        locked: joints between them that are held, with their positions [rad, m].
        payload: that its maker publishes [kg], or None where none is known here.
        payload_source: of the payload.
        direction: axis of the grasp frame that points away from the robot (``"-x"`` ...); None: the likely one.
        front_deg: where its front is, about z from x of its base [deg].
        hand: mass of a hand that its URDF has and that counts towards the payload [kg].
        springs: what bears part of its weight beside its motors, in words; its torques are smaller than computed.
        y_up: whether its meshes are meant to be turned as they state, see ``read_robot``.
        own_urdf: writes the URDF of one that liftopt has itself.
    """

    name: str
    title: str
    maker: str
    file: str
    base: str
    grasp_frame: str
    locked: Mapping[str, float] = field(default_factory=dict)
    payload: float | None = None
    payload_source: Source | None = None
    direction: str | None = None
    front_deg: float = 0.0
    hand: float = 0.0
    springs: str = ""
    y_up: bool = False
    own_urdf: Callable[[], str] | None = None

    @property
    def path(self) -> Path | None:
        """Its URDF, or None where it is not installed."""
        share = share_folder()
        path = None if share is None or not self.file else share / "robots" / self.file
        return path if path is not None and path.is_file() else None

    @property
    def is_installed(self) -> bool:
        """Whether it can be read."""
        return self.own_urdf is not None or self.path is not None

    def description(self) -> RobotDescription:
        """Return what its URDF describes.

        Raises:
            InputError: it is not installed.
        """
        if self.own_urdf is not None:
            return read_robot(self.own_urdf())
        if self.path is None:
            raise InputError(self.name, NO_VALUE, f"{PACKAGE} has this robot and is not installed: {INSTALL}")
        return read_robot(self.path, y_up=self.y_up)
