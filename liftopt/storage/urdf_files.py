"""Under which names the models of a lift are written to files."""

from __future__ import annotations

from liftopt.scenario.model import Scenario


def urdf_files(scenario: Scenario) -> dict[str, str]:
    """Return the file name of every model by the name of its agent or object."""
    return {"human": "human_arm.urdf", "robot": "sawyer.urdf", "table": "table.urdf"}
