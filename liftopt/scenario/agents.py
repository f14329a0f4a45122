"""Who lifts: persons and robots, as a scenario describes them, by name."""

from __future__ import annotations

import re
from typing import Annotated, Literal

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from liftopt.files.entries import entry, number
from liftopt.files.frozen_table import FrozenTable
from liftopt.files.section import Section
from liftopt.scenario.hands import OF_BODY, Body, Hand, in_order, with_hands
from liftopt.scenario.presets import NATURAL

Kind = Literal["person", "robot"]
NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,31}")
NAMES = "1 to 32 letters, digits or _, a letter first"
FARTHEST = 10.0  # [m] from the origin
OF_PERSON, OF_ROBOT = NATURAL["person"], NATURAL["robot"]  # where the preset is another, a scenario fills in its own
GRASPS = Literal["point", "wrench"]
Weight = Annotated[float, number("weight of squared torques, as shares of strength in preset natural", "", 0.0, 1e6)]
Length = Annotated[float, number("", "m", -FARTHEST, FARTHEST)]


def _as_tuple(value: object) -> object:
    return tuple(value) if isinstance(value, list) else value


Listed = BeforeValidator(_as_tuple)  # TOML and JSON have lists where a model has a tuple


class Person(Section):
    """A person who lifts; the feet stand still."""

    kind: Annotated[Literal["person"], entry("what the agent is")] = "person"
    stature: Annotated[float, number("height of the person", "m", 1.2, 2.2)]
    mass: Annotated[float, number("body mass of the person", "kg", 30.0, 200.0)]
    sex: Annotated[Literal["male", "female"], entry("whose segment data to use")]
    body: Annotated[Body, entry("right arm and trunk on legs like posts, or the whole body")] = "arm"
    hands: Annotated[
        tuple[Hand, ...],
        Field(min_length=1, default_factory=lambda: OF_BODY["arm"]),
        AfterValidator(in_order),
        Listed,
        entry(
            "which hands hold; by default the right one of an arm, both of a whole body",
            'a list of "right" and "left"',
        ),
    ]
    position: Annotated[
        tuple[Length, Length] | None,
        Listed,
        entry(
            "where the feet stand, x and y; by default the origin, or opposite the first person",
            f"two numbers from {-FARTHEST:g} to {FARTHEST:g} m, [x, y]",
        ),
    ] = None
    heading_deg: Annotated[
        float | None,
        number(
            "which way the person faces, from X about Z; by default 0, or 180 for all but the first",
            "deg",
            -360.0,
            360.0,
        ),
    ] = None
    grasp: Annotated[GRASPS, entry("a force at a point, or a hand that also transmits moments")] = OF_PERSON["grasp"]
    # Both largest moments are estimates: about what a wrist holds in the weaker directions, and a small gripper.
    max_grasp_moment: Annotated[float, number("largest moment of a wrench grasp", "Nm", 0.0, 1e3, open_low=True)] = 10.0
    grasp_turn_deg: Annotated[float, number("largest turn of the hand in a wrench grasp", "deg", 1.0, 180.0)] = (
        OF_PERSON["grasp_turn_deg"]
    )
    contact: Annotated[Literal["grip", "flat"], entry("a hand that grips, or a flat one that only pushes up")] = "grip"
    friction: Annotated[float, number("friction coefficient under a flat hand", "", 0.01, 10.0)] = 0.5
    weight: Weight = OF_PERSON["weight"]

    @model_validator(mode="before")
    @classmethod
    def _with_hands(cls, values: object) -> object:
        return with_hands(values)


class Tool(Section):
    """The gripper on the robot's flange; length and mass 0 stand for the bare flange."""

    length: Annotated[float, number("flange to grasp point, along the flange's axis", "m", 0.0, 0.6)] = 0.15
    mass: Annotated[float, number("mass of the gripper", "kg", 0.0, 10.0)] = 0.4


class Pose(Section):
    """Where a robot's base stands and which way it faces; what is left out is as for the default robot."""

    x: Annotated[float | None, number("base along X; by default task.standing_distance", "m", -FARTHEST, FARTHEST)] = (
        None
    )
    y: Annotated[float, number("base along Y", "m", -FARTHEST, FARTHEST)] = 0.0
    z: Annotated[float | None, number("height of the base; by default base_height", "m", 0.0, 2.0)] = None
    yaw_deg: Annotated[float, number("which way the robot faces, from X about Z", "deg", -360.0, 360.0)] = 180.0


class Robot(Section):
    """A robot that lifts; by default it faces the first person."""

    kind: Annotated[Literal["robot"], entry("what the agent is")] = "robot"
    model: Annotated[Literal["sawyer"], entry("which robot")]
    base_height: Annotated[float, number("height of the robot's base above the floor", "m", 0.0, 2.0)] = 0.915
    base: Pose = Pose()
    tool: Tool = Tool()
    grasp: Annotated[GRASPS, entry("a force at a point, or a gripper that also transmits moments")] = OF_ROBOT["grasp"]
    max_grasp_moment: Annotated[float, number("largest moment of a wrench grasp", "Nm", 0.0, 1e3, open_low=True)] = 5.0
    grasp_turn_deg: Annotated[float, number("largest turn of the gripper in a wrench grasp", "deg", 1.0, 180.0)] = 30.0
    weight: Weight = OF_ROBOT["weight"]

    @property
    def height_key(self) -> str:
        """Key within the robot of the height of its base."""
        return "base_height" if self.base.z is None else "base.z"

    @property
    def height(self) -> float:
        """Height of the base above the floor [m]."""
        return self.base_height if self.base.z is None else self.base.z


Agent = Person | Robot
Agents = FrozenTable[Annotated[Agent, Field(discriminator="kind")]]
KINDS: dict[str, type[Person] | type[Robot]] = {"person": Person, "robot": Robot}
