"""Any robot's motion as files. Oracles: Pinocchio on the robot's own URDF, rosbags' readers, Python's parsers."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from liftopt.commands.cli import main
from liftopt.commands.exit_status import BAD_INPUT, DONE
from liftopt.errors import InputError
from liftopt.lab.robot.joint_map import JointMap
from liftopt.lab.robot.joint_trajectory import joint_trajectory
from liftopt.lab.robot.robot_limits import check_curve, check_limits
from liftopt.lab.robot.robot_remarks import remarks
from liftopt.lab.robot.robot_start import check_start
from liftopt.lab.robot.trajectory_controller import controller_curve
from liftopt.multibody.robots import example_robot_data
from liftopt.multibody.robots.catalogue import known_robots
from liftopt.solution.interpolation import between_knots
from liftopt.solution.solution import Solution

ROBOTS = ("ur10", "panda", "tiago", "tiago_lifting")
TOOL = {"ur10": (0.0, 0.0, 0.1), "panda": (0.0, 0.0, 0.1), "tiago": (0.1, 0.0, 0.0), "tiago_lifting": (0.1, 0.0, 0.0)}
HELD = {"tiago": {"torso_lift_joint": 0.2}}
Lifts = Callable[[str], Solution]
Folders = Callable[[str], Path]


@pytest.mark.parametrize("name", ROBOTS)
def test_the_robots_own_urdf_puts_the_hand_where_the_solution_has_it(arm_lift: Lifts, name: str) -> None:
    solution, known = arm_lift(name), known_robots()[name]
    assert known.path is not None
    trajectory = joint_trajectory(solution, robot="arm")
    model = pin.buildModelFromUrdf(str(known.path))
    order = [model.getJointId(joint) for joint in trajectory.names]
    assert max(order) < model.njoints and order == sorted(order)  # its names, from base to hand
    data, frame, base = model.createData(), model.getFrameId(known.grasp_frame), model.getFrameId(known.base)
    stand = solution.scenario.agents["arm"].base
    world = pin.SE3(pin.rpy.rpyToMatrix(0.0, 0.0, np.pi), np.array([stand.x, 0.0, stand.z]))
    dense = between_knots(solution)
    for time, hand in zip(dense.time[::20], dense["arm"].p_world_hold[::20], strict=True):
        q = pin.neutral(model)
        for joint, value in zip(order, trajectory.position[round(100 * time)], strict=True):
            assert model.joints[joint].nq == 1 or abs(value) <= np.pi  # a joint without end has cosine and sine
            at = model.joints[joint].idx_q
            q[at : at + model.joints[joint].nq] = (
                [value] if model.joints[joint].nq == 1 else [np.cos(value), np.sin(value)]
            )
        for joint, value in HELD.get(name, {}).items():
            q[model.joints[model.getJointId(joint)].idx_q] = value
        pin.framesForwardKinematics(model, data, q)
        found = world * data.oMf[base].actInv(data.oMf[frame]).act(np.array(TOOL[name]))
        np.testing.assert_allclose(found, hand, rtol=0, atol=1e-6)


@pytest.mark.parametrize("name", ROBOTS)
def test_the_controllers_curve_meets_points_and_limits(arm_lift: Lifts, name: str) -> None:
    """Between the points of a plan whose positions are cubic it is the plan; its slope by finite difference."""
    solution = arm_lift(name)
    check_limits(solution)
    trajectory = joint_trajectory(solution)
    assert check_curve(solution, trajectory, 100.0) < 1e-9  # knots are among the points
    time, value, slope = controller_curve(trajectory).sampled(10)
    inside = np.diff(time) > 0.0
    steps = np.diff(time)[inside, None]
    np.testing.assert_allclose(
        np.diff(value, axis=0)[inside] / steps, (slope[1:] + slope[:-1])[inside] / 2, rtol=0, atol=1e-4
    )
    off = check_curve(solution, joint_trajectory(solution, 13.0), 13.0)
    assert 1e-9 < off < 1e-2  # knots that are no points


@pytest.mark.parametrize("bag", ["trajectory.bag", "trajectory_ros2", "trajectory_mcap"])
def test_bags_of_a_lifting_column_read_back(
    arm_lift: Lifts, arm_folder: Folders, tmp_path: Path, bag: str, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("rosbags", reason="rosbags is in the extra 'lab'")
    from rosbags.highlevel import AnyReader

    kind = {"trajectory.bag": "ros1", "trajectory_ros2": "ros2", "trajectory_mcap": "mcap"}[bag]
    words = ["--format", kind, "--controller", "whole/arm_controller", "--json"]
    assert main(["export", str(arm_folder("tiago_lifting")), "--out", str(tmp_path / "out"), *words]) == DONE
    told = json.loads(capsys.readouterr().out)
    topic = "/whole/arm_controller/follow_joint_trajectory/goal"
    assert told["topic"] == topic and told["mode"] is None and told["files"] == [bag]
    with AnyReader([tmp_path / "out" / bag]) as reader:
        found = {c.topic: reader.deserialize(raw, c.msgtype) for c, _, raw in reader.messages()}
    goal = found[topic].goal if kind == "ros1" else found[topic]
    expected = joint_trajectory(arm_lift("tiago_lifting"))
    for sent in (goal.trajectory, found["/liftopt/joint_trajectory"]):
        assert (
            list(sent.joint_names) == told["joints"] == ["torso_lift_joint", *(f"arm_{i}_joint" for i in range(1, 8))]
        )
        np.testing.assert_array_equal([p.positions for p in sent.points], expected.position)
        np.testing.assert_array_equal([p.velocities for p in sent.points], expected.velocity)


def test_locked_joints_are_written_where_they_are_asked_for(
    arm_folder: Folders, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["export", str(arm_folder("tiago")), "--format", "csv", "--format", "json", "--out"]
    assert main([*command, str(tmp_path / "a")]) == DONE
    assert "held and not written: torso_lift_joint at 0.2" in capsys.readouterr().out
    assert main([*command, str(tmp_path / "b"), "--held-joints"]) == DONE
    assert "held and not written" not in capsys.readouterr().out
    for folder, more in (("a", []), ("b", ["torso_lift_joint"])):
        with (tmp_path / folder / "trajectory.csv").open(newline="") as file:
            header, *rows = csv.reader(file)
        names = [f"arm_{i}_joint" for i in range(1, 8)] + more
        assert header == ["time", *names, *(f"velocity_{n}" for n in names), *(f"acceleration_{n}" for n in names)]
        goal = json.loads((tmp_path / folder / "trajectory.json").read_text())["trajectory"]
        assert goal["joint_names"] == names
        values = np.array(rows, float)[:, 1 : 1 + len(names)]
        np.testing.assert_array_equal([p["positions"] for p in goal["points"]], values)
        if more:
            assert set(values[:, -1]) == {0.2} and {p["velocities"][-1] for p in goal["points"]} == {0.0}


@pytest.mark.parametrize("rate", ["125", "500"])
def test_the_program_of_a_universal_robot_follows_the_solution(
    arm_lift: Lifts, arm_folder: Folders, ur_controller: Any, tmp_path: Path, rate: str
) -> None:
    words = ["--format", "urscript", "--servo-rate", rate]
    assert main(["export", str(arm_folder("ur10")), "--out", str(tmp_path / "out"), *words]) == DONE
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["trajectory.script"]
    fine = joint_trajectory(arm_lift("ur10"), 1000.0)
    arm = ur_controller.Controller(fine.position[0])
    arm.run((tmp_path / "out" / "trajectory.script").read_text("utf-8"))
    step = 1000 // int(rate)
    targets = np.array([one["q"] for one in arm.of("servoj")])
    moving = fine.position[step::step]
    np.testing.assert_allclose(targets[: len(moving)], moving, rtol=0, atol=1e-9)
    np.testing.assert_allclose(
        targets[len(moving) :], np.tile(fine.position[-1], (len(targets) - len(moving), 1)), atol=1e-9
    )


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--format", "urscript"], "--format = 'urscript': must be one of ros1, ros2, mcap, csv, json for this robot"),
        (["--mode", "velocity"], "--mode = 'velocity': is of Sawyer's action server"),
        (["--controller", "a b"], "--controller = 'a b': must be a name of ROS"),
        (["--controller", ""], "--controller = '': must be a name of ROS"),
        (["--current-pose", "0 0"], "must be seven angles in radians, panda_joint1, panda_joint2"),
        (["--current-pose", "0 0 0 0 0 0 0"], "rad (0 s); less than 0.2 rad is accepted: move the arm there first"),
    ],
)
def test_what_is_not_for_this_robot_is_one_line(
    arm_folder: Folders, tmp_path: Path, capsys: pytest.CaptureFixture[str], words: list[str], said: str
) -> None:
    command = ["export", str(arm_folder("panda")), "--out", str(tmp_path / "out"), "--format", "csv", *words]
    assert main(command) == BAD_INPUT
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1 and not list(tmp_path.iterdir())


def test_limits_and_starts_have_the_units_of_each_joint(arm_lift: Lifts) -> None:
    solution = arm_lift("tiago_lifting")
    human, arm = solution.agents
    column = int(np.flatnonzero(arm.moving)[0])
    still = replace(arm, q=np.tile(arm.q[4], (len(arm.q), 1)), v=0.0 * arm.v, a=0.0 * arm.a)
    check_limits(replace(solution, agents=(human, still)))
    for field, size, said in (
        ("q", 0.5, r"torso_lift_joint is at 0\.5000 m at 0\.000 s, 0\.15 m beyond its limits 0 to 0\.35"),
        (
            "v",
            -0.2,
            r"torso_lift_joint slides at -0\.2000 m/s at 0\.000 s, 0\.13 m/s beyond its limits -0\.07 to 0\.07",
        ),
    ):
        values = getattr(still, field).copy()
        values[:, column] = size
        with pytest.raises(InputError, match=said):
            check_limits(replace(solution, agents=(human, replace(still, **{field: values}))))
    trajectory = joint_trajectory(solution)
    away = np.zeros(8)
    away[0] = 0.08
    assert check_start(trajectory, trajectory.position[0] + away, None) == pytest.approx(0.16)  # as an angle counts
    with pytest.raises(InputError, match=r"torso_lift_joint is 0\.160 m from .*; less than 0\.1 m is accepted"):
        check_start(trajectory, trajectory.position[0] + 2 * away, None)


def test_a_pandas_own_limits_are_said(arm_lift: Lifts) -> None:
    trajectory = joint_trajectory(arm_lift("panda"))
    quiet = list(
        remarks(replace(trajectory, acceleration=0.1 * trajectory.acceleration / np.abs(trajectory.acceleration).max()))
    )
    assert len(quiet) == 1 and quiet[0].startswith("the motion starts with a step of acceleration")
    strong = trajectory.acceleration.copy()
    strong[0, 1], strong[50, 3] = 5.0, -13.0
    said = " ".join(remarks(replace(trajectory, acceleration=strong)))
    assert "panda_joint4 accelerates at -13.0 rad/s^2 at 0.50 s; a Panda stops beyond 12.5" in said
    assert (
        "panda_joint2 is a jerk of 5000 rad/s^3 over one period of a Panda's controller, which stops beyond 3750"
        in said
    )


def test_the_robots_own_file_is_not_read(
    arm_folder: Folders, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(example_robot_data, "share_folder", lambda: None)
    monkeypatch.setattr("liftopt.multibody.robots.known_robot.share_folder", lambda: None)
    assert known_robots()["ur10"].path is None
    assert main(["export", str(arm_folder("ur10")), "--out", str(tmp_path / "out"), "--format", "csv"]) == DONE
    assert "Joints: shoulder_pan_joint, shoulder_lift_joint, elbow_joint" in capsys.readouterr().out


def test_names_signs_and_limits_of_a_map(arm_lift: Lifts) -> None:
    solution = arm_lift("tiago")
    joints, limits = JointMap.of(solution), solution["arm"].limits
    assert joints.held == (("torso_lift_joint", 0.2),) and not joints.is_sawyer and not joints.sliding.any()
    np.testing.assert_array_equal(joints.signs, 1.0)
    np.testing.assert_array_equal(joints.ends, [limits.q_lower, limits.q_upper])
    np.testing.assert_array_equal(joints.effort, [limits.tau_lower, limits.tau_upper])
