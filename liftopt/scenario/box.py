"""What is lifted: a box of even density, and where each hand holds it."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import AfterValidator, ValidationError, WrapValidator

from liftopt.errors import InputError
from liftopt.files.entries import entry, number
from liftopt.files.frozen_table import FrozenTable
from liftopt.files.section import Section
from liftopt.multibody.edges import HOLDS, Hold
from liftopt.scenario.agent_fields import NAME, NAMES, Listed

Coordinate = Annotated[float, number("", "m", -2.0, 2.0)]
Position = Annotated[tuple[Coordinate, Coordinate, Coordinate], Listed]


def _safe(name: str) -> str:
    if not NAME.fullmatch(name):
        raise InputError("object.name", name, f"must be {NAMES}")
    return name


class HeldAt(Section):
    """How a hand holds the object, and where if not in the usual place of such a hold."""

    place: Annotated[Hold, entry("how the hand holds")] = "edge"
    position: Annotated[
        Position | None,
        entry("of the grasp in the object's axes from its centre; by default by the place", "[x, y, z] in m"),
    ] = None


def _as_one(value: Any, handler: Any) -> Any:
    """Check one of several forms, and refuse once for all of them."""
    try:
        return handler(value)
    except ValidationError:
        raise ValueError("no form of a grasp") from None


Held = Annotated[Hold | Position | HeldAt, WrapValidator(_as_one)]


class Box(Section):
    """The object: a box of even density, held by default at the bottom edges that face those who lift it."""

    name: Annotated[str, AfterValidator(_safe), entry("what the object is called in results", NAMES)] = "table"
    mass: Annotated[float, number("mass of the object", "kg", 0.05, 50.0)]
    depth: Annotated[float, number("extent from the human grasp to the robot grasp", "m", 0.1, 2.0)]
    width: Annotated[float, number("extent to the side", "m", 0.02, 2.0)]
    height: Annotated[float, number("thickness", "m", 0.001, 1.0)]
    grasps: Annotated[
        FrozenTable[Held],
        entry(
            "where a hand holds it, in its axes from its centre; by default at the edge that faces its agent",
            "a table of NAME = [x, y, z] in m, of NAME = "
            + ", ".join(f'"{hold}"' for hold in HOLDS)
            + ", or of NAME = { place, position }",
        ),
    ] = FrozenTable()
