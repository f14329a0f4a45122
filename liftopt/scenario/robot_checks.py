"""What the entries of a robot must agree on: its model is known, and has what the others speak of."""

from __future__ import annotations

from liftopt.errors import InputError
from liftopt.files.suggestions import did_you_mean, nearest
from liftopt.scenario.fields import ScenarioFields
from liftopt.scenario.robot import Robot
from liftopt.scenario.robot_defaults import MODELS, SAWYER, is_file

OF_OTHERS = ("arguments", "grasp_frame", "base_link", "locked", "limits", "posture")
STANDS = "must be 0 for sawyer, which stands on its pedestal; another model hangs or leans"


def check_robots(scenario: ScenarioFields) -> None:
    """Raise ``InputError`` where a robot is not known, or its model does not have what an entry speaks of."""
    for name, robot in scenario.agents.items():
        if not isinstance(robot, Robot):
            continue
        if robot.model == SAWYER:
            _check_sawyer(name, robot)
        elif is_file(robot.model):
            if any(character in robot.model for character in "\0\n\r"):
                raise InputError(f"{name}.model", robot.model, f"must be {MODELS} (which robot)")
        else:
            _check_known(name, robot)


def _check_known(name: str, robot: Robot) -> None:
    # With NumPy, which most scenarios are checked without.
    from liftopt.multibody.robots.catalogue import known_robots
    from liftopt.multibody.robots.public_description import is_public

    if is_public(robot.model):
        return
    known = known_robots()
    if robot.model not in known:
        meant = did_you_mean(nearest(robot.model, known, 3))
        raise InputError(f"{name}.model", robot.model, f"must be {MODELS} (which robot){meant}")
    if robot.arguments:
        raise InputError(f"{name}.arguments", dict(robot.arguments), "goes with a xacro file, not with a known name")


def _check_sawyer(name: str, robot: Robot) -> None:
    for key in OF_OTHERS:
        if value := getattr(robot, key):
            shown = value if isinstance(value, str) else ", ".join(value)
            raise InputError(f"{name}.{key}", shown, "goes with other models than sawyer")
    for key in ("roll_deg", "pitch_deg"):
        if value := getattr(robot.base, key):
            raise InputError(f"{name}.base.{key}", value, STANDS)
    if robot.tool.direction not in (None, "z"):
        raise InputError(f"{name}.tool.direction", robot.tool.direction, 'must be "z" for sawyer')
