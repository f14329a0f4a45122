"""What stands in the way: boxes in the world, such as a pallet, a conveyor, a shelf or a wall."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import AfterValidator

from liftopt.errors import InputError
from liftopt.files.entries import entry, number
from liftopt.files.section import Section
from liftopt.scenario.agent_fields import FARTHEST, NAME, NAMES, Listed

SMALLEST, LARGEST = 0.001, 20.0  # [m]: an edge of an obstacle
Edge = Annotated[float, number("", "m", SMALLEST, LARGEST)]
Length = Annotated[float, number("", "m", -FARTHEST, FARTHEST)]


def _safe(name: str | None) -> str | None:
    if name is not None and not NAME.fullmatch(name):
        raise InputError("obstacles.name", name, f"must be {NAMES}")
    return name


class Obstacle(Section):
    """A box that stands in the world; nobody and nothing may overlap it."""

    name: Annotated[
        str | None, AfterValidator(_safe), entry("what it is called in results; by default obstacle_1, ...", NAMES)
    ] = None
    box: Annotated[
        tuple[Edge, Edge, Edge],
        Listed,
        entry("its edges along its axes", f"three lengths from {SMALLEST:g} to {LARGEST:g} m, [x, y, z]"),
    ]
    position: Annotated[
        tuple[Length, Length, Length],
        Listed,
        entry(
            "where its centre is in the world",
            f"three numbers from {-FARTHEST:g} to {FARTHEST:g} m, [x, y, z]",
        ),
    ]
    yaw_deg: Annotated[float, number("how far it is turned, from X about Z", "deg", -360.0, 360.0)] = 0.0


def _named(obstacles: tuple[Obstacle, ...]) -> tuple[Obstacle, ...]:
    """Return the obstacles, those without a name called after their place in the list."""
    return tuple(
        obstacle if obstacle.name else obstacle.changed(name=default_name(k)) for k, obstacle in enumerate(obstacles)
    )


Obstacles = Annotated[tuple[Obstacle, ...], Listed, AfterValidator(_named)]


def default_name(index: int) -> str:
    """Return what an obstacle without a name is called, by its index in the list."""
    return f"obstacle_{index + 1}"


def name_of(obstacles: Any, index: int) -> str:
    """Return what the obstacle of a list is called, whether the list is right or not."""
    given = obstacles[index] if isinstance(obstacles, (list, tuple)) and index < len(obstacles) else None
    name = given.get("name") if isinstance(given, Mapping) else getattr(given, "name", None)
    return name if isinstance(name, str) and NAME.fullmatch(name) else default_name(index)
