"""Which solids must keep apart: oracles are the rules, and coal's distances of people who stand at rest."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from liftopt.multibody.person.human import human_agent
from liftopt.multibody.person.subject import Sex, Subject
from liftopt.multibody.person.whole_body import whole_human_agent
from liftopt.multibody.person.whole_joints import JOINTS, table_joint
from liftopt.multibody.solid_pairs import grasping_joints, solid_pairs
from liftopt.multibody.solids import placed_box, solids_of
from liftopt.scenario.build import agents_of, object_of
from liftopt.scenario.model import load_scenario
from liftopt.types import Array

TEAMS = Path(__file__).parents[1] / "scenario" / "teams"
TABLE5 = load_scenario()
AGENTS = agents_of(TABLE5)
SHELF = placed_box("shelf", (0.4, 1.2, 0.1), (0.6, 0.2, 0.5), 0.0)
PAIRS = solid_pairs(AGENTS, object_of(TABLE5), (SHELF,))


def _told(*names: str) -> set[str]:
    """Return the pairs, as sets of two, in which a solid of one of these names is."""
    return {pair.told for pair in PAIRS if {pair.one.told, pair.other.told} & set(names)}


def test_what_grasps_is_exempt_against_the_object_and_only_against_it() -> None:
    for hand in ("right hand of human", "gripper of robot", "flange of robot"):
        assert f"{hand} and table" not in _told(hand)
        assert {f"{hand} and shelf", f"{hand} and floor"} <= _told(hand)
    assert "right forearm of human and table" in _told("table")
    assert {"table and shelf", "table and floor", "head of human and table"} <= _told("table")


def test_the_floor_is_there_for_the_object_and_for_hands() -> None:
    assert _told("floor") == {
        "table and floor", "right hand of human and floor", "gripper of robot and floor", "flange of robot and floor",
    }  # fmt: skip


def test_person_and_robot_and_two_people_keep_apart_everywhere() -> None:
    human, robot = (len(solids_of(agent)) for agent in AGENTS)
    assert sum(pair.kind == "person-robot" for pair in PAIRS) == human * robot
    team = load_scenario(TEAMS / "two_people.toml")
    people = agents_of(team)
    pairs = solid_pairs(people, object_of(team))
    assert sum(pair.kind == "person-person" for pair in pairs) == human**2
    assert {pair.kind for pair in pairs} == {"person", "person-person", "person-object", "person-floor", "object-floor"}


def test_neighbours_at_a_joint_are_exempt_within_a_body() -> None:
    own = {pair.told for pair in PAIRS if pair.kind == "person"}
    for one, other in (
        ("shoulders", "right upper arm"), ("right upper arm", "right forearm"), ("right forearm", "right hand"),
        ("left hip", "left abdomen"), ("left hip", "left hand"),
    ):  # fmt: skip
        assert f"{one} of human and {other} of human" not in own
    for one, other in (
        ("right abdomen", "right upper arm"), ("right chest", "right upper arm"), ("head", "right hand"),
        ("left thigh", "right forearm"), ("left forearm", "right forearm"), ("right upper arm", "right hand"),
    ):  # fmt: skip
        assert f"{one} of human and {other} of human" in own
    robots = {pair.told for pair in PAIRS if pair.kind == "robot"}
    assert "link 1 joint of robot and link 2 tube of robot" not in robots
    assert {"link 4 tube of robot and gripper of robot", "head of robot and gripper of robot"} <= robots


@pytest.mark.parametrize("sex", ["male", "female"])
@pytest.mark.parametrize("stature", [1.5, 1.75, 1.95])
@pytest.mark.parametrize("body_mass_index", [17.0, 24.5, 35.0])
def test_an_arm_that_hangs_is_in_nothing(
    sex: Sex, stature: float, body_mass_index: float, coal_distance: ModuleType
) -> None:
    agent = human_agent(Subject(stature, body_mass_index * stature**2, sex))
    pairs = solid_pairs([agent], object_of(TABLE5))
    for q in (np.zeros(10), np.radians([0, 0, 0, 0, 0, 0, 0, -80, 0, 0]), agent.posture):
        nearest = coal_distance.own_distances(agent, pairs, q)
        assert min(nearest.values()) > 0.0, min(nearest, key=lambda pair: nearest[pair])


# Angles [deg] of a whole person, both arms alike.
SQUAT = {"ankle": 27.0, "knee": 105.0, "hip": 95.0, "Q2": 20.0}
SEMI = {"ankle": 18.0, "knee": 70.0, "hip": 90.0, "Q2": 22.0}
STOOP = {"ankle": -3.0, "knee": 15.0, "hip": 60.0, "Q2": 45.0}
HANG, CARRY = {"Q8": -80.0}, {"Q4": -15.0, "Q7": -60.0, "Q8": -60.0}
REACH = {"Q4": -8.0, "Q5": 25.0, "Q7": -20.0, "Q8": -80.0}
POSTURES = {
    "upright": {}, "hanging": HANG, "carrying": CARRY,
    **{f"{name}, {way}": legs | {"lean": 1.0} | arms
       for name, legs in (("squat", SQUAT), ("semi-squat", SEMI), ("stoop", STOOP))
       for way, arms in (("reaching", REACH), ("carrying", CARRY))},
}  # fmt: skip


def _whole(posture: dict[str, float]) -> Array:
    """Return joint angles (20,) [rad]; with ``lean`` the arms hang from a trunk that leans, or reach from there."""
    lean = posture.get("ankle", 0.0) - posture.get("knee", 0.0) + posture.get("hip", 0.0) + posture.get("Q2", 0.0)
    raised = {"Q5": posture.get("Q5", 0.0) + lean * posture.get("lean", 0.0)}
    return np.radians([(posture | raised).get(table_joint(joint), 0.0) for joint in JOINTS])


@pytest.mark.parametrize("sex", ["male", "female"])
@pytest.mark.parametrize("stature", [1.5, 1.75, 1.95])
@pytest.mark.parametrize("body_mass_index", [17.0, 24.5, 35.0])
def test_a_whole_person_is_in_nothing_of_itself(
    sex: Sex, stature: float, body_mass_index: float, coal_distance: ModuleType
) -> None:
    """Upright, in squats and in stoops, arms hanging, reaching to the floor and bent as with a box."""
    agent = whole_human_agent(Subject(stature, body_mass_index * stature**2, sex))
    pairs = solid_pairs([agent], object_of(TABLE5))
    for name, posture in POSTURES.items():
        q = _whole(posture)
        assert np.all(agent.limits.q_lower <= q) and np.all(q <= agent.limits.q_upper), name
        nearest = coal_distance.own_distances(agent, pairs, q)
        assert min(nearest.values()) > 0.0, (name, min(nearest, key=lambda pair: nearest[pair]))


def test_thighs_and_belly_give_way_and_the_rest_of_a_whole_person_does_not() -> None:
    agent = whole_human_agent(Subject(1.75, 75.0, "male"))
    own = {pair.told.replace(" of human", "") for pair in solid_pairs([agent], object_of(TABLE5)) if pair.within_body}
    for exempt in (
        "left thigh and left abdomen", "left shank and left thigh", "left thigh and left hip",
        "right upper arm and shoulders", "left upper arm and shoulders", "left shank and left foot",
    ):  # fmt: skip
        one, other = exempt.split(" and ")
        assert not own & {exempt, f"{other} and {one}"}, exempt
    for kept in (
        "left thigh and left chest", "left shank and left hip", "left thigh and left forearm",
        "right forearm and left forearm", "right hand and left hand", "left shank and right hand",
    ):  # fmt: skip
        one, other = kept.split(" and ")
        assert own & {kept, f"{other} and {one}"}, kept


def test_a_box_keeps_off_legs_and_a_free_hand() -> None:
    agent = whole_human_agent(Subject(1.75, 75.0, "male"), hands=("right",))
    pairs = solid_pairs([agent], object_of(TABLE5))
    against = {pair.one.name for pair in pairs if pair.kind == "person-object"}
    assert {"left shank", "right thigh", "left foot", "right forearm", "left hand"} <= against
    assert "right hand" not in against
    both = solid_pairs([whole_human_agent(Subject(1.75, 75.0, "male"))], object_of(TABLE5))
    assert "left hand" not in {pair.one.name for pair in both if pair.kind == "person-object"}
    for found in (pairs, both):
        assert {"left hand", "right hand"} <= {pair.one.name for pair in found if pair.kind == "person-floor"}


def test_parts_of_one_body_may_touch() -> None:
    """Whatever other bodies must keep: some links of a robot are as near to each other in every posture."""
    for pair in PAIRS:
        assert pair.asked(0.1) == (0.0 if pair.kind in ("person", "robot") else 0.1)
        assert pair.within_body == (pair.kind in ("person", "robot"))


@pytest.mark.parametrize("sex", ["male", "female"])
@pytest.mark.parametrize("body_mass_index", [17.0, 24.5, 35.0])
def test_the_free_arm_hangs_beside_the_body(sex: Sex, body_mass_index: float, coal_distance: ModuleType) -> None:
    """Upright, neither through the trunk nor behind it; its own shoulder is where it begins."""
    agent = human_agent(Subject(1.75, body_mass_index * 1.75**2, sex))
    at, solids = coal_distance.joint_placements(agent, np.zeros(10)), {one.name: one for one in solids_of(agent)}
    arm = [solids.pop(f"left {part}") for part in ("upper arm", "forearm", "hand")]
    legs_and_trunk = [solid for name, solid in solids.items() if not name.startswith("right ") or solid.joint in (0, 3)]
    for part in arm:
        for other in legs_and_trunk:
            apart = coal_distance.distance(part, at[part.joint], other, at[other.joint])
            assert apart > 0.0, (part.name, other.name)
        centre = at[part.joint] @ part.T_joint_solid
        assert abs(centre[0, 3]) < 1e-6 and centre[1, 3] > 0.15


def test_a_robot_in_its_posture_is_clear_of_itself(coal_distance: ModuleType) -> None:
    robot = AGENTS[1]
    assert min(coal_distance.own_distances(robot, PAIRS, robot.posture).values()) > 0.01


def test_the_grasp_frame_tells_what_grasps() -> None:
    assert [solid.name for agent in AGENTS for solid in solids_of(agent) if solid.joint in grasping_joints(agent)] == [
        "right hand", "flange", "gripper",
    ]  # fmt: skip
