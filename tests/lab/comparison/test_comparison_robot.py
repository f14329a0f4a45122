"""Bags of the robot: a predicted motion written as JointState messages is read back; broken bags are refused."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from liftopt.errors import InputError
from liftopt.lab.comparison.experiment import experiment
from liftopt.lab.robot.bags import Kind, Record, write_bag
from liftopt.lab.robot.joint_map import JointMap
from liftopt.lab.robot.robot_record import RobotRecord, read_robot_record
from liftopt.lab.robot.ros_messages import JOINT_STATE, SECOND, TRAJECTORY, RosMessages
from liftopt.scenario.build import agent_of
from liftopt.solution.interpolation import resample
from liftopt.solution.solution import Solution
from liftopt.types import Array

pytest.importorskip("rosbags", reason="rosbags is not installed (it is in the extra 'lab')")

CHEAP = ("solver.intervals=10", "solver.starts=1")
# The manufacturer's names; the head is among them, and the fourth joint turns the other way than in Table 3.
NAMES = ["head_pan", *(f"right_j{i}" for i in range(7))]
SIGNS = np.array([1.0, 1.0, 1.0, -1.0, 1.0, 1.0, 1.0])
SENT = 100.5  # s on the bag's clock
RATE = 100.0


@pytest.fixture(scope="module")
def solution(solved: Callable[..., Any]) -> Solution:
    return solved("table5_paper", *CHEAP).solution


def states(solution: Solution, late: float = 0.0, after: float = 1.0) -> tuple[Array, Array, Array]:
    """Return times since the goal was sent, angles and torques in Sawyer's signs; the motion is ``late`` [s]."""
    dense = resample(solution, 10)
    robot = dense.agents[1]
    time = np.arange(-50, round((float(dense.time[-1]) + after) * RATE) + 1) / RATE

    def over(values: Array) -> Array:
        columns = (SIGNS * values[:, robot.moving]).T
        return np.stack([np.interp(time - late, dense.time, column) for column in columns], axis=1)

    return time, over(robot.q), over(robot.tau)


def bag(path: Path, rows: tuple[Array, Array, Array], kind: Kind = "ros1", goal: bool = True, **change: Any) -> Path:
    """Write the rows as JointState messages, with a trajectory sent at time 0, and return the bag."""
    messages = RosMessages.of(ros1=kind == "ros1")
    names = change.get("names", NAMES)

    def records() -> Iterator[Record]:
        for time, q, tau in zip(*rows, strict=True):
            stamp = round((SENT + time) * SECOND)
            if goal and time == 0.0:
                sent = messages.store.types[TRAJECTORY](header=messages._header(0), joint_names=[], points=[])
                yield Record("/commanded", TRAJECTORY, stamp, sent)
            q, tau = np.append(0.0, q), np.append(0.0, tau) if change.get("effort", True) else np.empty(0)
            ahead = change.get("clock", 0.0)
            clock = 0 if ahead is None else stamp + round(ahead * SECOND)
            written = messages.joint_state(clock, names, q, 0.0 * q, tau)
            yield Record("/robot/joint_states", JOINT_STATE, stamp, written)
            gripper = messages.joint_state(stamp, ["gripper"], np.zeros(1), np.zeros(1), np.zeros(1))
            yield Record("/io/joint_states", JOINT_STATE, stamp, gripper)

    return write_bag(path, kind, messages, records())


@pytest.mark.parametrize("kind", ["ros1", "ros2", "mcap"])
def test_a_bag_is_read_back_in_the_signs_of_table_3(solution: Solution, tmp_path: Path, kind: Kind) -> None:
    record = read_robot_record(bag(tmp_path / "trial", states(solution), kind), JointMap.of(solution))
    dense = resample(solution, 10)
    robot = dense.agents[1]
    assert record.tau is not None
    assert record.told_by == "when the trajectory was sent"
    share = dense.time / dense.time[-1]
    q, tau = (record.over_share(values, share, record.sent[0], 2.0) for values in (record.q, record.tau))
    np.testing.assert_allclose(q, robot.q[:, robot.moving], atol=1e-9)
    np.testing.assert_allclose(tau, robot.tau[:, robot.moving], atol=1e-9)


@pytest.mark.parametrize("clock", [None, 37.5], ids=["no clock", "a clock of the robot's own"])
def test_stamps_are_brought_to_the_recorders_clock(solution: Solution, tmp_path: Path, clock: float | None) -> None:
    """Stamps of a publisher without a clock, or with one that is ahead of the recorder's, tell the same lift."""
    record = read_robot_record(bag(tmp_path / "trial", states(solution), clock=clock), JointMap.of(solution))
    assert record.sent == pytest.approx((0.5,), abs=1e-9)  # states() begins half a second before the goal
    np.testing.assert_allclose(np.diff(record.time), 1 / RATE, atol=1e-9)


