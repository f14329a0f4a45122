"""Limits of joints that the user gives, or a maker's data sheet, where a URDF has none or wrong ones."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from math import isfinite

from liftopt.errors import InputError
from liftopt.multibody.robots.description import RobotDescription, RobotJoint


@dataclass(frozen=True)
class GivenLimits:
    """Limits of one joint that replace those of its URDF; None leaves what stands there.

    Attributes:
        lower, upper: ends of its range [rad, m].
        velocity: [rad/s, m/s].
        effort: [Nm, N].
    """

    lower: float | None = None
    upper: float | None = None
    velocity: float | None = None
    effort: float | None = None


def with_limits(description: RobotDescription, limits: Mapping[str, GivenLimits]) -> RobotDescription:
    """Return the robot with other limits of some joints; a given range replaces the soft limits too.

    Raises:
        InputError: there is no such joint, or a limit is no number.
    """
    joints = {name: description.joint(name, "limits") for name in limits}
    changed = {name: _changed(joints[name], given, description.source) for name, given in limits.items()}
    return replace(description, joints=tuple(changed.get(joint.name, joint) for joint in description.joints))


def _changed(joint: RobotJoint, given: GivenLimits, source: str) -> RobotJoint:
    said = {entry.name: getattr(given, entry.name) for entry in fields(given)}
    said = {name: value for name, value in said.items() if value is not None}
    for name, value in said.items():
        if not isfinite(value):
            raise InputError(f"{source}: limits.{joint.name}.{name}", value, "must be a number")
    if "lower" in said or "upper" in said:
        said |= {"soft_lower": None, "soft_upper": None}
    return replace(joint, **said)
