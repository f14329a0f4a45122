"""What is lifted: a box of even density, and where each agent holds it."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator

from liftopt.errors import InputError
from liftopt.files.entries import entry, number
from liftopt.files.frozen_table import FrozenTable
from liftopt.files.section import Section
from liftopt.scenario.agents import NAME, NAMES, Listed

Coordinate = Annotated[float, number("", "m", -2.0, 2.0)]


def _safe(name: str) -> str:
    if not NAME.fullmatch(name):
        raise InputError("object.name", name, f"must be {NAMES}")
    return name


class Box(Section):
    """The object: a box of even density, held at the two bottom edges that face the two who lift it."""

    name: Annotated[str, AfterValidator(_safe), entry("what the object is called in results", NAMES)] = "table"
    mass: Annotated[float, number("mass of the object", "kg", 0.05, 50.0)]
    depth: Annotated[float, number("extent from the human grasp to the robot grasp", "m", 0.1, 2.0)]
    width: Annotated[float, number("extent to the side", "m", 0.02, 2.0)]
    height: Annotated[float, number("thickness", "m", 0.001, 1.0)]
    grasps: Annotated[
        FrozenTable[Annotated[tuple[Coordinate, Coordinate, Coordinate], Listed]],
        entry(
            "where an agent holds it, in its axes from its centre; by default in the middle of the edge that faces it",
            "a table of NAME = [x, y, z] in m",
        ),
    ] = FrozenTable()
