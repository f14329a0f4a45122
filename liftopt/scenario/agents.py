"""Who lifts: persons and robots, as a scenario describes them, by name."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator, Field, model_validator

from liftopt.files.entries import entry, number
from liftopt.files.frozen_table import FrozenTable
from liftopt.files.section import Section
from liftopt.scenario.agent_fields import FARTHEST, GRASPS, Length, Listed, Weight
from liftopt.scenario.hands import OF_BODY, Body, Hand, in_order, with_hands
from liftopt.scenario.presets import NATURAL
from liftopt.scenario.robot import Robot

OF_PERSON = NATURAL["person"]  # where the preset is another, a scenario fills in its own


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
            'a list of "right" and "left", each at most once',
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


Agent = Person | Robot
Agents = FrozenTable[Annotated[Agent, Field(discriminator="kind")]]
KINDS: dict[str, type[Person] | type[Robot]] = {"person": Person, "robot": Robot}
