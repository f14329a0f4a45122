"""Faults that public URDFs have, made in a sound arm: each is refused, warned of or told as what was assumed."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("yourdfpy")

from liftopt.errors import InputError
from liftopt.multibody.robots.examination import examined
from liftopt.multibody.robots.given_limits import GivenLimits
from liftopt.multibody.robots.read_robot import read_robot
from liftopt.multibody.robots.robot_agent import robot_agent

SAME = [(f'effort="{number}"', 'effort="300"') for number in (99, 98, 97, 96)]
FAULTS = {
    "zero mass at the end": (
        [('<mass value="1.0"/>', '<mass value="0"/>'), ('<mass value="0.1"/>', '<mass value="0"/>')],
        "mass.zero", "refused", "link l4: mass",
    ),
    "zero mass inside": ([('<mass value="3.0"/>', '<mass value="0"/>')], "mass.zero", "warned", "link l2: mass"),
    "negative mass": ([('<mass value="3.0"/>', '<mass value="-3"/>')], "mass.value", "refused", "link l2: mass"),
    "mass of no number": ([('<mass value="3.0"/>', '<mass value="nan"/>')], "mass.value", "refused", "link l2: mass"),
    "mass beyond all": ([('<mass value="3.0"/>', '<mass value="1e300"/>')], "mass.value", "refused", "link l2: mass"),
    "endless mass": ([('<mass value="3.0"/>', '<mass value="inf"/>')], "mass.value", "refused", "link l2: mass"),
    "base of no mass that is one": (
        [('<link name="base"/>', '<link name="base"><inertial><mass value="2"/></inertial></link>')],
        "mass.base", "warned", "link base: inertia",
    ),
    "inertia without mass": ([('<mass value="0.1"/>', "")], "inertia.massless", "warned", "link finger: inertia"),
    "no inertia": ([('ixx="0.022"', "")], "inertia.value", "refused", "link l2: inertia"),
    "negative moment": ([('ixx="0.022"', 'ixx="-0.01"')], "inertia.positive", "refused", "link l2: principal moments"),
    "no body has it": ([('ixx="0.022"', 'ixx="0.2"')], "inertia.triangle", "warned", "link l2: principal moments"),
    "no effort": ([('effort="98"', "")], "effort.missing", "refused", "joint j2: effort"),
    "effort zero": ([('effort="98"', 'effort="0"')], "effort.value", "refused", "joint j2: effort"),
    "effort beyond all": ([('effort="98"', 'effort="1e9"')], "effort.value", "refused", "joint j2: effort"),
    "range beyond all": ([('upper="2.2"', 'upper="1e9"')], "range.value", "refused", "joint j2: range"),
    "range that is no number": ([('upper="2.2"', 'upper="nan"')], "range.value", "refused", "joint j2: range"),
    "range of many turns": ([('upper="2.2"', 'upper="100"')], "range.wide", "warned", "joint j2: range"),
    "one effort for all": (SAME, "effort.same", "warned", "effort"),
    "effort of a placeholder": ([('effort="98"', 'effort="1000"')], "effort.large", "warned", "effort"),
    "velocity zero": ([('velocity="2"', 'velocity="0"')], "velocity.value", "refused", "joint j1: velocity"),
    "velocity of a placeholder": ([('velocity="2"', 'velocity="100"')], "velocity.large", "warned", "velocity"),
    "no range": ([('lower="-2.5" upper="2.2"', "")], "range.missing", "refused", "joint j2: range"),
    "inverted range": ([('upper="2.2"', 'upper="-2.6"')], "range.inverted", "refused", "joint j2: range"),
    "empty range": ([('lower="-2.5" upper="2.2"', 'lower="0" upper="0"')], "range.empty", "refused", "joint j2: range"),
    "continuous": (
        [('name="j2" type="revolute"', 'name="j2" type="continuous"'), ('lower="-2.5" upper="2.2"', "")],
        "range.endless", "assumed", "joint j2: range",
    ),
    "soft limits": (
        [('<axis xyz="0 0 1"/>', '<axis xyz="0 0 1"/><safety_controller soft_lower_limit="-2" soft_upper_limit="2"/>')],
        "range.soft", "assumed", "soft limits",
    ),
    "soft limits outside": (
        [('<axis xyz="0 0 1"/>', '<axis xyz="0 0 1"/><safety_controller soft_lower_limit="3" soft_upper_limit="4"/>')],
        "range.soft_outside", "warned", "joint j1: soft limits",
    ),
    "mimic beside": (
        [('effort="20" velocity="2"/>', 'effort="20" velocity="2"/><mimic joint="j1" multiplier="2" offset="0.02"/>')],
        "mimic.beside", "warned", "joint finger_joint",
    ),
    "finger": ([], "joints.held", "assumed", "joints that are held"),
    "prismatic": ([('name="j1" type="revolute"', 'name="j1" type="prismatic"')], "joint.prismatic",
        "assumed", "joint j1"),
    "lost mesh": (
        [('<link name="base"/>', '<link name="base"><visual><geometry><mesh filename="package://x/b.stl"/></geometry>'
          "</visual></link>")],
        "meshes.missing", "warned", "meshes",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("faults", "code", "severity", "where"), FAULTS.values(), ids=FAULTS)
def test_a_fault_is_found_with_its_place_and_a_way_out(arm, faults, code, severity, where):
    robot = read_robot(arm(*faults))
    found = {finding.code: finding for finding in reversed(examined(robot).findings)}
    assert code in found
    assert (found[code].severity, found[code].where) == (severity, where)
    assert found[code].fix and found[code].told
    if severity == "refused":
        with pytest.raises(InputError, match=where):
            robot_agent(robot, name="robot", T_world_base=np.eye(4))
    else:
        assert robot_agent(robot, name="robot", T_world_base=np.eye(4)).model.nq == 4


def test_a_sound_arm_has_only_assumptions(arm):
    assert {(f.code, f.severity) for f in examined(read_robot(arm())).findings} == {
        ("grasp.proposed", "assumed"), ("joints.held", "assumed"), ("solids.tubes", "assumed"),
    }  # fmt: skip


def test_limits_that_are_given_replace_those_that_are_wrong(arm):
    robot = read_robot(arm(('effort="98"', 'effort="0"'), ('lower="-2.5" upper="2.2"', "")))
    limits = {"j2": GivenLimits(lower=-1.0, upper=1.5, effort=50.0)}
    agent = robot_agent(robot, name="robot", T_world_base=np.eye(4), limits=limits)
    assert (agent.limits.q_lower[1], agent.limits.q_upper[1], agent.limits.effort[1]) == (-1.0, 1.5, 50.0)
    with pytest.raises(InputError, match="'j22': it has no joint of this name"):
        examined(robot, limits={"j22": GivenLimits()})


@pytest.mark.parametrize(
    ("faults", "kwargs", "told"),
    [
        ([('<link name="base"/>', '<link name="base"/><link name="stand"/>')], {}, r"several roots \(base, stand\)"),
        ([('name="j1" type="revolute"', 'name="j1" type="floating"')], {}, "say base = 'l1' to bolt that link down"),
        ([('name="j1" type="revolute"', 'name="j1" type="planar"')], {}, "'planar': such a base does not stay"),
        ([('effort="98" velocity="2"/>', 'effort="98" velocity="2"/><mimic joint="j1"/>')],
         {"grasp_frame": "tool0"}, "joint j2 = 'mimic of j1': joints of the chain move by themselves"),
        ([], {"base": "l2", "grasp_frame": "l1"}, "the base 'l2' does not carry this link"),
        ([], {"grasp_frame": "base"}, "no joint moves between it and the base"),
        ([], {"locked": {"j9": 0.0}}, "it has no joint of this name"),
        ([('name="tool0"', 'name="end"'), ('<child link="tool0"/>', '<child link="end"/>')],
         {"base": "l2"}, "no link looks like a hand"),
    ],
)  # fmt: skip
def test_what_has_no_chain_is_refused_with_words(arm, faults, kwargs, told):
    with pytest.raises(InputError, match=told):
        examined(read_robot(arm(*faults)), **kwargs)


def test_a_base_further_out_and_locked_joints_shorten_the_chain(arm):
    robot = read_robot(arm())
    found = examined(robot, base="l1", locked={"j3": 0.4})
    assert [joint.name for joint in found.chain.joints] == ["j2", "j4"]
    assert found.chain.held == {"j3": 0.4, "finger_joint": 0.01}
    assert found.chain.moving_mass == pytest.approx(3.0 + 2.0 + 1.0 + 0.1, abs=1e-12)
    assert "base.inner" in {finding.code for finding in found.findings}


def test_two_hands_are_told_apart_by_the_user(arm):
    body = arm()
    body = body[body.index('<link name="l1"') : body.index("</robot>")]
    for own in ("l1", "l2", "l3", "l4", "j1", "j2", "j3", "j4", "tool0", "finger"):
        body = body.replace(f'"{own}', f'"other_{own}')
    robot = read_robot(arm(("</robot>", body + "</robot>")))
    first = examined(robot).findings[0]
    assert (first.code, first.severity, "other_tool0" in first.message) == ("grasp.ambiguous", "warned", True)
    with pytest.raises(InputError, match="say grasp_frame"):
        robot_agent(robot, name="robot", T_world_base=np.eye(4))
    assert robot_agent(robot, name="robot", T_world_base=np.eye(4), grasp_frame="other_tool0").moving_joints == (
        "robot_other_j1", "robot_other_j2", "robot_other_j3", "robot_other_j4",
    )  # fmt: skip
