"""The trunk's lean: turns about one axis in closed form, and angles told by hand, are the oracles."""

from __future__ import annotations

import numpy as np
import pytest

from liftopt.multibody.leaning import trunk_tilt
from liftopt.multibody.person.human import human_agent
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.person.whole_body import whole_human_agent
from liftopt.multibody.person.whole_joints import JOINTS
from liftopt.multibody.placement import Placement

SUBJECT = Subject(1.75, 75.0, "male")


@pytest.mark.parametrize("place", [Placement(), Placement(0.4, 1.0, 2.0)])
def test_legs_hips_and_spine_add_up_to_the_lean(place: Placement) -> None:
    person = whole_human_agent(SUBJECT, place=place)
    degrees = {"ankle": 20.0, "knee": 90.0, "hip": 100.0, "Q2": 25.0, "right_Q5": 40.0}
    q = np.radians([[degrees.get(joint, 0.0) for joint in JOINTS], np.zeros(20)])
    np.testing.assert_allclose(trunk_tilt(person, q), [1.0 - np.cos(np.radians(55.0)), 0.0], atol=1e-12)


def test_a_bend_to_the_side_is_a_lean_too_and_a_turn_is_none() -> None:
    person = whole_human_agent(SUBJECT)
    q = np.zeros((2, 20))
    q[0, JOINTS.index("Q1")], q[1, JOINTS.index("Q3")] = 0.3, 0.5
    np.testing.assert_allclose(trunk_tilt(person, q), [1.0 - np.cos(0.3), 0.0], atol=1e-12)


def test_the_end_of_the_room_costs_one_and_upright_nothing() -> None:
    lean = whole_human_agent(SUBJECT).lean
    assert lean is not None
    cost = lean.cost(1.0 - np.cos([0.0, lean.room, 1e-2 * lean.room]))
    assert cost[:2] == pytest.approx([0.0, 1.0])
    # Near the vertical it grows with the fourth power of the angle.
    assert cost[2] == pytest.approx((lean.room**2 / 2 / (1.0 - np.cos(lean.room))) ** 2 * 1e-8, rel=1e-3)


def test_the_papers_person_has_no_lean() -> None:
    person = human_agent(SUBJECT)
    with pytest.raises(ValueError, match="no trunk that leans"):
        trunk_tilt(person, np.zeros((1, 13)))
