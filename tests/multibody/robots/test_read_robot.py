"""Robots from outside as they are read. Oracle: what the text says, written here by hand."""

from __future__ import annotations

import re
import sys
from itertools import count
from pathlib import Path
from random import Random

import numpy as np
import pinocchio as pin
import pytest

pytest.importorskip("yourdfpy")

from liftopt.errors import InputError
from liftopt.multibody.robots import written_robot
from liftopt.multibody.robots.package_files import file_of
from liftopt.multibody.robots.read_robot import read_robot
from liftopt.multibody.robots.robot_agent import robot_agent
from liftopt.storage.urdf_check import check_urdf


def test_links_and_joints_are_those_of_the_text(arm):
    robot = read_robot(arm())
    assert (robot.roots, robot.leaves, len(robot.links), len(robot.joints)) == (("base",), ("tool0", "finger"), 7, 6)
    joint = robot.joint("j2")
    assert (joint.kind, joint.lower, joint.upper, joint.effort, joint.velocity) == ("revolute", -2.5, 2.2, 98.0, 2.0)
    np.testing.assert_array_equal(joint.axis, [0.0, 1.0, 0.0])
    np.testing.assert_array_equal(joint.placement[:3, 3], [0.0, 0.0, 0.3])
    body = robot.link("l2").body
    assert body.mass == 3.0
    np.testing.assert_array_equal(body.com, [0.0, 0.0, 0.1])
    np.testing.assert_array_equal(np.diag(body.inertia), [0.022, 0.02, 0.01])
    assert [j.name for j in robot.joints_between("l1", "tool0")] == ["j2", "j3", "j4", "tool0_mount"]
    assert robot.joints_between("l4", "l1") is None


@pytest.mark.parametrize(
    ("fault", "told"),
    [
        (('<robot name="arm">', '<robot name="arm">&nonsense;'), "is no XML"),
        (('<robot name="arm">', '<!DOCTYPE x><robot name="arm">'), "declares a document type"),
        (('mass value="3.0"', 'mass value="3,0"'), r"link l2: mass value = '3,0': must be a number"),
        (('axis xyz="1 0 0"', 'axis xyz="0 0 0"'), r"axis = \[0.0, 0.0, 0.0\]: must be a direction"),
        (('xyz="0 0 0.3"', 'xyz="0 0.3"'), "must be 3 numbers"),
        (('xyz="0 0 0.3"', 'xyz="0 0 nan"'), "joint j1: origin xyz = '0 0 nan': must be 3 numbers within 1e\\+06"),
        (('<parent link="l3"/>', '<parent link="l9"/>'), "joint j4: parent = 'l9'"),
        (('<parent link="base"/>', '<parent link="l3"/>'), "in a loop"),
        (('joint name="j2"', 'joint name="j1"'), "2 of its joints have this name"),
        (('<child link="l3"/>', '<child link="l2"/>'), "two joints carry it"),
        (('name="j3" type="revolute"', 'name="j3" type="ball"'), "joint j3: type = 'ball': must be one of revolute"),
        (('<axis xyz="1 0 0"/>', '<axis xyz="1 0 0"/><mimic joint="j9"/>'), "mimic joint = 'j9'"),
    ],
)
def test_what_is_no_urdf_is_told_with_its_place(arm, fault, told):
    with pytest.raises(InputError, match=told):
        read_robot(arm(fault))


def test_what_nobody_needs_is_left_aside(arm):
    """Deep nesting ends many a reader, and sensors and plugins may hold anything."""
    deep = "<a>" * 2000 + "</a>" * 2000
    text = arm(('<link name="base"/>', f'<link name="base"><visual>{deep}</visual></link><gazebo>{deep}</gazebo>'))
    assert len(read_robot(text).links) == 7
    other = read_robot("<?xml version='1.0' encoding='latin-1'?>" + text.replace('name="arm"', 'name="Rüssel"'))
    assert other.name == "Rüssel"


def test_a_name_that_is_none_offers_the_nearest(arm):
    with pytest.raises(InputError, match=r"'tool': it has no link of this name; did you mean tool0\?"):
        read_robot(arm()).link("tool")


def test_a_file_that_is_none_is_told(tmp_path: Path):
    with pytest.raises(InputError, match="there is no such file"):
        read_robot(tmp_path / "arm.urdf")
    (tmp_path / "scenario.urdf").write_text("<scenario/>")
    with pytest.raises(InputError, match="outermost element is <robot>"):
        read_robot(tmp_path / "scenario.urdf")


