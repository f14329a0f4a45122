"""What the lift asks of the robot: payload, and torque, speed and range of its joints between the knots too."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from liftopt.assessment.grasp import cap_findings
from liftopt.assessment.joints import NEAR_LIMIT, Words, joint_findings
from liftopt.multibody.robots import sawyer_description
from liftopt.multibody.sources import Source
from liftopt.solution.finding import CAUTION, INFO, ROBOT, WARNING, Finding, percent
from liftopt.solution.solution import Solution
from liftopt.solution.summary import GRAVITY

# By the model of the scenario: its payload [kg], where that is from, and where its joints' limits are from.
DATA: dict[str, tuple[float, Source, Source]] = {
    "sawyer": (sawyer_description.PAYLOAD, sawyer_description.PAYLOAD_SOURCE, sawyer_description.SOURCE)
}


def robot_findings(fine: Solution) -> Iterator[Finding]:
    """Give what is to be said of the robot in a solution between its knots too."""
    robot, (payload, payload_source, source) = fine.agents[1], DATA[fine.scenario.first("robot").model]
    yield _payload(fine, payload, payload_source)
    yield from joint_findings(fine, robot, Words(ROBOT, "torque", "torque limit", source.told, {}, {}, {}))
    yield from cap_findings(fine, robot, ROBOT)


def _payload(fine: Solution, payload: float, source: Source) -> Finding:
    """Return what the flange bears, gripper and the robot's part of the load, beside what it may carry."""
    robot, tool = fine.agents[1], fine.scenario.first("robot").tool.mass
    # An arm that presses down with more than its gripper weighs is loaded as well.
    carried = np.abs(tool + robot.grasp_force[:, 2] / GRAVITY)
    k = int(np.argmax(carried))
    used = float(carried[k]) / payload
    text = (
        f"The robot bears {carried[k]:.2f} kg at {fine.time[k]:.2f} s ({tool:g} kg of it the gripper; vertical grasp "
        f"force / g), {percent(used)} % of its payload of {payload:g} kg"
    )
    return Finding(
        f"{ROBOT}.payload",
        WARNING if used > 1.0 else CAUTION if used >= NEAR_LIMIT else INFO,
        f"{percent(used)} % of its payload of {payload:g} kg",
        f"{text}.",
        robot.name, None, float(fine.time[k]), float(carried[k]), payload, "kg", source.told,
    )  # fmt: skip
