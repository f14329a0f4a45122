"""What the URDF of an agent or of the object is called in a result."""

from __future__ import annotations

from liftopt.scenario.model import Scenario


def urdf_files(scenario: Scenario) -> dict[str, str]:
    """Return the file name of every agent's URDF and of the object's, by their names."""
    return {"human": "human_arm.urdf", "robot": "sawyer.urdf", "table": "table.urdf"}
