"""What the URDF of an agent or of the object is called in a result."""

from __future__ import annotations

from liftopt.scenario.agents import Agent, Person
from liftopt.scenario.fields import ScenarioFields
from liftopt.scenario.robot import Robot
from liftopt.scenario.robot_defaults import SAWYER


def urdf_files(scenario: ScenarioFields) -> dict[str, str]:
    """Return the file name of every agent's URDF and of the object's, by their names."""
    agents = {name: _file(name, agent) for name, agent in scenario.agents.items()}
    return agents | {scenario.object.name: f"{scenario.object.name}.urdf"}


def _file(name: str, agent: Agent) -> str:
    """Return the file name of an agent's URDF: one that users know, of the paper's human and robot, or its own."""
    if name == "human" and isinstance(agent, Person) and agent.body == "arm":
        return "human_arm.urdf"
    is_sawyer = isinstance(agent, Robot) and agent.model == SAWYER
    return "sawyer.urdf" if name == "robot" and is_sawyer else f"{name}.urdf"
