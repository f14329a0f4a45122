"""What a scenario's holds make of an agent's grasps; oracle: frames of the model by Pinocchio, and the mirror."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from liftopt.multibody.agent import Agent
from liftopt.multibody.person.holds import hand_on
from liftopt.scenario.build import agent_key, agent_of, object_of
from liftopt.scenario.model import Scenario, load_scenario

BOX = {"object.depth": 0.6, "object.width": 0.4, "object.height": 0.3, "human.body": "whole"}
MIRROR = np.diag([1.0, -1.0, 1.0])


def held(place: str, **changes: object) -> Scenario:
    grasps = {"human_right": place, "human_left": place}
    return load_scenario("table5", {**BOX, "object.grasps": grasps, **changes})


def grips(agent: Agent, q: np.ndarray) -> list[np.ndarray]:
    """Return for each grasp R_world_object (3, 3) if that hand held the object as it does at its reference."""
    data = agent.model.createData()
    pin.framesForwardKinematics(agent.model, data, q)
    return [data.oMf[agent.model.getFrameId(grasp.frame)].rotation @ grasp.R_hand_object for grasp in agent.grasps]


@pytest.mark.parametrize("place", ["edge", "bottom", "corner", "side", "handle"])
def test_a_mirrored_posture_holds_alike_with_both_hands(place: str) -> None:
    agent = agent_of(held(place), "human")
    rng = np.random.default_rng(3)
    arm = rng.uniform(-1.0, 1.0, 7)
    q = np.concatenate([rng.uniform(0.0, 0.5, 3), [0.0, 0.4, 0.0], arm, arm])
    right, left = grips(agent, q)
    np.testing.assert_allclose(left, MIRROR @ right @ MIRROR, atol=1e-12)


def test_two_hands_are_named_and_meet_the_frames_of_the_object() -> None:
    scenario = held("side", **{"human.max_grasp_moment": 7.0})
    agent, lifted = agent_of(scenario, "human"), object_of(scenario)
    assert [(grasp.name, grasp.frame) for grasp in agent.grasps] == [
        ("human_right", "human_right_grasp"),
        ("human_left", "human_left_grasp"),
    ]
    assert all(grasp.moments and grasp.max_moment == 7.0 for grasp in agent.grasps)
    assert lifted.grasp_frames == ("grasp_human_right", "grasp_human_left", "grasp_robot")
    points = [lifted.model.frames[lifted.model.getFrameId(name)].placement.translation for name in lifted.grasp_frames]
    np.testing.assert_allclose(points, [[0.0, -0.2, 0.0], [0.0, 0.2, 0.0], [0.3, 0.0, -0.15]])


@pytest.mark.parametrize("hand", ["right", "left"])
def test_one_hand_is_called_after_its_agent(hand: str) -> None:
    scenario = load_scenario("table5", {"human.body": "whole", "human.hands": [hand]})
    (grasp,) = agent_of(scenario, "human").grasps
    assert (grasp.name, grasp.frame) == ("human", f"human_{hand}_grasp")
    assert object_of(scenario).grasp_frames == ("grasp_human", "grasp_robot")
    np.testing.assert_array_equal(grasp.R_hand_object.T, hand_on("edge", hand))  # type: ignore[arg-type]


def test_palms_turn_with_the_side_that_they_hold_and_hands_under_an_edge_with_the_person() -> None:
    turned = {"human.heading_deg": 100.0, "human.position": [0.6, -0.7]}
    turned |= {"task.start": {"x": 0.6, "z": 0.8}, "task.end": {"x": 0.6, "z": 1.1}}
    for place, angle in (("side", 90.0), ("edge", 100.0)):
        right, left = agent_of(held(place, **turned), "human").grasps
        about_z = pin.rpy.rpyToMatrix(0.0, 0.0, np.radians(angle))
        np.testing.assert_allclose(right.R_hand_object.T, about_z @ hand_on(place, "right"), atol=1e-12)  # type: ignore[arg-type]
        np.testing.assert_allclose(left.R_hand_object.T, about_z @ hand_on(place, "left"), atol=1e-12)  # type: ignore[arg-type]


def test_a_hand_in_a_handle_turns_about_a_bar_along_its_side() -> None:
    turned = {"human.heading_deg": 90.0, "human.position": [0.6, -0.7]}
    turned |= {"task.start": {"x": 0.6, "z": 0.8}, "task.end": {"x": 0.6, "z": 1.1}}
    for changes, along in (({}, [1.0, 0.0, 0.0]), (turned, [0.0, 1.0, 0.0])):
        for grasp in agent_of(held("handle", **changes), "human").grasps:
            assert grasp.bar is not None
            np.testing.assert_allclose(np.abs(grasp.bar), along, atol=1e-12)
    assert all(grasp.bar is None for place in ("side", "edge") for grasp in agent_of(held(place), "human").grasps)


def test_a_fist_comes_from_below_where_the_handle_is_higher_than_the_elbows() -> None:
    """By hand: the default person's elbows hang at about 1.1 m; the fists change their grip about there."""
    keys = {}
    for low in (0.6, 0.8, 1.2, 1.4):
        scenario = held("handle", **{"task.start": {"x": 0.6, "z": low}, "task.end": {"x": 0.6, "z": low + 0.2}})
        keys[low] = agent_key(scenario, "human")
        thumbs = [grasp.R_hand_object.T[:, 1] for grasp in agent_of(scenario, "human").grasps]
        np.testing.assert_allclose(thumbs, [[1.0 if low < 1.0 else -1.0, 0.0, 0.0]] * 2, atol=1e-12)
    assert keys[0.6] == keys[0.8] != keys[1.2] == keys[1.4]
    top = {"place": "handle", "position": [0.0, 0.0, 0.15]}
    high = {"task.start": {"x": 0.6, "z": 1.4}, "task.end": {"x": 0.6, "z": 1.6}}
    changes = {**BOX, "human.hands": ["right"], "object.grasps": {"human": top}, **high}
    (grasp,) = agent_of(load_scenario("table5", changes), "human").grasps
    np.testing.assert_allclose(grasp.R_hand_object.T[:, 1], [1.0, 0.0, 0.0], atol=1e-12)


def test_another_place_is_another_agent_to_caches() -> None:
    edge, side = held("edge"), held("side")
    assert agent_key(edge, "human") != agent_key(side, "human")
    assert agent_key(edge, "robot") == agent_key(side, "robot")
    assert agent_key(edge, "human") != agent_key(edge.replace({"human.hands": ["left"], "object.grasps": {}}), "human")
