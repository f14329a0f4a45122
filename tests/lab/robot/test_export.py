"""The robot's motion as files for its action server. Oracles: the manufacturer's joint frames, rosbags' readers."""

from __future__ import annotations

import csv
import importlib.util
import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from liftopt.commands.cli import main
from liftopt.commands.exit_status import BAD_INPUT, DONE
from liftopt.errors import InputError
from liftopt.lab.robot import trajectory_files
from liftopt.lab.robot.joint_trajectory import JointTrajectory, joint_trajectory
from liftopt.lab.robot.robot_limits import check_limits, check_motion
from liftopt.lab.robot.robot_start import read_pose
from liftopt.multibody.dh import rotation_z, translation
from liftopt.multibody.robots.sawyer import sawyer_limits
from liftopt.multibody.robots.sawyer_description import FLANGE_IN_LAST_LINK, described_frames

CHEAP = ("solver.intervals=10", "solver.starts=1")
GOAL_TIME = 1.25
JOINTS = tuple(f"right_j{i}" for i in range(7))


@pytest.fixture(scope="module")
def result(solved: Callable[..., Any]) -> Any:
    return solved("table5_paper", *CHEAP)


@pytest.fixture(scope="module")
def trajectory(result: Any) -> JointTrajectory:
    return joint_trajectory(result.solution)


@pytest.fixture(scope="module")
def folder(result: Any, tmp_path_factory: pytest.TempPathFactory) -> Path:
    pytest.importorskip("rosbags", reason="rosbags is in the extra 'lab'")
    out = tmp_path_factory.mktemp("export") / "out"
    assert main(["export", str(result.folder), "--out", str(out), "--goal-time", str(GOAL_TIME)]) == DONE
    return out


def test_the_manufacturers_frames_put_the_gripper_where_the_solution_has_it(result, trajectory):
    solution, robot = result.solution, result.solution.scenario.first("robot")
    world = translation(solution.scenario.task.standing_distance, 0.0, robot.base_height) @ rotation_z(np.pi)
    tip = np.array([*FLANGE_IN_LAST_LINK[:2], FLANGE_IN_LAST_LINK[2] + robot.tool.length, 1.0])
    knots = np.searchsorted(trajectory.time, solution.time - 1e-9)
    for knot, row in enumerate(knots):
        placed = world @ described_frames(trajectory.position[row])[-1] @ tip
        # The description has 3.1416 for pi in the last joint, which is 1.1e-6 m at the end of the tool.
        np.testing.assert_allclose(placed[:3], solution.agents[1].p_world_hold[knot], rtol=0, atol=1.5e-6)


def test_velocity_and_acceleration_are_the_derivatives_by_finite_difference(result, trajectory):
    step = trajectory.time[1]
    slope = (trajectory.position[2:] - trajectory.position[:-2]) / (2 * step)
    # The third derivative jumps at knots: where it does not, the error is h^2/6 of it.
    jerk = np.abs(np.diff(trajectory.acceleration, axis=0)).max() / step
    assert np.abs(slope - trajectory.velocity[1:-1]).max() < jerk * step**2 / 6 * 1.01
    inside = np.abs(trajectory.time[1:-1, None] - result.solution.time).min(axis=1) > step / 2
    bend = (trajectory.velocity[2:] - trajectory.velocity[:-2]) / (2 * step)
    np.testing.assert_allclose(bend[inside], trajectory.acceleration[1:-1][inside], rtol=0, atol=1e-9)


def test_points_come_at_the_rate_and_at_the_end(result, trajectory):
    np.testing.assert_allclose(trajectory.time, np.arange(201) / 100, atol=1e-12)
    odd = joint_trajectory(result.solution, rate=33.0)
    assert odd.time[-1] == 2.0
    np.testing.assert_allclose(odd.time[:-1], np.arange(66) / 33, atol=1e-12)
    with pytest.raises(InputError, match=r"--rate = 5\.0"):
        joint_trajectory(result.solution, rate=5.0)


def _points(trajectory: Any) -> np.ndarray:
    rows = [np.concatenate([p.positions, p.velocities, p.accelerations]) for p in trajectory.points]
    time = [p.time_from_start.sec + 1e-9 * p.time_from_start.nanosec for p in trajectory.points]
    return np.column_stack([time, rows])


def _expected(trajectory: JointTrajectory) -> np.ndarray:
    return np.column_stack([trajectory.time, trajectory.position, trajectory.velocity, trajectory.acceleration])


