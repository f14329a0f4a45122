"""Who is who in a picture: how each agent is called, its colour, and what the scenario says of it."""

from __future__ import annotations

from collections.abc import Sequence

from liftopt.multibody.person.subject import Subject
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.scenario.agents import Person, Robot
from liftopt.scenario.build import subject_of
from liftopt.scenario.model import Scenario
from liftopt.viz.scene_part import Colour

# Of arrows and paths, in the order of the agents: after Okabe & Ito (2008), told apart with any common colour vision.
COLOURS: tuple[Colour, ...] = ((0.02, 0.45, 0.70), (0.90, 0.45, 0.0), (0.0, 0.55, 0.40), (0.70, 0.35, 0.58))


def is_only_one(agents: Sequence[AgentTrajectory], agent: AgentTrajectory) -> bool:
    """Return whether nobody else among ``agents`` is of the agent's kind."""
    return sum(other.kind == agent.kind for other in agents) == 1


def called(agents: Sequence[AgentTrajectory], agent: AgentTrajectory) -> str:
    """Return what to call an agent in a sentence: ``"the person"``, or its name where there are several of a kind."""
    return f"the {agent.kind}" if is_only_one(agents, agent) else agent.name


def colour_of(agents: Sequence[AgentTrajectory], agent: AgentTrajectory) -> Colour:
    """Return the colour of an agent's arrow and path."""
    return COLOURS[[other.name for other in agents].index(agent.name) % len(COLOURS)]


def are_a_pair(agents: Sequence[AgentTrajectory]) -> bool:
    """Return whether they are one person and one robot, who stand opposite each other along X."""
    return sorted(agent.kind for agent in agents) == ["person", "robot"]


def body_of(scenario: Scenario, person: AgentTrajectory) -> Subject:
    """Return the body that a person has."""
    who = scenario.agents[person.name]
    assert isinstance(who, Person)
    return subject_of(who)


def robot_of(scenario: Scenario, robot: AgentTrajectory) -> Robot:
    """Return what the scenario says of a robot."""
    who = scenario.agents[robot.name]
    assert isinstance(who, Robot)
    return who
