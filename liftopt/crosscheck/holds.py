"""What the holds on the object allow, as CasADi expressions that must not be negative, written apart from the NLP.

Everything is told of one instant. A hold that transmits moments has a cap on them and a largest angle between hand and
object; a flat hand only pushes, and neither slides nor tips.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from liftopt.multibody.agent import Grasp

MOMENT_UNIT = 1.0  # what the solver sees as one, near the size of what is found [Nm]
FORCE_UNIT = 10.0  # likewise [N]


def room(grasp: Grasp, force: Any, moment: Any, grip: Any, attitude: Any) -> list[Any]:
    """Return what a hold leaves of each of its limits but the force's, all of them >= 0, in sizes near one.

    With moments: of the cap on their norm, as a share of it squared, and of the hand's angle on the object, as the
    difference of the cosines. Of a flat hand: of the friction that keeps it from sliding, by the pyramid inscribed in
    the cone about the object's z axis; with moments too, of the reach of the centre of pressure, half the breadth, and
    of what friction holds about z of a pressure that is even over a disc of that breadth.

    Args:
        grasp: the hold; without moments, ``moment`` and ``grip`` are not looked at.
        force: (3,) on the object, world axes [N].
        moment: (3,) on the object about the grasp point, world axes [Nm].
        grip: (3, 3) the grip axes in the world.
        attitude: (3, 3) the object's axes in the world.
    """
    left = []
    if grasp.moments:
        cosine = (ca.trace(ca.mtimes(attitude.T, grip)) - 1) / 2
        left += [1 - ca.dot(moment, moment) / grasp.max_moment**2, cosine - float(np.cos(grasp.max_turn))]
    if grasp.friction is not None:
        ahead, aside, push = ca.vertsplit(ca.mtimes(attitude.T, force))
        held = grasp.friction / np.sqrt(2) * push
        left += _within([(ahead, held), (aside, held)], FORCE_UNIT)
        if grasp.moments:
            about_x, about_y, about_z = ca.vertsplit(ca.mtimes(attitude.T, moment))
            reach = grasp.breadth / 2 * push
            swivel = 2 / 3 * grasp.friction * reach
            left += _within([(about_x, reach), (about_y, reach), (about_z, swivel)], MOMENT_UNIT)
    return left


def _within(pairs: list[tuple[Any, Any]], unit: float) -> list[Any]:
    """Return what is left of each limit (the second of a pair) above and below a value (the first)."""
    return [each / unit for value, limit in pairs for each in (limit - value, limit + value)]
