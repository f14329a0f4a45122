"""What a report says of robots: which they are, what their joints are called, where their data are from."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from liftopt.assessment.who import in_words, listed, who_is
from liftopt.multibody.robots.catalogue import known_robots
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.scenario.model import Scenario
from liftopt.scenario.robot import Robot
from liftopt.scenario.robot_defaults import SAWYER
from liftopt.viz.who import is_sawyer, robot_of

AN = (*"aeioAEIO", "x", "SO-")  # begin a title that is read with a vowel first; UR is not
OF_TABLE = "the signs of the paper's Table 3, with the manufacturer's joint names"
OF_URDF = "the signs and by the names of its URDF"


def robot_title(robot: Robot) -> str:
    """Return what a robot is: ``"Sawyer robot"``, ``"UR10 (Universal Robots)"``, ``"robot my_arm"``."""
    if robot.model == SAWYER:
        return "Sawyer robot"
    known = known_robots().get(robot.model)
    return f"robot {Path(robot.model).stem}" if known is None else f"{known.title} ({known.maker})"


def a_robot(robot: Robot) -> str:
    """Return ``"a UR10 (Universal Robots)"``, ``"an iCub ..."``."""
    title = robot_title(robot)
    return f"{'an' if title.startswith(AN) else 'a'} {title}"


def joint_words(scenario: Scenario, robot: AgentTrajectory) -> str:
    """Return in which signs, and by which names, a robot's joints are shown."""
    return OF_TABLE if is_sawyer(scenario, robot) else OF_URDF


def table_words(scenario: Scenario, robot: AgentTrajectory) -> str:
    """Return what the names in a robot's table of joints are."""
    if is_sawyer(scenario, robot):
        return (
            "Joints and signs of the paper's Table 3; in brackets the manufacturer's joint, with a minus where its "
            "sign is the opposite."
        )
    return "Joints by the names of the robot's URDF, in its signs."


def models_words(scenario: Scenario, robots: Sequence[AgentTrajectory]) -> str:
    """Return how robots are modelled, a sentence for each; nothing where there are none."""
    words = []
    for robot in robots:
        own = robot_of(scenario, robot)
        what = "a Rethink Sawyer" if own.model == SAWYER else a_robot(own)
        subject = who_is(robot, robots).the
        number = in_words(len(robot.moving_joints))
        words.append(f"{subject[0].upper()}{subject[1:]} is {what} with {number} joints on a fixed base. ")
    return "".join(words)


def data_words(scenario: Scenario, robots: Sequence[AgentTrajectory]) -> str:
    """Return where the data of robots are from, a sentence; nothing where there are none."""
    sources = []
    for robot in robots:
        own = robot_of(scenario, robot)
        source = "the URDF of " + robot_title(own).removeprefix("robot ")
        if own.model == SAWYER:
            source = "the manufacturer's description (Rethink Robotics, sawyer_description)"
        sources.append(source)
    if not sources:
        return ""
    whose = "The robot's" if len(robots) == 1 else "The robots'"
    return f"{whose} kinematics, masses and limits come from {listed(dict.fromkeys(sources))}."
