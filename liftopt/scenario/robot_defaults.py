"""What goes by a robot's model: which tool it has by default, and what another model drops."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from pathlib import Path
from typing import Any

SAWYER = "sawyer"
MODELS = 'a name that "liftopt robots" lists, one of robot_descriptions, or the path of a URDF or xacro file'
FILES = (".urdf", ".xacro", ".xml")
# What another model does not take over, beside the tool: names of joints and links, and what its maker says.
OF_MODEL = (
    "tool", "arguments", "grasp_frame", "base_link", "locked", "limits", "payload", "counterbalanced", "posture",
    "joint_weights",
)  # fmt: skip
NO_TOOL = {"length": 0.0, "mass": 0.0}


def is_file(model: str) -> bool:
    """Whether a model is told by the path of a file, and not by a name."""
    return "/" in model or "\\" in model or Path(model).suffix.lower() in FILES


def with_model(robot: object) -> object:
    """Return a robot's entries with the whole path of its file and its tool by default: none but Sawyer's."""
    model = robot.get("model") if isinstance(robot, Mapping) else None
    if not isinstance(robot, Mapping) or not isinstance(model, str) or model == SAWYER:
        return robot
    if is_file(model) and "\0" not in model:
        model = str(Path(model).expanduser().absolute())
    return {"tool": dict(NO_TOOL), **robot, "model": model}


def without_model(tables: Mapping[str, Any], changed: Mapping[str, Any]) -> dict[str, Any]:
    """Return a copy of a scenario's tables without what goes by the model of those robots that are to be another.

    Args:
        tables: of the scenario.
        changed: the same after a change.
    """
    copy, after = deepcopy(dict(tables)), _agents(changed)
    for name, agent in _agents(copy).items():
        other = after.get(name)
        if isinstance(agent, dict) and isinstance(other, Mapping) and agent.get("model") != other.get("model"):
            for key in OF_MODEL:
                agent.pop(key, None)
    return copy


def with_files(agents: object, folder: Path) -> object:
    """Return agents' tables in which the relative paths of robots' files count from the folder of a scenario's file."""
    if not isinstance(agents, Mapping):
        return agents
    found = dict(agents)
    for name, agent in agents.items():
        model = agent.get("model") if isinstance(agent, Mapping) else None
        if isinstance(model, str) and is_file(model):
            found[name] = {**agent, "model": str(folder / Path(model).expanduser())}
    return found


def _agents(tables: Mapping[str, Any]) -> Mapping[str, Any]:
    agents = tables.get("agents")
    return agents if isinstance(agents, Mapping) else {}
