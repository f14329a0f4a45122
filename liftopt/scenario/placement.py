"""Where everybody stands: as given, or the two opposite each other."""

from __future__ import annotations

from typing import NamedTuple

from liftopt.errors import NO_VALUE, InputError
from liftopt.scenario.agents import Person
from liftopt.scenario.fields import ScenarioFields

DISTANCE = "task.standing_distance"


class Stand(NamedTuple):
    """Where an agent stands [m] and which way it faces, from X about Z [deg]."""

    x: float
    y: float
    yaw_deg: float


def lead(scenario: ScenarioFields) -> str:
    """Return the name of the first person, from whose feet distances count; of the first agent if there is none."""
    agents = scenario.agents
    return next((name for name, agent in agents.items() if isinstance(agent, Person)), next(iter(agents)))


def partner(scenario: ScenarioFields) -> str | None:
    """Return the name of who stands opposite the lead: the first robot, or the second agent; None if there is none."""
    others = [name for name in scenario.agents if name != lead(scenario)]
    robots = [name for name in others if scenario.agents[name].kind == "robot"]
    return next(iter([*robots, *others]), None)


def stand_of(scenario: ScenarioFields, name: str) -> Stand:
    """Return where an agent stands.

    Raises:
        InputError: the scenario does not say it, and the agent is none of the two that stand opposite each other.
    """
    agent = scenario.agents[name]
    if isinstance(agent, Person):
        first = name == lead(scenario)
        feet = agent.position or ((0.0, 0.0) if first else (_opposite(scenario, name, "position"), 0.0))
        heading = agent.heading_deg if agent.heading_deg is not None else 0.0 if first else 180.0
        return Stand(*feet, heading)
    base = agent.base
    x = base.x if base.x is not None else _opposite(scenario, name, "base.x")
    return Stand(x, base.y, base.yaw_deg)


def distance_key(scenario: ScenarioFields) -> str | None:
    """Return the key that says how far off the partner stands; None where no one number does."""
    name = partner(scenario)
    if name is None:
        return None
    agent = scenario.agents[name]
    if isinstance(agent, Person):
        return DISTANCE if agent.position is None else None
    return DISTANCE if agent.base.x is None else f"{name}.base.x"


def _opposite(scenario: ScenarioFields, name: str, key: str) -> float:
    """Return how far ahead of the lead an agent stands who does not say it by its key [m]."""
    if name != partner(scenario):
        raise InputError(f"{name}.{key}", NO_VALUE, "is missing; only the two who face each other have a default place")
    ahead = scenario.task.standing_distance
    if ahead is None:
        raise InputError(DISTANCE, NO_VALUE, f"is missing; must be how far off {name} stands, from 0.5 to 4 m")
    return ahead
