"""What the lift asks of the robot: payload, reach, and torque, speed and range of its joints between the knots too."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from liftopt.assessment.grasp import cap_findings
from liftopt.assessment.joints import NEAR_LIMIT, Words, joint_findings
from liftopt.assessment.reach import reach_findings
from liftopt.assessment.robot_data import RobotData, data_findings, robot_data
from liftopt.assessment.who import Who
from liftopt.multibody.joint_meanings import joint_meanings
from liftopt.multibody.trajectory import GRAVITY, AgentTrajectory
from liftopt.scenario.robot import Robot
from liftopt.solution.finding import CAUTION, INFO, ROBOT, WARNING, Finding, percent
from liftopt.solution.solution import Solution


def robot_findings(fine: Solution, robot: AgentTrajectory, who: Who) -> Iterator[Finding]:
    """Give what is to be said of a robot in a solution between its knots too; ``who`` is how texts call it."""
    asked = fine.scenario.agents[robot.name]
    assert isinstance(asked, Robot)
    data, meanings = robot_data(asked), joint_meanings(asked.kind, asked.model)
    yield _payload(fine, robot, who, asked.tool.mass, data)
    yield from joint_findings(fine, robot, Words(who, "torque", "torque limit", data.limits_source, meanings=meanings))
    yield from reach_findings(fine, robot, who)
    yield from cap_findings(fine, robot, who)
    yield from data_findings(robot, who, data)


def _payload(fine: Solution, robot: AgentTrajectory, who: Who, tool: float, data: RobotData) -> Finding:
    """Return what the flange bears, gripper and the robot's part of the load, beside what it may carry."""
    # An arm that presses down with more than its gripper weighs is loaded as well.
    gripper = tool + data.hand
    carried = np.abs(gripper + robot.load[:, 2] / GRAVITY)
    k = int(np.argmax(carried))
    own = f"{gripper:g} kg of it the gripper; " if gripper else ""
    bears = f"The {who.told} bears {carried[k]:.2f} kg at {fine.time[k]:.2f} s ({own}vertical grasp force / g)"
    if data.payload is None:
        return Finding(
            f"{ROBOT}.payload",
            INFO,
            f"bears {carried[k]:.2f} kg; its payload is not known",
            f"{bears}. Its payload is not known: whether it may carry that is not judged; give {robot.name}.payload.",
            robot.name, None, float(fine.time[k]), float(carried[k]), None, "kg",
        )  # fmt: skip
    used = float(carried[k]) / data.payload
    return Finding(
        f"{ROBOT}.payload",
        WARNING if used > 1.0 else CAUTION if used >= NEAR_LIMIT else INFO,
        f"{percent(used)} % of its payload of {data.payload:g} kg",
        f"{bears}, {percent(used)} % of its payload of {data.payload:g} kg.",
        robot.name, None, float(fine.time[k]), float(carried[k]), data.payload, "kg", data.payload_source,
    )  # fmt: skip
