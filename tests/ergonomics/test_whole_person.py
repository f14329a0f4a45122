"""All measures of a person with legs who lifts a box alone; the oracle is the posture that the lift begins with."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from liftopt.assessment.grasp import share_finding
from liftopt.assessment.person import person_findings
from liftopt.assessment.who import who_is
from liftopt.ergonomics.measures import ergonomics_of
from liftopt.ergonomics.motion import motion_of
from liftopt.multibody.trajectory import agent_trajectory
from liftopt.scenario.build import agent_of
from liftopt.solution.finding import Finding
from liftopt.solution.solution import Solution

SQUAT = {"ankle": 30.0, "knee": 115.0, "hip": 110.0, "Q2": 15.0, "Q5": 55.0, "Q7": -30.0, "Q8": -80.0}
STOOP = {"ankle": 0.0, "knee": 10.0, "hip": 60.0, "Q2": 40.0, "Q5": 90.0, "Q7": -10.0, "Q8": -80.0}
UPRIGHT = {"ankle": 3.0, "knee": 10.0, "hip": 6.0, "Q5": 15.0, "Q7": -80.0, "Q8": -80.0}
LEGS_AND_TRUNK = ("ankle", "knee", "hip", "Q2")


@pytest.fixture
def lifted(solution: Any) -> Callable[..., Solution]:
    """Return a function that gives a lift of a box from one posture to upright, smooth from rest to rest."""

    def lift(start: dict[str, float], mass: float = 10.0, hands: tuple[str, ...] = ("right", "left")) -> Solution:
        changes = {"human.body": "whole", "human.hands": list(hands), "object.mass": mass, "object.width": 0.35}
        scenario = solution.scenario.replace({**changes, "object.height": 0.25})
        agent, time = agent_of(scenario, "human"), solution.time
        first, last = (_joints(agent.moving_joints, posture) for posture in (start, UPRIGHT))
        share, end = time / time[-1], time[-1]
        path = np.polynomial.Polynomial([0.0, 0.0, 0.0, 10.0, -15.0, 6.0])
        q, v, a = (np.outer(path.deriv(k)(share) if k else path(share), last - first) / end**k for k in range(3))
        force = np.tile((0.0, 0.0, mass * 9.81 / len(hands)), (len(time), len(hands), 1))
        person = agent_trajectory(agent, first + q, v, a, force)
        return replace(solution, scenario=scenario, urdfs={}, agents=(person,))

    return lift


def _joints(names: tuple[str, ...], posture: dict[str, float]) -> np.ndarray:
    """Return angles by the names of a model's joints [rad], alike for both arms."""
    angles = [posture.get(name.rpartition("_")[2], 0.0) for name in names]
    return np.radians(angles)


def _found(lift: Solution) -> dict[str, Finding]:
    (person,) = lift.agents
    return {finding.code: finding for finding in person_findings(lift, person, who_is(person, lift.agents))}


def test_a_squat_lift_from_the_floor_is_told_as_one(lifted: Callable[..., Solution]) -> None:
    found = _found(lifted(SQUAT))["person.lifting_style"]
    assert found.title == "starts in a squat, ends upright"
    assert found.value == pytest.approx(115.0 / (30.0 + 110.0 + 15.0))
    assert "knees 115, hips 110, trunk 40 deg" in found.message
    assert "knees at the start -5, knees at the end -15" in found.message
    stoop = _found(lifted(STOOP))["person.lifting_style"]
    assert stoop.title == "starts in a stoop, ends upright"
    assert "seven men" not in stoop.message


def test_knees_count_in_reba(lifted: Callable[..., Solution]) -> None:
    """By hand: knees 3, trunk 3, neck 1: Table A 5, and 1 for 7 kg; arm 3, elbow 2, wrist 1: Table B 4, fair 1."""
    lift = lifted(SQUAT, mass=7.0)
    scores = ergonomics_of(lift, lift.agents[0]).reba
    assert scores is not None
    parts = scores.at(0)
    assert (parts["trunk"], parts["legs"], parts["load"], parts["body_with_load"]) == (3, 3, 1, 6)
    assert (parts["upper_arm"], parts["lower_arm"], parts["arm_with_coupling"], parts["grand"]) == (3, 2, 5, 8)
    finding = _found(lift)["person.whole_posture"]
    assert (finding.value, finding.severity, finding.time) == (8.0, "warning", 0.0)
    assert "legs 3" in finding.message


def test_with_both_hands_alone_the_guides_apply(lifted: Callable[..., Solution]) -> None:
    lift = lifted(SQUAT)
    slow = replace(lift, time=3.0 * lift.time)
    scopes = {measure.code: measure.scope for measure in ergonomics_of(slow, slow.agents[0]).measures}
    assert (scopes["niosh"], scopes["acgih"], scopes["whole_posture"]) == ("applies",) * 3
    one = lifted(SQUAT, hands=("right",))
    assert ergonomics_of(one, one.agents[0]).niosh.out_of_scope[0] == "it is not for one-handed lifts"


def test_one_who_lifts_alone_is_told_no_shares(lifted: Callable[..., Solution]) -> None:
    lift = lifted(SQUAT)
    (person,) = lift.agents
    told = share_finding(lift, person, who_is(person, lift.agents))
    assert (told.title, told.value, told.severity) == ("carries the load alone", 1.0, "info")


def test_the_spine_bears_more_in_a_heavier_lift_and_is_told(lifted: Callable[..., Solution]) -> None:
    light, heavy = (_found(lifted(STOOP, mass=mass))["person.spine_compression"] for mass in (5.0, 25.0))
    assert light.value is not None and heavy.value is not None
    assert light.value < heavy.value
    assert (heavy.severity, heavy.limit, heavy.unit) == ("warning", 3400.0, "N")
    assert heavy.title.startswith(f"{100 * heavy.value / 3400.0:.0f} % of the NIOSH action limit")


def test_both_sides_of_a_symmetric_lift_are_alike(lifted: Callable[..., Solution]) -> None:
    lift = lifted(SQUAT)
    (person,) = lift.agents
    spine = ergonomics_of(lift, person).spine
    for aside in (spine.side_shear, spine.lateral, spine.twist):
        np.testing.assert_allclose(aside, 0.0, atol=1e-6)
    left = lifted(SQUAT, hands=("left",))
    right = lifted(SQUAT, hands=("right",))
    one, other = (ergonomics_of(each, each.agents[0]).spine for each in (left, right))
    np.testing.assert_allclose(one.compression, other.compression, rtol=1e-7)
    np.testing.assert_allclose(one.lateral, -other.lateral, atol=1e-6)
    np.testing.assert_allclose(
        motion_of(left, left.agents[0]).elbow, motion_of(right, right.agents[0]).elbow, atol=1e-9
    )
