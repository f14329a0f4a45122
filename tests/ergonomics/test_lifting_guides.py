"""NIOSH, ISO 11228-1, ACGIH and strength: worked by hand; and each says how far it applies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from liftopt.ergonomics.acgih import acgih_limit
from liftopt.ergonomics.coupling import coupling_of
from liftopt.ergonomics.lifting_guides import acgih_measure, iso_measure, niosh_measure
from liftopt.ergonomics.measures import ergonomics_of
from liftopt.ergonomics.niosh import niosh, niosh_terms
from liftopt.ergonomics.strength import strength_use
from liftopt.multibody.person.subject import Subject


def test_niosh_by_hand() -> None:
    # 25/40 = 0.625; 1 - 0.003 * 15 = 0.955; 0.82 + 4.5/50 = 0.91; 1 - 0.0032 * 30 = 0.904; poor coupling 0.9:
    # 23 * 0.625 * 0.955 * 0.91 * 0.904 * 0.9 = 10.164 kg
    terms = niosh_terms(horizontal=40, vertical=90, travel=50, asymmetry=30)
    assert (terms.hm, terms.vm, terms.dm, terms.am) == pytest.approx((0.625, 0.955, 0.91, 0.904), abs=1e-12)
    assert terms.recommended_weight == pytest.approx(10.164, abs=5e-4)


@pytest.mark.parametrize(
    ("changed", "name", "wanted"),
    [
        ({"horizontal": 20}, "hm", 1.0), ({"horizontal": 63.1}, "hm", 0.0), ({"vertical": 176}, "vm", 0.0),
        ({"travel": 10}, "dm", 1.0), ({"travel": 176}, "dm", 0.0), ({"asymmetry": 136}, "am", 0.0),
    ],
)  # fmt: skip
def test_niosh_ends_of_the_ranges(changed: dict[str, float], name: str, wanted: float) -> None:
    best = {"horizontal": 25.0, "vertical": 75.0, "travel": 25.0, "asymmetry": 0.0}
    assert niosh_terms(**best).recommended_weight == pytest.approx(23.0 * 0.9, abs=1e-12)
    assert getattr(niosh_terms(**(best | changed)), name) == pytest.approx(wanted, abs=1e-12)


def test_niosh_takes_the_hands_place_and_the_persons_part_of_the_load(solution: Any) -> None:
    # Table 5: the hand is 40 cm ahead of the feet, from 90 to 140 cm; a level table is shared half and half at rest.
    equation = niosh(solution, solution["human"])
    y = solution.agents[0].p_world_hold[[0, -1], 1]
    for end, vertical, side in ((equation.origin, 90.0, y[0]), (equation.destination, 140.0, y[1])):
        assert end.horizontal == pytest.approx(100 * np.hypot(0.4, side), abs=1e-4)
        assert (end.vertical, end.travel) == pytest.approx((vertical, 50.0), abs=1e-4)
    assert equation.load == pytest.approx(1.0, abs=0.3)


def test_scopes_are_stated(solution: Any) -> None:
    scopes = {measure.name: measure.scope for measure in ergonomics_of(solution, solution["human"]).measures}
    assert scopes == {
        "RULA": "applies",
        "NIOSH action limit on L5/S1 compression": "indicative",
        "Gallagher and Marras limit on L5/S1 shear": "indicative",
        "Revised NIOSH lifting equation": "indicative",
        "ISO 11228-1": "out of scope",
        "ACGIH TLV for lifting": "indicative",
    }
    words = {measure.name: measure.reading for measure in ergonomics_of(solution, solution["human"]).measures}
    assert "not for one-handed lifts" in words["Revised NIOSH lifting equation"]
    assert "starts at 3 kg" in words["ISO 11228-1"]


def test_iso_is_in_range_from_three_kilograms(solution: Any) -> None:
    heavy = replace(solution, scenario=solution.scenario.replace({"object.mass": 3.0}))
    (iso,) = (measure for measure in ergonomics_of(heavy, heavy["human"]).measures if measure.name == "ISO 11228-1")
    assert (iso.scope, iso.result) == ("indicative", "not evaluated")


@pytest.mark.parametrize(
    ("horizontal", "vertical", "wanted"),
    [(20, 100, 32.0), (45, 100, 16.0), (70, 100, 9.0), (90, 100, None), (20, 150, 16.0), (70, 150, None),
     (20, 200, None), (45, 50, 14.0), (20, 10, 14.0), (45, 10, None)],
)  # fmt: skip
def test_acgih_zones(horizontal: float, vertical: float, wanted: float | None) -> None:
    # A man of 1.75 m: shoulder at about 1.43 m, knuckles at about 0.75 m, mid shin at about 0.3 m.
    assert acgih_limit(Subject(1.75, 75.0, "male"), horizontal, vertical) == wanted


def test_strength_use_is_torque_over_the_limit_in_its_direction(posed: Callable[..., Any]) -> None:
    # Arm straight ahead with 10 N up: the shoulder carries it by flexion torque, whose limit is 92 Nm for a man.
    lift = posed(force=(0.0, 0.0, 10.0), Q5=90.0)
    use = {item.joint: item for item in strength_use(lift, lift["human"])}["Q5"]
    tau = lift.agents[0].tau[0, lift.agents[0].joint_names.index("human_Q5")]
    assert tau > 0
    assert use.peak == pytest.approx(tau / 92.0, rel=1e-12)
    assert use.mean == pytest.approx(use.peak, rel=1e-12)


@pytest.fixture
def alone(solution: Any) -> Callable[..., Any]:
    """Return a function that gives the person of the lift without the robot, slow, with both hands on a small box."""

    def lift(hold: str = "edge", width: float = 0.35, height: float = 0.25, friction: float | None = None) -> Any:
        human = solution["human"]
        grasp, apart = replace(human.grasps[0], friction=friction), np.array([0.0, 0.15, 0.0])
        # The middle between the hands is where the one hand was, and they share its force.
        person = replace(
            human,
            grasps=(replace(grasp, name="human_right"), replace(grasp, name="human_left")),
            grasp_position=np.concatenate([human.grasp_position - apart, human.grasp_position + apart], axis=1),
            grasp_force=np.repeat(human.grasp_force / 2.0, 2, axis=1),
            grasp_moment=np.repeat(human.grasp_moment / 2.0, 2, axis=1),
        )
        changes = {"human.body": "whole", "human.hands": ["right", "left"], "object.width": width}
        holds = {f"object.grasps.human_{hand}": hold for hand in ("right", "left")}
        scenario = solution.scenario.replace({**changes, **holds, "object.height": height})
        return replace(solution, scenario=scenario, agents=(person,), time=4.0 * solution.time)

    return lift


def aside(lift: Any) -> np.ndarray:
    """Return how far the middle between the hands is to the left (K, 1, 1) [m]."""
    return np.asarray(lift.agents[0].p_world_hold[:, None, 1:2])


def test_one_who_lifts_alone_with_both_hands_is_in_scope(alone: Callable[..., Any]) -> None:
    """By hand: fingers under a box of 0.35 x 0.25 m are a fair coupling: 0.95 below 75 cm, 1 from there on."""
    lift = alone()
    person = replace(lift.agents[0], grasp_position=lift.agents[0].grasp_position - [0.0, 1.0, 0.0] * aside(lift))
    equation = niosh(lift, person)
    told = (niosh_measure(equation), acgih_measure(lift, person, equation), iso_measure(lift))
    measures = {measure.code: measure for measure in told}
    assert equation.out_of_scope == ()
    assert (measures["niosh"].scope, measures["acgih"].scope) == ("applies", "applies")
    assert (equation.coupling, equation.origin.cm, equation.destination.cm) == ("fair", 1.0, 1.0)
    assert niosh_terms(40.0, 30.0, 50.0, 0.0, "fair").cm == 0.95
    assert "force of both hands" in measures["acgih"].reading
    assert "Outside" not in measures["niosh"].reading
    assert "shared" not in measures["iso_11228_1"].reading


def test_the_middle_between_two_hands_counts_as_the_one_hand_did(alone: Callable[..., Any], solution: Any) -> None:
    one, two = niosh(solution, solution["human"]), niosh(alone(), alone().agents[0])
    assert (two.hands, two.is_shared) == (2, False)
    assert two.origin.horizontal == pytest.approx(one.origin.horizontal)
    assert two.destination.asymmetry == pytest.approx(one.destination.asymmetry, abs=1e-9)
    assert two.largest_load == pytest.approx(one.largest_load)


@pytest.mark.parametrize(
    ("held", "wanted"),
    [
        ({}, "fair"),
        ({"width": 0.41}, "poor"),
        ({"height": 0.31}, "poor"),
        ({"height": 0.05}, "poor"),  # a plate
        ({"friction": 0.5}, "poor"),  # a flat hand
        ({"hold": "side"}, "poor"),
        ({"hold": "corner"}, "poor"),
        ({"hold": "bottom"}, "fair"),
        ({"hold": "handle", "width": 0.6, "height": 0.4}, "good"),
    ],
    ids=str,
)
def test_coupling_by_box_and_hold(alone: Callable[..., Any], held: dict[str, float], wanted: str) -> None:
    lift = alone(**held)
    assert coupling_of(lift, lift.agents[0]) == wanted


def test_both_hands_of_a_shared_lift_are_an_indication(alone: Callable[..., Any], solution: Any) -> None:
    lift = alone()
    shared = replace(lift, agents=(lift.agents[0], solution["robot"]))
    equation = niosh(shared, shared.agents[0])
    assert [why.split(":")[0] for why in equation.out_of_scope] == ["it is not for a load that is shared"]
    assert niosh_measure(equation).scope == "indicative"
    assert "A partner who gives way" in niosh_measure(equation).reading
    assert acgih_measure(shared, shared.agents[0], equation).scope == "indicative"
