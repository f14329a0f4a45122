"""A robot from outside as an agent that holds the object."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from liftopt.multibody.agent import Agent
from liftopt.multibody.bounds import checked_number
from liftopt.multibody.robots.chain import RobotChain
from liftopt.multibody.robots.description import RobotDescription
from liftopt.multibody.robots.examination import examined, refuse
from liftopt.multibody.robots.given_limits import GivenLimits
from liftopt.multibody.robots.one_turn import turns_further, within_one_turn
from liftopt.multibody.robots.resting_posture import heading
from liftopt.multibody.robots.robot_urdf import robot_urdf
from liftopt.multibody.robots.tool import UNTURNED, likely_direction
from liftopt.multibody.robots.written_robot import written_robot
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
    tool_direction: str | None = UNTURNED,
    tool_turn: float = 0.0,
    locked: Mapping[str, float] | None = None,
    limits: Mapping[str, GivenLimits] | None = None,
    posture: Mapping[str, float] | None = None,
    joint_weights: Mapping[str, float] | None = None,
    sliding: float = 1.0,
    ahead: Array | None = None,
) -> Agent:
    """Return a robot as an agent whose base is bolted down; it holds at ``<name>_grasp``, the tool's tip.

    Args:
        description: of the robot, from ``read_robot``.
        name: begins the names of its joints and links.
        T_world_base: (4, 4) placement of its base link.
        grasp_frame: name of the link that carries the tool; None takes the one that is proposed, if it is the only one.
        base: name of the link that is bolted down, by default the root.
        tool_length: from the grasp frame [m].
        tool_mass: of the tool [kg].
        tool_direction: axis of the grasp frame along which it extends, ``"z"`` or ``"-x"``; z of ``<name>_grasp``. None
            takes the likely one.
        tool_turn: how it is turned about that [rad].
        locked: positions of joints that are held [rad, m].
        limits: of joints whose URDF has none or wrong ones.
        posture: comfortable positions, as ``written_robot`` has them.
        joint_weights: factors in the objective, as there.
        sliding: that factor of joints that slide, as there.
        ahead: (3,) which way is ahead, level, in the world; by default where the base faces.

    Raises:
        InputError: a value is wrong, or the data of the robot are such that it cannot lift; it says which.
    """
    checked_number(f"{name}.tool.length", tool_length, 0.0, 1.0, "m")
    checked_number(f"{name}.tool.mass", tool_mass, 0.0, 20.0, "kg")
    found = examined(description, grasp_frame=grasp_frame, base=base, locked=locked, limits=limits)
    refuse(found, description.source)
    chain, front = found.chain, heading(T_world_base) if ahead is None else ahead

    def written(chain: RobotChain, posture: Mapping[str, float] | None, shapes: bool) -> Agent:
        text = robot_urdf(
            chain,
            name,
            T_world_base,
            tool_length=tool_length,
            tool_mass=tool_mass,
            tool_direction=tool_direction or likely_direction(chain.T_last_grasp),
            tool_turn=tool_turn,
            shapes=shapes,
        )
        return written_robot(
            text, name=name, posture=posture, joint_weights=joint_weights, sliding=sliding, ahead=front
        )

    if turns_further(chain):
        resting = written(chain, posture, shapes=False).posture
        chain = within_one_turn(chain, resting)
        posture = {joint.name: float(at) for joint, at in zip(chain.joints, resting, strict=True)}
    agent = written(chain, posture, shapes=True)
    return replace(agent, remarks=found.findings)
