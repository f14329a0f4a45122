"""Two soles on the floor: they push up and neither slide nor tip, heels and toes stay down.

The conditions are linear in the force and moment of the ground about the feet's origin, in the axes of the base: the
force lies in the pyramid that is inscribed in the friction cone about z, and the centre of pressure
(-moment_y / force_z, moment_x / force_z) in the rectangle around both soles, by the sway within it. The moment about z
is within what friction holds of a pressure that is even over a disc as wide as that rectangle, two thirds of
``friction * force * radius``; that limit stands apart from the pyramid's.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from liftopt.collocation.push import PushRows
from liftopt.multibody.agent import Agent, Stance
from liftopt.multibody.trajectory import GRAVITY
from liftopt.types import Array

FRICTION, PRESSURE = "sole_friction", "sole_pressure"
_PAIR = np.array([-1.0, 1.0])


def sole_rows(stance: Stance) -> tuple[PushRows, PushRows]:
    """Return the rows of all that the ground does, friction [N] and pressure [Nm]; labels say where the feet slip."""
    back, ahead, aside = stance.support
    tips = np.array([-back, ahead, aside, aside]) - stance.sway
    pyramid = np.full(4, stance.friction / np.sqrt(2.0))
    turn = 2.0 / 3.0 * stance.friction * aside
    return (
        PushRows(FRICTION, ("back", "ahead", "right", "left"), np.array([0, 0, 1, 1]), np.tile(_PAIR, 2), pyramid),
        PushRows(
            PRESSURE,
            ("over the heels", "over the toes", "to the left", "to the right", "turn left", "turn right"),
            np.array([4, 4, 3, 3, 5, 5]),
            np.tile(_PAIR, 3),
            np.array([*tips, turn, turn]),
        ),
    )


def resting(stance: Stance) -> Array:
    """Return force and moment (1, 6) with which the ground bears what does not move, the feet [N, Nm]."""
    up = np.array([0.0, 0.0, stance.mass * GRAVITY])
    return np.concatenate([up, np.cross(stance.p_base_com, up)])[None]


def weight_of(agent: Agent) -> float:
    """Return the weight of an agent, feet included [N]: the unit of its rows."""
    feet = agent.stance.mass if agent.stance else 0.0
    return float((pin.computeTotalMass(agent.model) + feet) * GRAVITY)
