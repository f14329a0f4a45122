"""Measures of each person: the oracle is the same motion of the same person who stands elsewhere."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from liftopt.ergonomics.measures import ergonomics_of
from liftopt.ergonomics.niosh import niosh
from liftopt.ergonomics.posture import posture_of
from liftopt.ergonomics.spine import spine_load
from liftopt.multibody.dh import rotation_z
from liftopt.multibody.trajectory import agent_trajectory
from liftopt.scenario.build import agent_of


@pytest.mark.parametrize("heading", [90.0, 180.0, -33.0])
def test_where_a_person_stands_and_faces_changes_nothing(solution: Any, heading: float) -> None:
    human = solution["human"]
    place = {"x": 0.5, "y": 0.0, "z": 1.0}  # of the object, which the measures do not ask for
    stand = {"human.position": [0.3, -0.2], "human.heading_deg": heading}
    scenario = solution.scenario.replace({**stand, "task.start": place, "task.end": place})
    agent, moving = agent_of(scenario, "human"), human.moving
    rotation = rotation_z(np.radians(heading))[:3, :3].T
    force, moment = human.grasp_force @ rotation, human.grasp_moment @ rotation
    turned = agent_trajectory(agent, human.q[:, moving], human.v[:, moving], human.a[:, moving], force, moment)
    elsewhere = replace(solution, scenario=scenario, urdfs={}, agents=(turned, solution.agents[1]))
    here, there = posture_of(solution, human), posture_of(elsewhere, turned)
    for one, other in ((here, there), (here.arm("right"), there.arm("right"))):
        for name in (name for name, values in vars(one).items() if isinstance(values, np.ndarray)):
            np.testing.assert_allclose(getattr(other, name), getattr(one, name), atol=1e-6, err_msg=name)
    back, same = spine_load(solution, human), spine_load(elsewhere, turned)
    for name, values in vars(back).items():
        np.testing.assert_allclose(getattr(same, name), values, atol=1e-6, err_msg=name)
    equation, again = niosh(solution, human), niosh(elsewhere, turned)
    for name, value in vars(equation.origin).items():
        assert getattr(again.origin, name) == pytest.approx(value, abs=1e-6), name
    assert again.lifting_index == pytest.approx(equation.lifting_index, rel=1e-9)


def test_each_persons_measures_are_their_own(team_solution: Callable[[str], Any]) -> None:
    """Two who face each other at one distance from a box have the same reach; load and strength differ."""
    lift = team_solution("two_people").solution
    anna, ben = (ergonomics_of(lift, person) for person in lift.persons)
    assert anna.niosh.origin.horizontal == pytest.approx(ben.niosh.origin.horizontal, abs=1.0)
    assert anna.niosh.origin.asymmetry == pytest.approx(ben.niosh.origin.asymmetry, abs=1.0)
    for person, found in zip(lift.persons, (anna, ben), strict=True):
        assert found.niosh.largest_load == pytest.approx(person.load[:, 2].max() / 9.81)
        share = np.abs(person.tau[:, person.moving]) / person.limits.effort
        assert max(use.peak for use in found.strength) >= share.max()
        assert [use.joint for use in found.strength] == [f"Q{i}" for i in range(1, 11)]


def test_without_a_robot_none_is_spoken_of(team_solution: Callable[[str], Any]) -> None:
    lift = team_solution("two_people").solution
    words = " ".join(measure.reading for measure in ergonomics_of(lift, lift["ben"]).measures)
    assert "robot" not in words
