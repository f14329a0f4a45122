"""What is known of a robot beside its model: what its maker says, and what is noticed about the data of its URDF."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from liftopt.assessment.who import Who
from liftopt.multibody.robots.catalogue import known_robots
from liftopt.multibody.robots.data_finding import alike, told_together
from liftopt.multibody.robots.known_robot import KnownRobot
from liftopt.multibody.robots.sawyer_description import SOURCE
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.scenario.robot import Robot
from liftopt.scenario.robot_defaults import SAWYER
from liftopt.solution.finding import CAUTION, INFO, ROBOT, Finding

GIVEN = "the scenario"
SEVERITIES = {"refused": CAUTION, "warned": CAUTION, "assumed": INFO}
# Of parts that do not move and of pictures: no result rests on them.
HARMLESS = ("mass.base", "meshes.missing")
TITLES = {CAUTION: "data to check: {where}", INFO: "assumed: {where}"}


@dataclass(frozen=True)
class RobotData:
    """What its maker, or the scenario, says of a robot.

    Attributes:
        payload: what it may carry, its tool included [kg]; None where nobody says.
        payload_source, limits_source: where that, and the limits of its joints, are from.
        hand: mass of a hand in its URDF that counts towards the payload [kg].
        springs: what bears part of its weight beside its motors, in words; empty where nothing does.
    """

    payload: float | None
    payload_source: str
    limits_source: str
    hand: float = 0.0
    springs: str = ""


def robot_data(asked: Robot) -> RobotData:
    """Return what is known of the robot of a scenario; no file of its maker is read."""
    known = known_robots().get(asked.model)
    payload, source = (None, "") if known is None else (known.payload, "")
    if known is not None and known.payload_source is not None:
        source = known.payload_source.told
    if asked.payload is not None:
        payload, source = asked.payload, f"payload of {GIVEN}"
    limits = SOURCE.told if asked.model == SAWYER else _limits_source(asked, known)
    springs = "" if known is None else known.springs
    if asked.counterbalanced is not None:
        springs = (springs or "springs or counterweights bear part of its weight") if asked.counterbalanced else ""
    return RobotData(payload, source, limits, 0.0 if known is None else known.hand, springs)


def _limits_source(asked: Robot, known: KnownRobot | None) -> str:
    source = "limits of the robot's URDF" if known is None else f"limits of the URDF of {known.title}, {known.maker}"
    given = ", ".join(asked.limits)
    return f"{source}; of {given} those of {GIVEN}" if given else source


def data_findings(robot: AgentTrajectory, who: Who, data: RobotData) -> Iterator[Finding]:
    """Give what bears part of a robot's weight, and what was noticed about its URDF as it was read."""
    if data.springs:
        yield Finding(
            f"{ROBOT}.springs",
            CAUTION,
            "its motors have less to bear than computed",
            f"In the {who.told} {data.springs}: its motors' torques are smaller than those that are computed.",
            robot.name,
        )
    for group in alike(robot.remarks):
        first, others = group[0], group[1:]
        severity = INFO if first.code in HARMLESS else SEVERITIES[first.severity]
        where = first.where + (f" and {len(others)} more" if others else "")
        yield Finding(
            f"{ROBOT}.data",
            severity,
            TITLES[severity].format(where=where),
            f"Data of the {who.told}: {told_together(group)}.",
            robot.name,
        )
