"""Robots by name or by file: which is meant, and what is noticed about its data."""

from __future__ import annotations

from pathlib import Path

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.suggestions import did_you_mean, nearest
from liftopt.multibody.robots.data_finding import SEVERITIES, DataFinding
from liftopt.multibody.robots.examination import Examination, examined
from liftopt.multibody.robots.known_arms import known_arms
from liftopt.multibody.robots.known_robot import KnownRobot
from liftopt.multibody.robots.known_sawyer import SAWYER
from liftopt.multibody.robots.weight_findings import WEIGHT


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


def examined_robot(robot: KnownRobot) -> Examination:
    """Return what is noticed about a known robot, as it is known: its base, its grasp frame, what it holds.

    Raises:
        InputError: its file is not installed.
    """
    found = examined(robot.description(), grasp_frame=robot.grasp_frame, base=robot.base, locked=robot.locked)
    if not robot.springs:
        return found
    fix = "the torques of its motors are smaller than those that are computed"
    springs = DataFinding("weight.springs", "warned", "weight", NO_VALUE, robot.springs, fix)
    order = [*(one for one in found.findings if one.code != WEIGHT), springs]
    return Examination(found.chain, tuple(sorted(order, key=lambda one: SEVERITIES.index(one.severity))))
