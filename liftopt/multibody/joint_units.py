"""In which units a joint is told: one that turns in degrees and Nm, one that slides in millimetres and N."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi


@dataclass(frozen=True)
class JointUnits:
    """The units of one joint, and the words that go with them.

    Attributes:
        q, v, a, tau: in which results have position, velocity, acceleration and effort.
        position: what its position is called.
        effort: what its effort is called.
        move: what it does, as the verb of a sentence.
        shown: unit in which texts and figures show its position; its speed is that per second.
        factor: position in that unit over position in ``q``.
    """

    q: str
    v: str
    a: str
    tau: str
    position: str
    effort: str
    move: str
    shown: str
    factor: float


# In preset paper, which adds (Nm)^2, one N of a sliding joint counts as this many Nm [m]; in preset natural shares of
# limits are added, which have no unit. A choice of this model: about the lever at which an arm's last joints bear.
LEVER = 0.1
TURNS = JointUnits("rad", "rad/s", "rad/s^2", "Nm", "angle", "torque", "moves", "deg", 180.0 / pi)
SLIDES = JointUnits("m", "m/s", "m/s^2", "N", "position", "force", "slides", "mm", 1000.0)


def units_of(slides: bool) -> JointUnits:
    """Return the units of a joint that slides, or of one that turns."""
    return SLIDES if slides else TURNS
