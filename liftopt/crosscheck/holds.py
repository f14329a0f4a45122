"""What holds on the object and soles on the floor allow, as CasADi expressions that must not be negative.

They are written apart from the NLP, and told of one instant. A hold that transmits moments has a cap on them and a
largest angle between hand and object; a flat hand only pushes, and neither slides nor tips, and so do soles. A disc is
pressed with no more than its limit.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from liftopt.multibody.agent import Grasp, Stance
from liftopt.multibody.disc import Disc
from liftopt.multibody.trajectory import GRAVITY

MOMENT_UNIT = 1.0  # what the solver sees as one, near the size of what is found [Nm]
FORCE_UNIT = 10.0  # likewise [N]
FOOT_FORCE_UNIT, FOOT_MOMENT_UNIT = 100.0, 10.0  # under the soles


def room(grasp: Grasp, force: Any, moment: Any, grip: Any, attitude: Any) -> list[Any]:
    """Return what a hold leaves of each of its limits but the force's, all of them >= 0, in sizes near one.

    With moments: of the cap on their norm, as a share of it squared, and of the hand's angle on the object, or of that
    to the bar in it, as the difference of the cosines. Of a flat hand: of the friction that keeps it from sliding, by
    the pyramid inscribed in the cone about the object's z axis; with moments too, of the reach of the centre of
    pressure, half the breadth, and of what friction holds about z of a pressure that is even over a disc of that
    breadth.

    Args:
        grasp: the hold; without moments, ``moment`` and ``grip`` are not looked at.
        force: (3,) on the object, world axes [N].
        moment: (3,) on the object about the grasp point, world axes [Nm].
        grip: (3, 3) the grip axes in the world.
        attitude: (3, 3) the object's axes in the world.
    """
    left = []
    if grasp.moments:
        if grasp.bar is None:
            cosine = (ca.trace(ca.mtimes(attitude.T, grip)) - 1) / 2
        else:
            cosine = ca.dot(ca.mtimes(attitude, ca.DM(grasp.bar)), ca.mtimes(grip, ca.DM(grasp.bar)))
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


def footing(stance: Stance, ground: Any) -> list[Any]:
    """Return what the soles leave of each of their limits, all of them >= 0, in sizes near one.

    Of the friction that keeps them from sliding, by the pyramid inscribed in its cone; of the way of the centre of
    pressure to the heels, the toes and both sides, less the sway; and of what friction holds about z of a pressure that
    is even over a disc as wide as both soles.

    Args:
        stance: how it stands.
        ground: (6,) force and moment of the ground on all that moves, about the base's origin in its axes; the feet
            add theirs.
    """
    feet = stance.mass * GRAVITY
    x, y, _ = stance.p_base_com
    push_x, push_y, push, about_x, about_y, about_z = ca.vertsplit(ground + ca.DM([0, 0, feet, y * feet, -x * feet, 0]))
    back, ahead, aside = stance.support
    held = stance.friction / np.sqrt(2) * push
    left = _within([(push_x, held), (push_y, held)], FOOT_FORCE_UNIT)
    heels, toes, sides = -back - stance.sway, ahead - stance.sway, aside - stance.sway
    left += [(-about_y + heels * push) / FOOT_MOMENT_UNIT, (toes * push + about_y) / FOOT_MOMENT_UNIT]
    return left + _within(
        [(about_x, sides * push), (about_z, 2 / 3 * stance.friction * aside * push)], FOOT_MOMENT_UNIT
    )


def bearable(disc: Disc, passed: Any) -> list[Any]:
    """Return what is left of the limit on a disc's compression, >= 0 whichever muscles pull, in sizes near one.

    Args:
        disc: what limits it.
        passed: (3,) axial force, lateral moment and moment that extends [N, Nm, Nm].
    """
    return [(disc.most - ca.dot(ca.DM(factors), passed)) / disc.unit for factors in disc.factors]


def _within(pairs: list[tuple[Any, Any]], unit: float) -> list[Any]:
    """Return what is left of each limit (the second of a pair) above and below a value (the first)."""
    return [each / unit for value, limit in pairs for each in (limit - value, limit + value)]
