"""A robot as a scenario describes it: which one, where it is bolted down, what it holds with, and what differs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, model_validator

from liftopt.files.entries import entry, number
from liftopt.files.frozen_table import FrozenTable
from liftopt.files.section import Section
from liftopt.scenario.agent_fields import FARTHEST, GRASPS, Weight
from liftopt.scenario.presets import NATURAL
from liftopt.scenario.robot_defaults import MODELS, with_model

if TYPE_CHECKING:
    from liftopt.multibody.robots.chosen_robot import ChosenRobot

OF_ROBOT = NATURAL["robot"]  # where the preset is another, a scenario fills in its own
Direction = Literal["x", "-x", "y", "-y", "z", "-z"]
BY_JOINT = "a table of JOINT = {}, joints by the robot's own names"
FARTHEST_JOINT = 100.0  # [rad] or [m]


class Tool(Section):
    """The gripper on the robot's flange; length and mass 0 stand for the bare flange."""

    length: Annotated[float, number("flange to grasp point, along the tool's direction", "m", 0.0, 0.6)] = 0.15
    mass: Annotated[float, number("mass of the gripper", "kg", 0.0, 10.0)] = 0.4
    direction: Annotated[
        Direction | None, entry("axis of the grasp frame that points away from the robot; by default the likely one")
    ] = None
    turn_deg: Annotated[float, number("how it is turned on the flange about its direction", "deg", -360.0, 360.0)] = 0.0


class Pose(Section):
    """Where a robot's base is bolted down and how it is turned; what is left out is as for the default robot."""

    x: Annotated[float | None, number("base along X; by default task.standing_distance", "m", -FARTHEST, FARTHEST)] = (
        None
    )
    y: Annotated[float, number("base along Y", "m", -FARTHEST, FARTHEST)] = 0.0
    z: Annotated[float | None, number("height of the base; by default base_height", "m", 0.0, 4.0)] = None
    roll_deg: Annotated[float, number("turn about X, before the others; 180 hangs it down", "deg", -360.0, 360.0)] = 0.0
    pitch_deg: Annotated[float, number("turn about Y after that; 90 or -90 on a wall", "deg", -360.0, 360.0)] = 0.0
    yaw_deg: Annotated[float, number("which way the robot faces, from X about Z", "deg", -360.0, 360.0)] = 180.0


class LimitsOfJoint(Section):
    """Limits of one joint that replace those of its URDF; what is left out stays."""

    lower: Annotated[float | None, number("begin of its range", "rad or m", -FARTHEST_JOINT, FARTHEST_JOINT)] = None
    upper: Annotated[float | None, number("end of its range", "rad or m", -FARTHEST_JOINT, FARTHEST_JOINT)] = None
    velocity: Annotated[float | None, number("largest speed", "rad/s or m/s", 0.0, 1e3, open_low=True)] = None
    effort: Annotated[float | None, number("largest torque or force", "Nm or N", 0.0, 1e6, open_low=True)] = None


Position = Annotated[float, number("position of a joint", "rad or m", -FARTHEST_JOINT, FARTHEST_JOINT)]
Factor = Annotated[float, number("factor of a joint's squared torque", "", 0.0, 1e6)]


class Robot(Section):
    """A robot that lifts; by default it faces the first person."""

    kind: Annotated[Literal["robot"], entry("what the agent is")] = "robot"
    model: Annotated[str, Field(min_length=1), entry("which robot", MODELS)]
    arguments: Annotated[FrozenTable[str], entry("arguments of a xacro file", 'a table of NAME = "value"')] = (
        FrozenTable()
    )
    grasp_frame: Annotated[
        str | None, Field(min_length=1), entry("link that carries the tool; by default the one known or proposed",
                                               "the name of a link"),
    ] = None  # fmt: skip
    base_link: Annotated[
        str | None, Field(min_length=1), entry("link that is bolted down; by default the root", "the name of a link")
    ] = None
    base_height: Annotated[float, number("height of the robot's base above the floor", "m", 0.0, 2.0)] = 0.915
    base: Pose = Pose()
    locked: Annotated[FrozenTable[Position], entry("joints that are held [rad, m]", BY_JOINT.format("position"))] = (
        FrozenTable()
    )
    tool: Tool = Tool()
    limits: Annotated[
        FrozenTable[LimitsOfJoint],
        entry("limits that replace the URDF's", BY_JOINT.format("{ lower, upper, velocity, effort }")),
    ] = FrozenTable()
    payload: Annotated[
        float | None, number("what it may carry with its tool; by default the maker's", "kg", 0.0, 1e4, open_low=True)
    ] = None
    counterbalanced: Annotated[
        bool | None, entry("whether springs or counterweights bear part of its weight; by default as known")
    ] = None
    posture: Annotated[
        FrozenTable[Position],
        entry("comfortable positions, from which the search starts [rad, m]", BY_JOINT.format("position")),
    ] = FrozenTable()
    joint_weights: Annotated[
        FrozenTable[Factor], entry("factors of joints' squared torques in the objective", BY_JOINT.format("factor"))
    ] = FrozenTable()
    grasp: Annotated[GRASPS, entry("a force at a point, or a gripper that also transmits moments")] = OF_ROBOT["grasp"]
    max_grasp_moment: Annotated[float, number("largest moment of a wrench grasp", "Nm", 0.0, 1e3, open_low=True)] = 5.0
    grasp_turn_deg: Annotated[float, number("largest turn of the gripper in a wrench grasp", "deg", 1.0, 180.0)] = 30.0
    weight: Weight = OF_ROBOT["weight"]

    @model_validator(mode="before")
    @classmethod
    def _with_model(cls, values: object) -> object:
        return with_model(values)

    @classmethod
    def from_urdf(cls, path: str | Path, **entries: Any) -> Robot:
        """Return the robot of a URDF or xacro file, which is read and looked through now.

        Args:
            path: of the file.
            entries: others of its section, ``grasp_frame="tool0"``, ``base=Pose(x=1.9, z=0.9)``.

        Raises:
            InputError: the file cannot be read or is no robot, its data are such that it cannot lift, or an entry is
                wrong; it says which.
        """
        from liftopt.multibody.robots.examination import refuse

        robot = cls(model=str(Path(path).expanduser().absolute()), **entries)
        found = robot.chosen().examination()
        refuse(found, found.chain.description.source)
        return robot

    def chosen(self) -> ChosenRobot:
        """Return the robot that the entries lead to; it is read. Raises ``InputError`` as ``chosen_robot``."""
        # With Pinocchio, which entries are checked without.
        from liftopt.multibody.robots.chosen_robot import chosen_robot
        from liftopt.multibody.robots.given_limits import GivenLimits

        return chosen_robot(
            self.model,
            arguments=self.arguments,
            grasp_frame=self.grasp_frame,
            base_link=self.base_link,
            locked=self.locked,
            direction=self.tool.direction,
            limits={
                name: GivenLimits(own.lower, own.upper, own.velocity, own.effort) for name, own in self.limits.items()
            },
        )

    @property
    def height_key(self) -> str:
        """Key within the robot of the height of its base."""
        return "base_height" if self.base.z is None else "base.z"

    @property
    def height(self) -> float:
        """Height of the base above the floor [m]."""
        return self.base_height if self.base.z is None else self.base.z
