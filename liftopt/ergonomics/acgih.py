"""The threshold limit values for lifting: a mass by where the hands are; indicative only for a shared lift."""

from __future__ import annotations

from liftopt.multibody.person.anthropometry import landmarks, link_lengths
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.sources import Source

SOURCE = Source(
    "ACGIH (2004), threshold limit values for lifting, Table 1 (at most 2 h a day and 60 lifts an hour), as reprinted "
    "in Fundamentals and Assessment Tools for Occupational Ergonomics",
    "secondary",
)
# Rows by height of the hands from the highest zone down, columns by distance from between the ankles [kg].
LIMITS: tuple[tuple[float | None, ...], ...] = (
    (16.0, 7.0, None),  # 8 cm below the shoulder and above, within reach
    (32.0, 16.0, 9.0),  # knuckles to below the shoulder
    (18.0, 14.0, 7.0),  # mid shin to knuckles
    (14.0, None, None),  # floor to mid shin
)
DISTANCES = (30.0, 60.0, 80.0)  # ends of close, intermediate and extended [cm]
BELOW_SHOULDER, ABOVE_SHOULDER = 8.0, 30.0  # cm; the table ends 30 cm above the shoulder


def acgih_limit(subject: Subject, horizontal: float, vertical: float) -> float | None:
    """Return the limit [kg] for hands at H, V [cm], or None where the table knows no safe limit."""
    lengths, at = link_lengths(subject), landmarks(subject)
    shoulder = 100.0 * (lengths.l1 + lengths.l2)
    knuckles = shoulder - 100.0 * (lengths.l4 + lengths.l5 + lengths.l6)
    mid_shin = 50.0 * (at.knee + at.ankle)
    column = next((i for i, end in enumerate(DISTANCES) if horizontal <= end), None)
    if column is None or vertical > shoulder + ABOVE_SHOULDER:
        return None
    floors = (shoulder - BELOW_SHOULDER, knuckles, mid_shin)
    row = next((i for i, floor in enumerate(floors) if vertical >= floor), len(floors))
    return LIMITS[row][column]