def test_three_trials_averaged(solution: Solution, tmp_path: Path) -> None:
    """Trials that differ by -1, 0 and 1 Nm and are 0.1 s late, 5 % of the lift."""
    time, q, tau = states(solution, late=0.1)
    joints = JointMap.of(solution)
    trials = [read_robot_record(bag(tmp_path / f"trial_{i}", (time, q, tau + i)), joints) for i in (-1, 0, 1)]
    found = experiment(solution, robot=trials)
    assert [item.name for item in found.group("robot_torque")] == [f"Q{i}" for i in range(1, 8)]
    for item in found.group("robot_torque"):
        np.testing.assert_allclose(item.spread, 1.0, atol=1e-9)
    for item in (*found.group("robot_angle")[:4], *found.group("robot_torque")[:4]):
        assert item.measures.phase == pytest.approx(5.0, abs=0.5), item.label
        assert item.measures.correlation < 1.0


@pytest.mark.parametrize(
    ("sign", "beyond_gravity", "said"),
    [
        (1.0, False, None),
        (-1.0, False, "better with the other sign: 0.0"),
        (1.0, True, "better as torques beyond the arm's own weight: 0.0"),
        (-1.0, True, "better as torques beyond the arm's own weight, with the other sign: 0.0"),
    ],
)
def test_what_efforts_may_mean(solution: Solution, sign: float, beyond_gravity: bool, said: str | None) -> None:
    """Efforts made with another meaning, by Pinocchio's gravity torques, are told apart but not changed."""
    dense = resample(solution, 10)
    robot = dense.agents[1]
    model = agent_of(solution.scenario, "robot", solution.urdfs).model
    data = model.createData()
    weight = np.array([pin.computeGeneralizedGravity(model, data, q) for q in robot.q])
    tau = sign * (robot.tau - beyond_gravity * weight)[:, robot.moving]
    record = RobotRecord("made up", dense.time, robot.q[:, robot.moving], tau, (0.0,))
    found = experiment(solution, robot=[record])
    np.testing.assert_allclose(found.group("robot_torque")[1].trials[0], tau[:, 1], atol=1e-9)
    notes = [note for note in found.notes if "fit the prediction better" in note]
    assert [said in note for note in notes] == [True] if said else notes == []


def test_a_robot_that_ran_another_lift_is_said(solution: Solution) -> None:
    dense = resample(solution, 10)
    q = dense.agents[1].q[:, dense.agents[1].moving]
    for off, said in ((0.0, False), (10.0, True)):
        record = RobotRecord("made up", dense.time, q + np.radians(off), None, (0.0,))
        notes = experiment(solution, robot=[record]).notes
        assert ("made up: the robot starts 10 deg off the prediction: is it this lift?" in notes) == said


def test_a_bag_without_efforts_has_angles(solution: Solution, tmp_path: Path) -> None:
    record = read_robot_record(bag(tmp_path / "trial", states(solution), effort=False), JointMap.of(solution))
    found = experiment(solution, robot=[record])
    assert {item.group for item in found.comparisons} == {"robot_angle"}
    assert any("left out of the torques" in note for note in found.notes)


@pytest.mark.parametrize(
    ("change", "match"),
    [
        (
            {"names": [name.replace("j6", "j7") for name in NAMES]},
            "holds no sensor_msgs/msg/JointState with the joints",
        ),
        ({"names": [*NAMES, "extra"]}, "message 1 = '8 of position': names 9 joints"),
    ],
)
def test_messages_of_another_robot(solution: Solution, tmp_path: Path, change: dict[str, Any], match: str) -> None:
    with pytest.raises(InputError, match=match):
        read_robot_record(bag(tmp_path / "trial", states(solution), **change), JointMap.of(solution))


def test_damaged_and_missing_bags(solution: Solution, tmp_path: Path) -> None:
    time, q, tau = states(solution)
    broken = tau.copy()
    broken[7, 3] = np.nan
    with pytest.raises(InputError, match=r"topic /robot/joint_states, message 8 = 'effort of right_j3 nan'"):
        read_robot_record(bag(tmp_path / "nan", (time, q, broken)), JointMap.of(solution))
    with pytest.raises(InputError, match="no such bag"):
        read_robot_record(tmp_path / "none.bag", JointMap.of(solution))
    whole = bag(tmp_path / "whole", (time, q, tau))
    for name, content in (("cut.bag", whole.read_bytes()[:20_000]), ("text.bag", b"time,q\n1,2\n"), ("empty.bag", b"")):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(InputError, match=f"{name}: cannot be read as a bag"):
            read_robot_record(tmp_path / name, JointMap.of(solution))


def test_a_bag_that_ends_too_soon(solution: Solution, tmp_path: Path) -> None:
    record = read_robot_record(bag(tmp_path / "short", states(solution, after=-0.5)), JointMap.of(solution))
    with pytest.raises(InputError, match=r"= '1\.50 s': must last the lift's 2 s"):
        experiment(solution, robot=[record])


def test_a_bag_that_begins_too_late(solution: Solution) -> None:
    dense = resample(solution, 10)
    q = dense.agents[1].q[:, dense.agents[1].moving]
    record = RobotRecord("made up", dense.time, q, None, sent=(-0.3,))
    with pytest.raises(InputError, match=r"begins 0\.30 s after the lift does"):
        record.over_share(q, dense.time / 2.0, -0.3, 1.5)
