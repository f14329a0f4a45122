"""From a scenario's robot to the agent that holds: Sawyer, or any arm that has a URDF."""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin

from liftopt.errors import InputError
from liftopt.multibody.agent import Agent
from liftopt.multibody.dh import rotation_z
from liftopt.multibody.joint_units import LEVER
from liftopt.multibody.placement import Placement
from liftopt.multibody.robots.chosen_robot import ChosenRobot
from liftopt.multibody.robots.resting_posture import heading
from liftopt.multibody.robots.robot_agent import robot_agent
from liftopt.multibody.robots.sawyer import sawyer_agent
from liftopt.multibody.robots.written_robot import with_joint_weights, written_robot
from liftopt.scenario.model import Scenario
from liftopt.scenario.placement import stand_of
from liftopt.scenario.robot import Robot
from liftopt.scenario.robot_defaults import SAWYER
from liftopt.types import Array

OF_ENTRIES = ("locked", "limits", "grasp_frame", "base_link")


def agent_of_robot(scenario: Scenario, name: str, urdf: str | None = None) -> Agent:
    """Return a robot as an agent with one grasp, which is not yet what the scenario says of it.

    Args:
        scenario: with the robot.
        name: of it.
        urdf: its URDF if it was written before, as a result keeps it; then no file of its maker is read.

    Raises:
        InputError: there is no such robot, its data are such that it cannot lift, or an entry does not go with it.
    """
    robot = scenario.agents[name]
    assert isinstance(robot, Robot)
    if robot.model == SAWYER:
        sawyer = sawyer_agent(
            place=Placement.at(*stand_of(scenario, name)),
            base_height=robot.height,
            tool_length=robot.tool.length,
            tool_mass=robot.tool.mass,
            urdf=urdf,
            name=name,
        )
        return with_joint_weights(sawyer, robot.joint_weights)
    sliding = LEVER**2 if scenario.objective.preset == "paper" else 1.0
    if urdf is not None:
        return written_robot(urdf, name=name, posture=robot.posture, joint_weights=robot.joint_weights, sliding=sliding)
    chosen = chosen_of(robot, name)
    placed = T_world_base_of(scenario, name)
    try:
        return robot_agent(
            chosen.description,
            name=name,
            T_world_base=placed @ rotation_z(-math.radians(chosen.front_deg)),
            grasp_frame=chosen.grasp_frame,
            base=chosen.base_link,
            tool_length=robot.tool.length,
            tool_mass=robot.tool.mass,
            tool_direction=chosen.direction,
            tool_turn=math.radians(robot.tool.turn_deg),
            locked=chosen.locked,
            limits=chosen.limits,
            posture=robot.posture,
            joint_weights=robot.joint_weights,
            sliding=sliding,
            ahead=heading(placed),
        )
    except InputError as error:
        raise _by_entry(error, name, chosen) from None


def is_from_file(scenario: Scenario, name: str) -> bool:
    """Whether an agent's model comes from a file of its maker, and not from liftopt itself."""
    agent = scenario.agents.get(name)
    return isinstance(agent, Robot) and agent.model != SAWYER


def chosen_of(robot: Robot, name: str) -> ChosenRobot:
    """Return the robot that a scenario's entries lead to; it is read. Raises ``InputError`` as ``chosen_robot``."""
    try:
        return robot.chosen()
    except InputError as error:
        if error.key == "robot":  # the name is none that is known, and no file
            raise InputError(f"{name}.model", robot.model, error.allowed) from None
        raise


def T_world_base_of(scenario: Scenario, name: str) -> Array:
    """Return the placement (4, 4) of a robot's base, x where its front is: turned about X, then Y, then Z."""
    robot, stand = scenario.agents[name], stand_of(scenario, name)
    assert isinstance(robot, Robot)
    roll, pitch, yaw = (math.radians(turn) for turn in (robot.base.roll_deg, robot.base.pitch_deg, stand.yaw_deg))
    placed: Array = np.eye(4)
    placed[:3, :3] = pin.rpy.rpyToMatrix(roll, pitch, yaw)
    placed[:3, 3] = stand.x, stand.y, robot.height
    return placed


def _by_entry(error: InputError, name: str, chosen: ChosenRobot) -> InputError:
    """Return an error about an entry of the scenario under its key; others stay as they are."""
    key = error.key.removeprefix(f"{chosen.description.source}: ")
    entry = next((entry for entry in OF_ENTRIES if key != error.key and key.startswith(entry)), None)
    if entry is None:
        return error
    return InputError(f"{name}.{key.replace(f'{entry} ', f'{entry}.', 1)}", error.value, error.allowed)
