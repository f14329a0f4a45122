"""A robot's joints as the robot itself calls and counts them, and as a solution has them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from liftopt.lab.meant import the_robot
from liftopt.multibody.joint_meanings import joint_meanings
from liftopt.multibody.joint_units import JointUnits, units_of
from liftopt.multibody.robots.catalogue import known_robots
from liftopt.scenario.robot import Robot
from liftopt.scenario.robot_defaults import SAWYER
from liftopt.solution.solution import Solution
from liftopt.types import Array


@dataclass(frozen=True)
class JointMap:
    """The n joints that move, in the order of the robot's URDF, by what a result holds: no file of the robot is read.

    A solution names them ``<agent>_<own name>``; Sawyer's are those of the paper's Table 3, whose fourth turns the
    other way round. Limits are in the robot's own signs.

    Attributes:
        model: of the robot, as the scenario names it.
        names: (n,) the robot's own.
        signs: (n,) of the robot's position over the solution's, +1 or -1.
        sliding: (n,) whether a joint slides: its position is in metres and its effort in newtons.
        ends: (2, n) lower and upper end of the range [rad, m].
        speed: (n,) the fastest [rad/s, m/s].
        effort: (2, n) the least and the largest torque or force [Nm, N].
        held: joints that the scenario holds still, with their positions; which of them stand on the way to the grasp a
            result does not tell.
    """

    model: str
    names: tuple[str, ...]
    signs: Array
    sliding: npt.NDArray[np.bool_]
    ends: Array
    speed: Array
    effort: Array
    held: tuple[tuple[str, float], ...]

    @classmethod
    def of(cls, solution: Solution, robot: str | None = None, option: str = "--robot") -> JointMap:
        """Return the joints of a robot.

        Args:
            solution: a lift.
            robot: its name; None where there is only one.
            option: that says the name, for messages.

        Raises:
            InputError: no robot is the one that is meant.
        """
        arm = the_robot(solution, robot, option)
        asked = solution.scenario.agents[arm.name]
        assert isinstance(asked, Robot)
        meanings = joint_meanings(arm.kind, asked.model)
        own = [name.removeprefix(f"{arm.name}_") for name in arm.moving_joints]
        meant = [meanings.get(name, name) for name in own]
        signs = np.array([-1.0 if name.startswith("-") else 1.0 for name in meant])
        limits = arm.limits
        return cls(
            asked.model,
            tuple(name.removeprefix("-") for name in meant),
            signs,
            arm.sliding[arm.moving],
            np.sort(signs * np.stack([limits.q_lower, limits.q_upper]), axis=0),
            limits.velocity,
            np.sort(signs * np.stack([limits.tau_lower, limits.tau_upper]), axis=0),
            _held(asked),
        )

    @property
    def is_sawyer(self) -> bool:
        """Whether it has Sawyer's trajectory action server."""
        return self.model == SAWYER

    @property
    def units(self) -> tuple[JointUnits, ...]:
        """(n,) of the joints."""
        return tuple(units_of(bool(slides)) for slides in self.sliding)

    def with_held(self) -> JointMap:
        """Return it with the joints that are held after those that move, as joints that stay where they are."""
        names, values = tuple(name for name, _ in self.held), np.array([value for _, value in self.held])
        none = np.zeros(len(names))
        return JointMap(
            self.model,
            self.names + names,
            np.append(self.signs, none + 1.0),
            np.append(self.sliding, none > 0.0),
            np.hstack([self.ends, np.stack([values, values])]),
            np.append(self.speed, none),
            np.hstack([self.effort, np.stack([none, none])]),
            (),
        )

    def moves(self, joint: int) -> str:
        """Return the word for what a joint does."""
        return "slides" if self.sliding[joint] else "turns"


def _held(asked: Robot) -> tuple[tuple[str, float], ...]:
    """Return what is held: as the robot is known, and as the scenario says; nothing of Sawyer, whose base is none."""
    if asked.model == SAWYER:
        return ()
    known = known_robots().get(asked.model)
    held = dict(known.locked if known is not None else {}) | dict(asked.locked)
    return tuple((name, float(value)) for name, value in held.items())
