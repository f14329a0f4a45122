"""A robot from outside as an agent that holds the object."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pinocchio as pin

from liftopt.errors import InputError
from liftopt.multibody.agent import Agent, Grasp, JointLimits
from liftopt.multibody.bounds import checked_number
from liftopt.multibody.robots.chain import RobotChain
from liftopt.multibody.robots.description import RobotDescription
from liftopt.multibody.robots.examination import AMBIGUOUS, examined
from liftopt.multibody.robots.given_limits import GivenLimits
from liftopt.multibody.robots.resting_posture import heading, resting_posture
from liftopt.multibody.robots.robot_urdf import robot_urdf
from liftopt.multibody.urdf import load_model
from liftopt.types import Array


def robot_agent(
    description: RobotDescription,
    *,
    name: str,
    T_world_base: Array,
    grasp_frame: str | None = None,
    base: str | None = None,
    tool_length: float = 0.0,
    tool_mass: float = 0.0,
    locked: Mapping[str, float] | None = None,
    limits: Mapping[str, GivenLimits] | None = None,
    posture: Mapping[str, float] | None = None,
) -> Agent:
    """Return a robot as an agent whose base is bolted down; it holds at ``<name>_grasp``, the tool's tip.

    Args:
        description: of the robot, from ``read_robot``.
        name: begins the names of its joints and links.
        T_world_base: (4, 4) placement of its base link.
        grasp_frame: name of the link that carries the tool; None takes the one that is proposed, if it is the only one.
        base: name of the link that is bolted down, by default the root.
        tool_length: from the grasp frame along its z axis [m].
        tool_mass: of the tool [kg].
        locked: positions of joints that are held [rad, m].
        limits: of joints whose URDF has none or wrong ones.
        posture: comfortable positions of its joints by their own names; of those that it does not name, they are
            found (``resting_posture``).

    Raises:
        InputError: a value is wrong, or the data of the robot are such that it cannot lift; it says which.
    """
    checked_number(f"{name}.tool.length", tool_length, 0.0, 1.0, "m")
    checked_number(f"{name}.tool.mass", tool_mass, 0.0, 20.0, "kg")
    found = examined(description, grasp_frame=grasp_frame, base=base, locked=locked, limits=limits)
    for finding in found.findings:
        if finding.severity == "refused" or finding.code == AMBIGUOUS:
            raise finding.refusal(description.source)
    chain = found.chain
    text = robot_urdf(chain, name, T_world_base, tool_length=tool_length, tool_mass=tool_mass)
    model, own, chosen = load_model(text), _limits(chain), _given_posture(chain, dict(posture or {}))
    return Agent(
        name=name,
        kind="robot",
        urdf=text,
        model=model,
        locked_joints=(),
        grasps=(Grasp(name, f"{name}_grasp"),),
        hands=(f"{name}_grasp",),
        limits=own,
        posture=_posture(model, f"{name}_grasp", own, T_world_base, chosen),
    )


def _limits(chain: RobotChain) -> JointLimits:
    effort = np.array([joint.effort for joint in chain.joints], dtype=np.float64)
    return JointLimits(
        q_lower=np.array([ends.lower for ends in chain.ranges]),
        q_upper=np.array([ends.upper for ends in chain.ranges]),
        velocity=np.array([joint.velocity for joint in chain.joints], dtype=np.float64),
        tau_lower=-effort,
        tau_upper=effort,
    )


def _given_posture(chain: RobotChain, given: dict[str, float]) -> Array:
    """Return the positions (n,) that are given, NaN of the other joints."""
    source, names = chain.description.source, [joint.name for joint in chain.joints]
    for name in given:
        if name not in names:
            raise InputError(f"{source}: posture", name, f"must be a joint that moves: {', '.join(names)}")
    return np.array(
        [
            checked_number(f"{source}: posture.{name}", given[name], ends.lower, ends.upper, "rad or m")
            if name in given
            else np.nan
            for name, ends in zip(names, chain.ranges, strict=True)
        ]
    )


def _posture(model: pin.Model, frame: str, limits: JointLimits, T_world_base: Array, given: Array) -> Array:
    if np.isfinite(given).all():
        return given
    return resting_posture(model, frame, limits, heading(T_world_base), given)
