"""What the URDF of an agent or of the object is called in a result."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from liftopt.scenario.model import Scenario

# Names that users know: of the agents of the shipped scenarios.
FAMILIAR = {("human", "person"): "human_arm.urdf", ("robot", "robot"): "sawyer.urdf"}


def urdf_files(scenario: Scenario) -> dict[str, str]:
    """Return the file name of every agent's URDF and of the object's, by their names."""
    agents = {name: FAMILIAR.get((name, agent.kind), f"{name}.urdf") for name, agent in scenario.agents.items()}
    return agents | {scenario.object.name: f"{scenario.object.name}.urdf"}
