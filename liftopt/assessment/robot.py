"""What the lift asks of the robot: payload, and torque, speed and range of its joints between the knots too."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from liftopt.assessment.grasp import cap_findings
from liftopt.assessment.joints import NEAR_LIMIT, Words, joint_findings
from liftopt.assessment.who import Who
from liftopt.multibody.joint_meanings import joint_meanings
from liftopt.multibody.robots import sawyer_description
from liftopt.multibody.sources import Source
from liftopt.multibody.trajectory import GRAVITY, AgentTrajectory
from liftopt.scenario.robot import Robot
from liftopt.solution.finding import CAUTION, INFO, ROBOT, WARNING, Finding, percent
from liftopt.solution.solution import Solution


@dataclass(frozen=True)
class RobotData:
    """What a manufacturer says of a robot.

    Attributes:
        payload: what it may carry at the flange [kg].
        payload_source, limits_source: where that, and the limits of its joints, are from.
    """

    payload: float
    payload_source: Source
    limits_source: Source


# By the model of the scenario.
DATA = {"sawyer": RobotData(sawyer_description.PAYLOAD, sawyer_description.PAYLOAD_SOURCE, sawyer_description.SOURCE)}


def robot_findings(fine: Solution, robot: AgentTrajectory, who: Who) -> Iterator[Finding]:
    """Give what is to be said of a robot in a solution between its knots too; ``who`` is how texts call it."""
    asked = fine.scenario.agents[robot.name]
    assert isinstance(asked, Robot)
    data, meanings = DATA.get(asked.model), joint_meanings(asked.kind, asked.model)
    yield _payload(fine, robot, who, asked.tool.mass, data)
    source = "limits of the robot's URDF" if data is None else data.limits_source.told
    yield from joint_findings(fine, robot, Words(who, "torque", "torque limit", source, meanings=meanings))
    yield from cap_findings(fine, robot, who)


def _payload(fine: Solution, robot: AgentTrajectory, who: Who, tool: float, data: RobotData | None) -> Finding:
    """Return what the flange bears, gripper and the robot's part of the load, beside what it may carry."""
    # An arm that presses down with more than its gripper weighs is loaded as well.
    carried = np.abs(tool + robot.load[:, 2] / GRAVITY)
    k = int(np.argmax(carried))
    bears = (
        f"The {who.told} bears {carried[k]:.2f} kg at {fine.time[k]:.2f} s ({tool:g} kg of it the gripper; vertical "
        "grasp force / g)"
    )
    if data is None:
        return Finding(
            f"{ROBOT}.payload",
            INFO,
            f"bears {carried[k]:.2f} kg; its payload is not known",
            f"{bears}. Its payload is not known: whether it may carry that is not judged.",
            robot.name, None, float(fine.time[k]), float(carried[k]), None, "kg",
        )  # fmt: skip
    used = float(carried[k]) / data.payload
    return Finding(
        f"{ROBOT}.payload",
        WARNING if used > 1.0 else CAUTION if used >= NEAR_LIMIT else INFO,
        f"{percent(used)} % of its payload of {data.payload:g} kg",
        f"{bears}, {percent(used)} % of its payload of {data.payload:g} kg.",
        robot.name, None, float(fine.time[k]), float(carried[k]), data.payload, "kg", data.payload_source.told,
    )  # fmt: skip