@pytest.mark.parametrize("name", ["trajectory.bag", "trajectory_ros2", "trajectory_mcap"])
def test_bags_read_back_by_rosbags_hold_the_same_numbers(folder, trajectory, name):
    from rosbags.highlevel import AnyReader

    with AnyReader([folder / name]) as reader:
        found = {c.topic: reader.deserialize(raw, c.msgtype) for c, _, raw in reader.messages()}
        kinds = {c.topic: (c.msgtype, c.digest) for c in reader.connections}
    goal = found["/robot/limb/right/follow_joint_trajectory/goal"]
    if name == "trajectory.bag":
        # Checksums of the public packages: what the robot's server compares before it listens.
        assert kinds["/robot/limb/right/follow_joint_trajectory/goal"] == (
            "control_msgs/msg/FollowJointTrajectoryActionGoal",
            "cff5c1d533bf2f82dd0138d57f4304bb",
        )
        assert kinds["/liftopt/joint_trajectory"][1] == "65b4f94a94d1ed67169da35a02f33d3f"
        goal = goal.goal
    for sent in (found["/liftopt/joint_trajectory"], goal.trajectory):
        assert tuple(sent.joint_names) == JOINTS
        np.testing.assert_allclose(_points(sent)[:, 0], trajectory.time, rtol=0, atol=1e-9)
        np.testing.assert_array_equal(_points(sent)[:, 1:], _expected(trajectory)[:, 1:])
    assert goal.goal_time_tolerance.sec + 1e-9 * goal.goal_time_tolerance.nanosec == GOAL_TIME


