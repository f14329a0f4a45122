"""From where to where the object is lifted."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import Discriminator, Tag

from liftopt.files.entries import OrFree, entry, free_number, number
from liftopt.files.section import Section

PLACED = "a section with the keys height and human_distance, or x, y and z"
RESTS = Literal["velocity", "acceleration"]


class GraspPlace(Section):
    """Where the object is at one end of the motion, by where it is held.

    ``height`` is midway between the hands of the first person and the grasp of who stands opposite;
    ``human_distance`` is that of the middle of the first person's hands, None is "free" in a file.
    """

    height: Annotated[float, number("height of the grasps, midway if they differ (not of the centre)", "m", 0.05, 2.2)]
    human_distance: Annotated[
        float | None, free_number("human grasp, the middle of two hands, ahead of the feet", "m", 0.0, 2.0), OrFree
    ]
    pitch_deg: Annotated[
        float, number("tilt of the object, above 0 with the robot's edge lower", "deg", -60.0, 60.0)
    ] = 0.0


class ObjectPlace(Section):
    """Where the object is at one end of the motion, by its centre; None is "free" in a file."""

    x: Annotated[float | None, free_number("centre of the object along X", "m", -5.0, 5.0), OrFree]
    y: Annotated[float | None, free_number("centre of the object along Y", "m", -5.0, 5.0), OrFree] = None
    z: Annotated[float, number("height of the object's centre", "m", 0.0, 3.0)]
    pitch_deg: Annotated[float, number("tilt of the object about Y", "deg", -60.0, 60.0)] = 0.0


def _tag(place: object) -> str:
    """Return which kind of place is meant: one that names x, y or z is the object's own."""
    keys = place if isinstance(place, Mapping) else getattr(type(place), "model_fields", {})
    return OWN if any(key in keys for key in ("x", "y", "z")) else BY_GRASP


OWN, BY_GRASP = "own", "grasp"
PLACES: dict[str, type[GraspPlace] | type[ObjectPlace]] = {BY_GRASP: GraspPlace, OWN: ObjectPlace}
Place = Annotated[Annotated[GraspPlace, Tag(BY_GRASP)] | Annotated[ObjectPlace, Tag(OWN)], Discriminator(_tag)]


class Lift(Section):
    """From where to where, how far apart the two stand, and what is zero at both ends."""

    standing_distance: Annotated[
        float | None, number("first person's feet to the robot's base, or to who stands opposite", "m", 0.5, 4.0)
    ] = None
    rest: Annotated[RESTS, entry("zero at both ends: the velocity, or the acceleration too")] = "velocity"
    start: Annotated[Place, entry("where the object is at first", PLACED)]
    end: Annotated[Place, entry("where the object is at last", PLACED)]