def test_packages_are_found_above_the_file_and_in_ros_package_path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    inside, apart = tmp_path / "arm_description", tmp_path / "elsewhere" / "hand_description"
    for folder in (inside / "urdf", inside / "meshes", apart):
        folder.mkdir(parents=True)
    (inside / "meshes" / "l1.stl").write_text("")
    (apart / "palm.stl").write_text("")
    urdf = inside / "urdf" / "arm.urdf"
    assert file_of("package://arm_description/meshes/l1.stl", urdf) == inside / "meshes" / "l1.stl"
    assert file_of("../meshes/l1.stl", urdf).resolve() == (inside / "meshes" / "l1.stl").resolve()
    assert file_of("package://hand_description/palm.stl", urdf) is None
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(apart.parent))
    assert file_of("package://hand_description/palm.stl", urdf) == apart / "palm.stl"


def test_xacro_is_expanded_with_its_arguments_and_packages(arm, tmp_path: Path):
    pytest.importorskip("xacro")
    folder = tmp_path / "arm_description"
    folder.mkdir()
    head = '<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="mass" default="3.0"/>'
    text = arm(('<robot name="arm">', head), ('mass value="3.0"', 'mass value="$(arg mass)"'))
    (folder / "part.xacro").write_text(text)
    (folder / "arm.urdf.xacro").write_text(
        '<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        '<xacro:include filename="$(find arm_description)/part.xacro"/></robot>'
    )
    assert read_robot(folder / "arm.urdf.xacro").link("l2").body.mass == 3.0
    assert read_robot(folder / "arm.urdf.xacro", arguments={"mass": "2.5"}).link("l2").body.mass == 2.5
    (folder / "part.xacro").write_text(text.replace("$(arg mass)", "${nothing}"))
    with pytest.raises(InputError, match=r"xacro cannot expand it.*nothing"):
        read_robot(folder / "arm.urdf.xacro")


ODD = ("", "nan", "inf", "-1", "0", "1e400", "1e308", "abc", "0 0 0", "base")


@pytest.mark.parametrize("package", ["yourdfpy", "xacro"])
def test_a_package_that_is_missing_is_named_with_how_to_install_it(arm, package, tmp_path, monkeypatch):
    (tmp_path / "arm.xacro").write_text(arm())
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(InputError, match=rf"{package}.*pip install \"liftopt\[robots\]\""):
        read_robot(arm() if package == "yourdfpy" else tmp_path / "arm.xacro")


def _spoilt(text: str, random: Random) -> str:
    """Return a text with an attribute changed or lost, an element lost or doubled, or some characters cut out."""
    pattern, put = random.choice((
        (r'"[^"]*"', '"' + random.choice(ODD) + '"'),
        (r' \w+="[^"]*"', ""),
        (r"<\w+[^<>]*/>", random.choice(("", r"\g<0>\g<0>"))),
        (r'type="revolute"', f'type="{random.choice(("floating", "continuous", "prismatic", "fixed", "ball"))}"'),
        (r"(?s).{1,30}", ""),
    ))  # fmt: skip
    found = random.choice(list(re.finditer(pattern, text)))
    return text[: found.start()] + found.expand(put) + text[found.end() :]


@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_a_spoilt_file_is_refused_in_one_line_or_gives_a_model_of_numbers(arm, monkeypatch):
    # A posture for each of them would take most of the time; one in ten gets one.
    found, made = written_robot.resting_posture, count()

    def posture(model, frame, limits, *more):
        middle = (limits.q_lower + limits.q_upper) / 2.0
        return middle if next(made) % 10 else found(model, frame, limits, *more)

    monkeypatch.setattr(written_robot, "resting_posture", posture)
    random, outcomes = Random(5), {"refused": 0, "taken": 0}
    for _ in range(300):
        text = arm()
        for _ in range(random.randint(1, 3)):
            text = _spoilt(text, random)
        try:
            agent = robot_agent(read_robot(text), name="robot", T_world_base=np.eye(4))
        except InputError as error:
            assert "\n" not in str(error)
            outcomes["refused"] += 1
            continue
        check_urdf(agent.urdf)
        assert np.isfinite(pin.crba(agent.model, agent.model.createData(), agent.posture)).all()
        outcomes["taken"] += 1
    assert min(outcomes.values()) > 30, outcomes


def test_a_package_goes_by_the_name_in_its_package_xml(tmp_path: Path):
    """A repository's folder is often called otherwise than the package in it."""
    folder = tmp_path / "Arms_ROS2_Description"
    (folder / "urdf").mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name> arm_description </name></package>")
    (folder / "l1.stl").write_text("")
    assert file_of("package://arm_description/l1.stl", folder / "urdf" / "arm.urdf") == folder / "l1.stl"
    (folder / "package.xml").write_bytes(b"\xff<package>")
    assert file_of("package://arm_description/l1.stl", folder / "urdf" / "arm.urdf") is None


def test_a_macro_that_xacro_leaves_alone_is_named(arm):
    inertia = '<inertia ixx="0.022" iyy="0.02" izz="0.01" ixy="0" ixz="0" iyz="0"/>'
    with pytest.raises(InputError, match=r"link l2: inertial = '<box_inertia>': .* as <xacro:box_inertia \.\.\.>"):
        read_robot(arm((inertia, '<box_inertia mass="3" x="0.1"/>')))
