"""Where hands hold the object: the oracle is the box's geometry, by hand."""

from __future__ import annotations

import pytest

from liftopt.errors import InputError
from liftopt.multibody.person.anthropometry import dimension
from liftopt.multibody.person.subject import Subject
from liftopt.scenario.build import task_of
from liftopt.scenario.grasps import grasp_heights, grasp_points, placed_grasps
from liftopt.scenario.model import Scenario, load_scenario, scenario_from_dict

BOX = {"object.depth": 0.6, "object.width": 0.4, "object.height": 0.3}
CENTRED = {"task.start": {"x": 0.7, "z": 0.8}, "task.end": {"x": 0.7, "z": 1.1}}


def whole(**grasps: object) -> Scenario:
    changes = {**BOX, "human.body": "whole"}
    return load_scenario("table5", {**changes, "object.grasps": grasps} if grasps else changes)


def test_an_arm_has_the_right_hand_and_a_whole_body_both() -> None:
    one = load_scenario("table5", BOX)
    assert one.value("human.hands") == ("right",)
    assert [(grasp.name, grasp.hand) for grasp in placed_grasps(one)] == [("human", "right"), ("robot", None)]
    both = one.replace({"human.body": "whole"})
    assert both.value("human.hands") == ("right", "left")
    assert [(grasp.name, grasp.agent, grasp.hand) for grasp in placed_grasps(both)] == [
        ("human_right", "human", "right"),
        ("human_left", "human", "left"),
        ("robot", "robot", None),
    ]
    left = both.replace({"human.hands": ["left"]})
    assert [(grasp.name, grasp.hand) for grasp in placed_grasps(left)] == [("human", "left"), ("robot", None)]
    assert grasp_points(left)["human"] == grasp_points(one)["human"]


def test_another_body_drops_hands_that_the_same_changes_do_not_say() -> None:
    both = whole()
    assert both.replace({"human.body": "arm"}).value("human.hands") == ("right",)
    assert both.replace({"human.hands": ["left", "right"]}) == both
    one = load_scenario("table5", {"human.body": "whole", "human.hands": ["left"]})
    assert one.replace({"object.mass": 4.0}).value("human.hands") == ("left",)
    assert one.replace({"human.body": "arm", "human.hands": ["right"]}).value("human.hands") == ("right",)
    assert load_scenario("table5", one.entries()) == one


def test_two_hands_are_a_shoulders_breadth_apart_or_at_the_ends_of_a_narrow_edge() -> None:
    subject = Subject(1.75, 75.0, "male")
    shoulders, hand = dimension(subject, "biacromialbreadth"), dimension(subject, "handbreadth")
    for width, apart in ((1.0, shoulders), (0.3, 0.3 - hand)):
        points = grasp_points(whole().replace({"object.width": width}))
        (x, y, z), (also_x, left, also_z) = points["human_right"], points["human_left"]
        assert (x, z) == (also_x, also_z) == (-0.3, -0.15)
        assert left == -y == pytest.approx(apart / 2.0, abs=5e-4)


@pytest.mark.parametrize(
    ("place", "right"),
    [
        ("bottom", (-0.28, None, -0.15)),  # 0.02 m in from the edge
        ("corner", (-0.3, -0.2, -0.15)),
        ("side", (0.0, -0.2, 0.0)),
        ("handle", (0.0, -0.2, 0.1)),  # 0.05 m below the top
    ],
)
def test_places_by_name(place: str, right: tuple[float | None, ...]) -> None:
    held = {grasp.name: grasp for grasp in placed_grasps(whole(human_right=place, human_left=place))}
    assert held["human_right"].hold == held["human_left"].hold == place
    for at, expected in zip(held["human_right"].point, right, strict=True):
        assert expected is None or at == pytest.approx(expected, abs=1e-12)
    x, y, z = held["human_right"].point
    assert held["human_left"].point == (x, -y, z)
    one = load_scenario("table5", {**BOX, "object.grasps": {"human": place}})
    sideways = 0.0 if place == "bottom" else y
    assert grasp_points(one)["human"] == (x, sideways, z)


def test_a_place_may_have_a_position_of_its_own() -> None:
    held = placed_grasps(
        whole(human_right={"place": "handle", "position": [0.1, -0.22, 0.1]}, human_left=[0.0, 0.2, 0.0])
    )
    assert [(grasp.hold, grasp.point) for grasp in held[:2]] == [
        ("handle", (0.1, -0.22, 0.1)),
        ("edge", (0.0, 0.2, 0.0)),
    ]


@pytest.mark.parametrize(
    ("heading", "edge", "right_side"),
    [
        (0.0, (-0.3, 0.0), (0.0, -0.2)),
        (30.0, (-0.3, 0.0), (0.0, -0.2)),
        (90.0, (0.0, -0.2), (0.3, 0.0)),
        (-100.0, (0.0, 0.2), (-0.3, 0.0)),
    ],
)
def test_the_edge_is_that_before_the_agent_and_the_sides_are_its_own(
    heading: float, edge: tuple[float, float], right_side: tuple[float, float]
) -> None:
    base = load_scenario("table5", {**BOX, **CENTRED, "human.heading_deg": heading})
    assert grasp_points(base)["human"] == (*edge, -0.15)
    assert grasp_points(base.replace({"object.grasps": {"human": "side"}}))["human"] == (*right_side, 0.0)


