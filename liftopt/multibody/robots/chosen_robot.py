"""The robot that a scenario's ``model`` leads to: what it is, from which link to which, and what its maker says."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from liftopt.multibody.robots.catalogue import known_or_path
from liftopt.multibody.robots.description import RobotDescription
from liftopt.multibody.robots.examination import Examination, examined, with_springs
from liftopt.multibody.robots.given_limits import GivenLimits
from liftopt.multibody.robots.known_robot import KnownRobot
from liftopt.multibody.robots.public_description import is_public, public_description
from liftopt.multibody.robots.read_robot import NOTHING, read_robot


@dataclass(frozen=True)
class ChosenRobot:
    """A robot that was read, with what is known of it.

    Attributes:
        description: that its URDF gives.
        known: it, where it is known by name.
        base_link, grasp_frame: names of links; None leaves the root, or the frame that is proposed.
        locked: positions of joints that are held [rad, m].
        direction: axis of the grasp frame along which a tool extends; None leaves the likely one.
        front_deg: where its front is, about z from x of its base [deg].
        limits: of joints, in place of its URDF's.
    """

    description: RobotDescription
    known: KnownRobot | None = None
    base_link: str | None = None
    grasp_frame: str | None = None
    locked: Mapping[str, float] = field(default_factory=dict)
    direction: str | None = None
    front_deg: float = 0.0
    limits: Mapping[str, GivenLimits] = field(default_factory=dict)

    def examination(self) -> Examination:
        """Return what is noticed about its data; raises ``InputError`` as ``examined``."""
        found = examined(
            self.description,
            grasp_frame=self.grasp_frame,
            base=self.base_link,
            locked=self.locked,
            limits=self.limits,
        )
        return found if self.known is None or not self.known.springs else with_springs(found, self.known.springs)


def chosen_robot(
    model: str,
    *,
    arguments: Mapping[str, str] = NOTHING,
    grasp_frame: str | None = None,
    base_link: str | None = None,
    locked: Mapping[str, float] | None = None,
    direction: str | None = None,
    limits: Mapping[str, GivenLimits] | None = None,
) -> ChosenRobot:
    """Read a robot; what is not given is as it is known.

    Args:
        model: a known name, that of a public description (``iiwa14_description``), or the path of a URDF or xacro file.
        arguments: of a xacro file.
        grasp_frame: name of a link.
        base_link: name of a link.
        locked: joints that are held, beside those that a known robot holds anyhow [rad, m].
        direction: axis of the grasp frame along which a tool extends; that of a known robot goes with its own frame.
        limits: of joints, in place of its URDF's.

    Raises:
        InputError: there is no such robot, or it cannot be read.
    """
    if is_public(model):
        public = public_description(model)
        model, arguments = str(public.path), {**public.arguments, **arguments}
    known = known_or_path(model)
    if isinstance(known, Path):
        description = read_robot(known, arguments=arguments)
        return ChosenRobot(
            description, None, base_link, grasp_frame, dict(locked or {}), direction, limits=dict(limits or {})
        )
    own = known.direction if grasp_frame in (None, known.grasp_frame) else None
    return ChosenRobot(
        known.description(),
        known,
        base_link or known.base,
        grasp_frame or known.grasp_frame,
        {**known.locked, **(locked or {})},
        direction or own,
        known.front_deg if base_link in (None, known.base) else 0.0,
        dict(limits or {}),
    )
