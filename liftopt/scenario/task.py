"""From where to where the object is lifted."""

from __future__ import annotations

from typing import Annotated, Literal

from liftopt.files.entries import OrFree, entry, free_number, number
from liftopt.files.section import Section

RESTS = Literal["velocity", "acceleration"]


class GraspPlace(Section):
    """Where the object is at one end of the motion, by the edges it is held at.

    A tilted object has ``height`` midway between its grasp points; ``human_distance`` is that of the first person's.
    ``human_distance`` None is "free" in a file.
    """

    height: Annotated[float, number("height of the held edges, midway if tilted (not of the centre)", "m", 0.05, 2.2)]
    human_distance: Annotated[float | None, free_number("human grasp ahead of the feet", "m", 0.0, 2.0), OrFree]
    pitch_deg: Annotated[
        float, number("tilt of the object, above 0 with the robot's edge lower", "deg", -60.0, 60.0)
    ] = 0.0


class Lift(Section):
    """From where to where, how far apart the two stand, and what is zero at both ends."""

    standing_distance: Annotated[float, number("first person's feet to the robot's base", "m", 0.5, 4.0)]
    rest: Annotated[RESTS, entry("zero at both ends: velocity, or acceleration too as in files without it")] = (
        "velocity"
    )
    start: GraspPlace
    end: GraspPlace
