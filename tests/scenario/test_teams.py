"""Any team builds: oracle is where the scenario files say that everybody stands, and holds the object."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from liftopt.errors import InputError
from liftopt.multibody.agent import Agent
from liftopt.scenario.build import agents_of, object_of, task_of
from liftopt.scenario.model import Scenario, load_scenario
from liftopt.scenario.urdf_files import urdf_files

TEAMS = Path(__file__).with_name("teams")


@pytest.fixture(scope="module")
def two_people() -> Scenario:
    return load_scenario(TEAMS / "two_people.toml")


@pytest.fixture(scope="module")
def trio() -> Scenario:
    return load_scenario(TEAMS / "person_two_sawyers.toml")


def pose(agent: Agent, frame: str) -> pin.SE3:
    """Return where a frame of an agent is in the world at zero."""
    data = agent.model.createData()
    pin.framesForwardKinematics(agent.model, data, pin.neutral(agent.model))
    return data.oMf[agent.model.getFrameId(frame)]


def test_two_people_face_each_other_and_hold_opposite_edges(two_people: Scenario) -> None:
    anna, ben = agents_of(two_people)
    assert [(agent.name, agent.kind, agent.hands[0]) for agent in (anna, ben)] == [
        ("anna", "person", "anna_grasp"),
        ("ben", "person", "ben_grasp"),
    ]
    lifted = object_of(two_people)
    assert (lifted.name, lifted.grasp_frames) == ("box", ("grasp_anna", "grasp_ben"))
    points = [lifted.model.frames[lifted.model.getFrameId(name)].placement.translation for name in lifted.grasp_frames]
    np.testing.assert_allclose(points, [[-0.25, 0.0, -0.15], [0.25, 0.0, -0.15]])
    # Feet 1.4 m apart, each towards the other: the foot frame's z axis is the way ahead (the paper's frame).
    for agent, x, ahead in ((anna, 0.0, 1.0), (ben, 1.4, -1.0)):
        placed = pose(agent, f"{agent.name}_base")
        np.testing.assert_allclose(placed.translation, [x, 0.0, 0.0], atol=1e-12)
        np.testing.assert_allclose(placed.rotation[:, 2], [ahead, 0.0, 0.0], atol=1e-12)
        assert agent.workspace is not None
        assert agent.workspace.normal @ [0.7, 0.0, 1.0] > agent.workspace.offset  # the object's place is in front
        assert all(name.startswith(agent.name + "_") for name in agent.moving_joints)
    task = task_of(two_people)
    assert task.agent_weights == (1.0, 2.0)
    np.testing.assert_allclose(task.start, [0.7, np.nan, 0.95, 0.0, 0.0, 0.0])


def test_a_person_moved_and_turned_is_the_same_person_elsewhere() -> None:
    """One rigid motion takes every frame of the one to that of the other."""
    at, turn = np.array([0.3, -0.2, 0.0]), np.radians(25.0)
    free = ["task.start={x=0.6, z=0.9}", "task.end={x=0.6, z=1.2}"]
    (was, _), (now, _) = (
        agents_of(load_scenario("table5", [*free, *changes]))
        for changes in ([], ["human.position=[0.3, -0.2]", "human.heading_deg=25"])
    )
    moved = pin.SE3(pin.rpy.rpyToMatrix(0.0, 0.0, turn), at)
    for frame in ("human_base", "human_Q4_link", "human_grasp"):
        np.testing.assert_allclose(pose(now, frame).homogeneous, (moved * pose(was, frame)).homogeneous, atol=1e-12)
    assert now.workspace is not None
    np.testing.assert_allclose(now.workspace.normal, moved.rotation[:, 0], atol=1e-12)
    assert now.workspace.offset == pytest.approx(now.workspace.normal @ at, abs=1e-12)
    np.testing.assert_allclose(
        moved.rotation @ was.grasps[0].R_hand_object.T, now.grasps[0].R_hand_object.T, atol=1e-12
    )


def test_a_person_and_two_sawyers_stand_and_hold_where_the_file_says(trio: Scenario) -> None:
    human, left, right = agents_of(trio)
    assert [agent.kind for agent in (human, left, right)] == ["person", "robot", "robot"]
    for agent, y, height, yaw in ((left, 0.5, 0.915, 200.0), (right, -0.5, 0.8, 160.0)):
        placed = pose(agent, f"{agent.name}_Q1")  # Table 3: its axis is the pedestal's
        assert placed.translation[:2] == pytest.approx([1.9, y], abs=1e-9)
        facing = pin.rpy.rpyToMatrix(0.0, 0.0, np.radians(yaw))[:, 0]
        base = pose(agent, f"{agent.name}_base").rotation[:, 2]  # the paper's Z is ahead
        np.testing.assert_allclose(base, facing, atol=1e-12)
        one = pose(agent, f"{agent.name}_Q1").translation[2]
        assert one - height == pytest.approx(pose(left, "left_Q1").translation[2] - 0.915, abs=1e-9)
    lifted = object_of(trio)
    points = [lifted.model.frames[lifted.model.getFrameId(name)].placement.translation for name in lifted.grasp_frames]
    np.testing.assert_allclose(points, [[-0.225, 0.0, -0.025], [0.225, 0.2, -0.025], [0.225, -0.2, -0.025]])
    assert lifted.unserved_row() is None
    task = task_of(trio)
    np.testing.assert_allclose(task.start, [0.625, 0.0, 0.9, 0.0, 0.0, 0.0])
    np.testing.assert_allclose(task.end, [0.625, np.nan, 1.2, 0.0, 0.0, 0.0])
    assert task.pose_upper[3] == pytest.approx(np.radians(10.0))  # three points that are on no line hold its roll


def test_files_are_named_after_the_agents_and_familiar_ones_as_ever(two_people: Scenario, trio: Scenario) -> None:
    assert urdf_files(two_people) == {"anna": "anna.urdf", "ben": "ben.urdf", "box": "box.urdf"}
    assert urdf_files(trio)["human"] == "human_arm.urdf"
    assert urdf_files(load_scenario())["robot"] == "sawyer.urdf"
    assert urdf_files(load_scenario("table5", ["human.body=whole"]))["human"] == "human.urdf"


@pytest.mark.parametrize(
    ("statement", "key", "said"),
    [
        ("agents.third={kind='robot', model='sawyer'}", "third.base.x", "only the two who face each other"),
        (
            "agents.third={kind='person', stature=1.7, mass=70.0, sex='male'}",
            "third.position",
            "only the two who face each other",
        ),
        (
            "agents.third={kind='robot', model='sawyer', base={x=1.9, y=1.3, yaw_deg=170}}",
            "object.grasps.third",
            r"by default it is where robot holds; must be \[x, y, z\]",
        ),
        ("agents.table={kind='robot', model='sawyer'}", "agents", "is the name of something else"),
        ("agents.solver={kind='robot', model='sawyer'}", "agents", "is the name of something else"),
        ("agents.force={kind='robot', model='sawyer'}", "agents", "is the name of something else"),
        ("agents.two words={kind='robot', model='sawyer'}", "agents", "1 to 32 letters"),
        ("object.name=human", "agents", "is the name of something else"),
        ("object.name=grasp", "object.name", "is the name of something else"),
        ("object.name=sawyer", "object.name", "the file sawyer.urdf is another one's"),
        (
            "agents.human_arm={kind='person', stature=1.7, mass=70.0, sex='male', position=[0.5, 1]}",
            "agents",
            "the file human_arm.urdf is another one's",
        ),
        ("object.name=a b", "object.name", "1 to 32 letters"),
        ("object.grasps={robbot=[0.2, 0.0, 0.0]}", "object.grasps.robbot", "did you mean robot"),
        ("object.grasps={robot=[0.2, 0.0]}", "object.grasps.robot", "a table of NAME = "),
        ("human.heading_deg=20", "task.start.human_distance", "faces along X"),
        ("task.start={height=0.9, human_distance=0.4, x=0.6}", "task.start.", "either height and human_distance"),
        ("task.start=3", "task.start", "height and human_distance, or x, y and z"),
        ("agents={}", "agents", "is empty"),
        ("agents={anna={kind='robot', model='sawyer'}}", "anna.base.x", "only the two who face each other"),
        ("agents.human.kind=dog", "human.kind", '"person" or "robot"'),
        ("human=3", "human", "must be a section of an agent"),
        ("human.position=3", "human.position", "two numbers"),
    ],
)
def test_what_does_not_fit_is_one_line_that_names_the_key(statement: str, key: str, said: str) -> None:
    with pytest.raises(InputError, match=said) as caught:
        load_scenario("table5", [statement])
    assert caught.value.key.startswith(key)
    assert "\n" not in str(caught.value)


def test_no_person_no_distance_from_feet(trio: Scenario) -> None:
    tables = trio.to_dict()
    del tables["agents"]["human"]
    tables["agents"]["left"]["base"]["x"] = 1.9
    tables["object"]["grasps"]["right"] = [-0.225, 0.0, 0.0]
    from liftopt.scenario.model import scenario_from_dict

    assert len(scenario_from_dict(tables).agents) == 2
    tables["task"]["start"] = {"height": 0.9, "human_distance": 0.4}
    with pytest.raises(InputError, match="counts from the feet of a person"):
        scenario_from_dict(tables)


def test_an_agent_by_another_name_is_told_who_may_be_meant(two_people: Scenario) -> None:
    with pytest.raises(InputError, match=r"^human\.stature = 1\.7: unknown key; did you mean anna\.stature"):
        two_people.replace({"human.stature": 1.7})
