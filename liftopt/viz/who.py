"""Who is who in a picture: each one's colour, from whom it is looked at, and what the scenario says of a robot."""

from __future__ import annotations

from collections.abc import Sequence

from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.scenario.model import Scenario
from liftopt.scenario.placement import stand_of
from liftopt.scenario.robot import Robot
from liftopt.scenario.robot_defaults import SAWYER
from liftopt.viz.scene_part import Colour

# Of arrows and paths, in the order of the agents: after Okabe & Ito (2008), told apart with any common colour vision.
COLOURS: tuple[Colour, ...] = ((0.02, 0.45, 0.70), (0.90, 0.45, 0.0), (0.0, 0.55, 0.40), (0.70, 0.35, 0.58))


def colour_of(agents: Sequence[AgentTrajectory], agent: AgentTrajectory) -> Colour:
    """Return the colour of an agent's arrow and path."""
    return COLOURS[[other.name for other in agents].index(agent.name) % len(COLOURS)]


def lead_of(agents: Sequence[AgentTrajectory]) -> AgentTrajectory:
    """Return the first person, from whom a picture is looked at; the first agent if there is none."""
    return next((agent for agent in agents if agent.kind == "person"), agents[0])


def stand_opposite(scenario: Scenario) -> bool:
    """Return whether one person who looks along X and one robot straight ahead lift: axes are told by them then."""
    kinds = {agent.kind: stand_of(scenario, name) for name, agent in scenario.agents.items()}
    if len(scenario.agents) != 2 or len(kinds) != 2:
        return False
    person, robot = kinds["person"], kinds["robot"]
    return person.yaw_deg % 360.0 == 0.0 and robot.x > person.x and robot.y == person.y


def robot_of(scenario: Scenario, robot: AgentTrajectory) -> Robot:
    """Return what the scenario says of a robot."""
    who = scenario.agents[robot.name]
    assert isinstance(who, Robot)
    return who


def is_sawyer(scenario: Scenario, robot: AgentTrajectory) -> bool:
    """Return whether a robot is a Sawyer, which is drawn without any file."""
    return robot_of(scenario, robot).model == SAWYER
