"""Robots by name or by file: which is meant."""

from __future__ import annotations

from pathlib import Path

from liftopt.errors import InputError
from liftopt.files.suggestions import did_you_mean, nearest
from liftopt.multibody.robots.known_arms import known_arms
from liftopt.multibody.robots.known_robot import KnownRobot
from liftopt.multibody.robots.known_sawyer import SAWYER


def known_robots() -> dict[str, KnownRobot]:
    """Return all robots that are known by name, installed or not."""
    return {robot.name: robot for robot in (SAWYER, *known_arms())}


def known_or_path(word: str) -> KnownRobot | Path:
    """Return the robot of a name, or the path of an existing file.

    Raises:
        InputError: it is neither.
    """
    known = known_robots()
    if word in known:
        return known[word]
    path = Path(word)
    try:
        exists = path.exists()
    except (OSError, ValueError):  # too long for a name, or with a NUL
        exists = False
    if exists:
        return path
    meant = did_you_mean(nearest(word, known, 3))
    raise InputError("robot", word, f"must be a name that `liftopt robots` lists, or a URDF or xacro file{meant}")
