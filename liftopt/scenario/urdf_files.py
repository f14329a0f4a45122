"""What the URDF of an agent or of the object is called in a result."""

from __future__ import annotations

from liftopt.scenario.fields import ScenarioFields

# Names that users know: of the agents of the shipped scenarios.
FAMILIAR = {("human", "person"): "human_arm.urdf", ("robot", "robot"): "sawyer.urdf"}


def urdf_files(scenario: ScenarioFields) -> dict[str, str]:
    """Return the file name of every agent's URDF and of the object's, by their names."""
    agents = {name: FAMILIAR.get((name, agent.kind), f"{name}.urdf") for name, agent in scenario.agents.items()}
    return agents | {scenario.object.name: f"{scenario.object.name}.urdf"}