def test_heights_and_distances_are_those_of_the_middle_of_the_hands() -> None:
    """By hand: hands in the middle of the sides 0.4 m ahead, the robot at the bottom edge 0.15 m below them."""
    scenario = whole(human_right="side", human_left="side")
    start = task_of(scenario).start
    assert start[0] == pytest.approx(0.4)
    assert start[2] == pytest.approx(0.9 + 0.15 / 2.0)
    edges = task_of(whole()).start
    assert (edges[0], edges[2]) == (pytest.approx(0.7), pytest.approx(1.05))
    own = scenario.replace({"task.start": {"x": float(start[0]), "z": float(start[2])}})
    assert grasp_heights(own)[0] == pytest.approx(0.9)


def test_two_whole_people_hold_opposite_edges_each_with_hands_of_their_own() -> None:
    tables = whole().to_dict()
    tables["agents"] = {"anna": tables["agents"]["human"], "ben": {**tables["agents"]["human"], "stature": 1.9}}
    points = grasp_points(scenario_from_dict(tables))
    assert list(points) == ["anna_right", "anna_left", "ben_right", "ben_left"]
    assert (
        points["anna_right"][0] == points["anna_left"][0] == -points["ben_right"][0] == -points["ben_left"][0] == -0.3
    )
    assert points["anna_right"][1] < 0.0 < points["anna_left"][1]
    assert points["ben_left"][1] < 0.0 < points["ben_right"][1]  # they face each other


def test_one_whole_person_alone_lifts_with_hands_at_the_height_that_is_asked() -> None:
    tables = whole(human_right="handle", human_left="handle").to_dict()
    del tables["agents"]["robot"]
    alone = scenario_from_dict(tables)
    assert [grasp.name for grasp in placed_grasps(alone)] == ["human_right", "human_left"]
    start = task_of(alone).start
    assert (start[0], start[2]) == (
        pytest.approx(0.4),
        pytest.approx(0.9 - 0.1),
    )  # the handles are 0.1 m above the centre


def test_point_grasps_that_are_on_no_line_hold_the_roll() -> None:
    paper = {"objective.preset": "paper", **BOX}
    assert task_of(load_scenario("table5", paper)).pose_upper[3] == 0.0
    assert task_of(load_scenario("table5", {**paper, "human.body": "whole"})).pose_upper[3] > 0.0


@pytest.mark.parametrize(
    ("changes", "key", "said"),
    [
        ({"human.hands": ["left"]}, "human.hands", 'set body = "whole"'),
        ({"human.hands": ["right", "left"]}, "human.hands", 'must be \\["right"\\]'),
        ({"human.hands": []}, "human.hands", '= \\[\\]: must be a list of "right" and "left"'),
        ({"human.hands": ["left", "left"]}, "human.hands", '"left", each at most once'),
        ({"human.body": "whole", "object.width": 0.15}, "object.grasps.human_right", "too broad for an edge of 150 mm"),
        (
            {"human.body": "whole", "object.grasps": {"human": "side"}},
            "object.grasps.human",
            "human_right or human_left",
        ),
        ({"object.grasps": {"human": "hande"}}, "object.grasps.human", '"edge", "bottom", "corner", "side", "handle"'),
        ({"object.grasps": {"robot": "side"}}, "object.grasps.robot", 'must be "edge"'),
        ({"object.grasps": {"human": [-0.45, 0.0, 0.0]}}, "object.grasps.human", "x must be from -0.4 to 0.4 m"),
        (
            {"human.body": "whole", "object.grasps": {"human_right": "side", "human_left": [0.0, -0.2, 0.0]}},
            "object.grasps.human_left",
            "is where human_right holds",
        ),
        ({"human.contact": "flat", "object.grasps": {"human": "side"}}, "object.grasps.human", "a flat hand"),
        (
            {
                "human.body": "whole",
                "agents.human_left": {"kind": "robot", "model": "sawyer", "base": {"x": 1.0, "y": 1.0}},
            },
            "agents",
            "is the name of a hand of human",
        ),
        (
            {"objective.preset": "paper", "object.grasps": {"human": [-0.3, 0.1, 0.0], "robot": [0.3, 0.1, 0.0]}},
            "human.grasp",
            "whose weight is beside it",
        ),
    ],
)
def test_what_hands_cannot_do_is_one_line_that_names_the_key(changes: dict[str, object], key: str, said: str) -> None:
    with pytest.raises(InputError, match=said) as caught:
        load_scenario("table5", {**BOX, **changes})
    assert caught.value.key == key
    assert "\n" not in str(caught.value)
