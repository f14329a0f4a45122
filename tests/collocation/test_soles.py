"""Soles on the floor: the centre of pressure and the cone of friction in closed form are the oracles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from liftopt.collocation.soles import resting, sole_rows
from liftopt.multibody.agent import Stance
from liftopt.multibody.trajectory import GRAVITY

STANCE = Stance(((-0.07, 0.12, 0.15), (-0.05, 0.13, 0.14)), 0.5, 2.0, np.array([0.04, 0.01, 0.03]))


def _ground(force: tuple[float, float, float], x: float, y: float, turn: float = 0.0) -> np.ndarray:
    """Return the wrench (1, 6) about the feet's origin of a force whose centre of pressure is (x, y, 0)."""
    moment = np.cross([x, y, 0.0], force) + np.array([0.0, 0.0, turn])
    return np.concatenate([force, moment])[None]


def test_the_support_is_the_rectangle_around_both_soles() -> None:
    assert STANCE.support == (-0.07, 0.13, 0.15)


@pytest.mark.parametrize(
    ("x", "y", "tips"),
    [
        (0.0, 0.0, None),
        (-0.069, 0.0, None),
        (-0.071, 0.0, "over the heels"),
        (0.129, 0.149, None),
        (0.131, 0.0, "over the toes"),
        (0.0, 0.151, "to the left"),
        (0.0, -0.151, "to the right"),
    ],
)
def test_the_centre_of_pressure_stays_within_it(x: float, y: float, tips: str | None) -> None:
    _, pressure = sole_rows(STANCE)
    room = pressure.room(_ground((20.0, -10.0, 700.0), x, y, 20.0 * y + 10.0 * x))[0]
    assert [label for label, value in zip(pressure.labels, room, strict=True) if value < 0.0] == (
        [tips] if tips else []
    )


def test_a_sway_keeps_it_off_the_edges() -> None:
    _, pressure = sole_rows(replace(STANCE, sway=0.02))
    for x, y in ((-0.051, 0.0), (0.111, 0.0), (0.0, 0.131), (0.0, -0.131)):
        assert pressure.room(_ground((0.0, 0.0, 700.0), x, y))[0].min() < 0.0
        assert pressure.room(_ground((0.0, 0.0, 700.0), 0.97 * x, 0.97 * y))[0].min() > 0.0


def test_friction_holds_within_the_pyramid_in_the_cone() -> None:
    friction, _ = sole_rows(STANCE)
    rng, weight = np.random.default_rng(3), 700.0
    for angle in rng.uniform(0.0, 2.0 * np.pi, 50):
        along = np.array([np.cos(angle), np.sin(angle)])
        held = friction.room(_ground((*(0.999 * 0.5 / np.sqrt(2.0) * weight * along), weight), 0.0, 0.0))
        assert held.min() > 0.0
        slid = friction.room(_ground((*(1.001 * 0.5 * weight * along), weight), 0.0, 0.0))
        assert slid.min() < 0.0
    ahead = friction.room(_ground((-0.4 * weight, 0.0, weight), 0.0, 0.0))[0]
    assert friction.labels[int(ahead.argmin())] == "ahead"  # the floor holds the feet back


def test_a_turn_is_held_by_friction_too() -> None:
    _, pressure = sole_rows(STANCE)
    most = 2.0 / 3.0 * 0.5 * 0.15 * 700.0
    for share, holds in ((0.99, True), (1.01, False)):
        for sign in (-1.0, 1.0):
            room = pressure.room(_ground((0.0, 0.0, 700.0), 0.0, 0.0, sign * share * most))
            assert (room.min() >= 0.0) == holds


def test_the_feet_rest_on_the_floor_below_their_centre_of_mass() -> None:
    wrench = resting(STANCE)[0]
    assert wrench[2] == 2.0 * GRAVITY
    assert [-wrench[4] / wrench[2], wrench[3] / wrench[2]] == pytest.approx([0.04, 0.01])