@pytest.mark.parametrize("name", ["trajectory_ros2", "trajectory_mcap"])
def test_metadata_is_what_humble_iron_and_jazzy_decode(folder, name):
    """Oracle: rosbag2_storage's decoding, which throws where a text or a number is anything else.

    Humble and Iron take the offered QoS for a text whatever the version says; Jazzy does up to version 8.
    """
    from rosbags.rosbag2 import Reader
    from ruamel.yaml import YAML

    bag = YAML(typ="safe").load((folder / name / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    assert bag["version"] == 8
    texts = [bag[key] for key in ("storage_identifier", "compression_format", "compression_mode", "ros_distro")]
    counts = [bag["message_count"], bag["duration"]["nanoseconds"], bag["starting_time"]["nanoseconds_since_epoch"]]
    texts += bag["relative_file_paths"]
    for topic in bag["topics_with_message_count"]:
        data = topic["topic_metadata"]
        keys = ("name", "type", "serialization_format", "offered_qos_profiles", "type_description_hash")
        texts += [data[key] for key in keys]
        counts.append(topic["message_count"])
    for file in bag["files"]:
        texts.append(file["path"])
        counts += [file["message_count"], *file["duration"].values(), *file["starting_time"].values()]
    assert all(isinstance(text, str) for text in texts)
    assert all(isinstance(count, int) and count >= 0 for count in counts)
    assert isinstance(bag["custom_data"] or {}, dict)
    with Reader(folder / name) as reader:  # what the storage itself keeps of it
        assert [connection.ext.offered_qos_profiles for connection in reader.connections] == [[], []]
        assert reader.message_count == bag["message_count"] == 2


def test_csv_and_json_read_back_hold_the_same_numbers(folder, trajectory):
    with (folder / "trajectory.csv").open(newline="") as file:
        header, *rows = csv.reader(file)
    assert header[:8] == ["time", *JOINTS]  # what the manufacturer's file playback looks for
    np.testing.assert_array_equal(np.array(rows, float), _expected(trajectory))
    goal = json.loads((folder / "trajectory.json").read_text())
    points = goal["trajectory"]["points"]
    assert tuple(goal["trajectory"]["joint_names"]) == JOINTS
    for key, values in (
        ("positions", trajectory.position),
        ("velocities", trajectory.velocity),
        ("accelerations", trajectory.acceleration),
    ):
        np.testing.assert_array_equal([p[key] for p in points], values)
    assert points[-1]["time_from_start"] == {"secs": 2, "nsecs": 0}
    assert goal["goal_time_tolerance"] == {"secs": 1, "nsecs": 250_000_000}


def test_a_limit_that_is_passed_names_joint_time_and_amount(result):
    solution = result.solution
    check_limits(solution)
    human, robot = solution.agents
    # The same path in four fifths of the time: 1.25 times the speed.
    quick = replace(robot, v=robot.v / 0.8, a=robot.a / 0.64)
    with pytest.raises(InputError) as caught:
        check_limits(replace(solution, time=0.8 * solution.time, agents=(human, quick)))
    fine = joint_trajectory(solution, 1000.0)
    over = 1.25 * np.abs(fine.velocity) - sawyer_limits().velocity
    k, j = np.unravel_index(over.argmax(), over.shape)
    found = re.search(r"(right_j\d) turns at (\S+) rad/s at (\S+) s, (\S+) rad/s beyond", str(caught.value))
    assert found is not None and found[1] == JOINTS[j]
    speed, time, excess = map(float, found.groups()[1:])
    assert speed == pytest.approx(1.25 * fine.velocity[k, j], abs=1e-3)
    assert time == pytest.approx(0.8 * fine.time[k], abs=0.01)
    assert excess == pytest.approx(over[k, j], rel=0.05)
    q, v, a = robot.q.copy(), robot.v.copy(), robot.a.copy()
    q[:, 6], v[:, 6], a[:, 6] = -3.2, 0.0, 0.0  # Q4, which is -right_j3
    with pytest.raises(InputError, match=r"right_j3 is at 3\.2000 rad at 0\.000 s, 0\.16 rad beyond"):
        check_limits(replace(solution, agents=(human, replace(robot, q=q, v=v, a=a))))
    pushed = replace(robot, grasp_force=robot.grasp_force + np.array([0.0, 0.0, 60.0]))
    with pytest.raises(InputError, match=r"right_j\d needs -?\d+\.\d+ Nm at \d\.\d+ s"):
        check_limits(replace(solution, agents=(human, pushed)))


def test_an_end_that_moves_is_refused(trajectory):
    check_motion(trajectory)
    velocity = trajectory.velocity.copy()
    velocity[-1, 2] = 0.01
    with pytest.raises(InputError, match=r"right_j2 turns at 0\.01 rad/s at its end, 2\.000 s"):
        check_motion(replace(trajectory, velocity=velocity))


def test_a_pose_is_read_as_tools_print_it(trajectory):
    expected = [-0.1, 2e-5, 0.3, 0.4, 0.5, 0.6, -7.0]
    for text in ("[-0.1, 2e-5, 0.3, 0.4, 0.5, 0.6, -7.0]", "-0.1 2e-5 .3 .4 .5 .6 -7", "-0.1,2e-5,.3,.4,.5,.6,-7"):
        np.testing.assert_array_equal(read_pose(text, trajectory.joints), expected)
    for text in ("", "1 2 3", "a b c d e f g", "1 2 3 4 5 6 nan"):
        with pytest.raises(InputError, match="seven angles"):
            read_pose(text, trajectory.joints)


def test_violations_exit_2_with_one_line_and_leave_nothing(result, tmp_path, capsys):
    command = ["export", str(result.folder), "--out", str(tmp_path / "out"), "--format", "csv"]
    assert main([*command, "--current-pose", "0 0 0 0 0 0 0"]) == BAD_INPUT
    error = capsys.readouterr().err
    assert error.startswith("liftopt: error: --current-pose") and error.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "out").mkdir()
    assert main(command) == BAD_INPUT
    assert "exists already" in capsys.readouterr().err


def test_a_failure_halfway_leaves_nothing(result, tmp_path, capsys, monkeypatch):
    def full(*_: Any) -> str:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(trajectory_files, "json_text", full)
    command = ["export", str(result.folder), "--out", str(tmp_path / "out"), "--format", "csv", "--format", "json"]
    assert main(command) == BAD_INPUT
    assert "No space left" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_only_an_unsolved_lift_or_a_missing_package_stop_it(result, tmp_path, capsys, monkeypatch):
    with pytest.raises(InputError, match="solved and verified"):
        joint_trajectory(replace(result.solution, outcome="iteration limit"))
    there = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None if name == "rosbags" else there(name))
    assert main(["export", str(result.folder), "--out", str(tmp_path / "a"), "--format", "ros2"]) == BAD_INPUT
    assert 'pip install "liftopt[lab]"' in capsys.readouterr().err
    assert main(["export", str(result.folder), "--out", str(tmp_path / "b"), "--format", "csv"]) == DONE
    assert [path.name for path in (tmp_path / "b").iterdir()] == ["trajectory.csv"]
