"""Where a recorded lift begins when its goal was not recorded. Oracle: when the motion was made to begin."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from liftopt.errors import InputError
from liftopt.lab.comparison.experiment import experiment
from liftopt.lab.comparison.motion_start import lift_start, motion_start
from liftopt.lab.robot.bags import Record, write_bag
from liftopt.lab.robot.joint_map import JointMap
from liftopt.lab.robot.robot_record import RobotRecord, read_robot_record
from liftopt.lab.robot.ros_messages import FEEDBACK, JOINT_STATE, LOG, SECOND, RosMessages
from liftopt.lab.robot.trajectory_files import TRAJECTORY_TOPIC
from liftopt.multibody.robots.sawyer import JOINT_SIGNS
from liftopt.solution.interpolation import resample
from liftopt.solution.solution import Solution
from liftopt.types import Array

Plan = tuple[Array, Array]
RATE, BEGUN = 100.0, 1_000.0  # Hz; s on the recorder's clock when the recording begins
ACTION = "/robot/limb/right/follow_joint_trajectory"
GOAL_TOPIC = f"{ACTION}/goal"
TOPICS = f"/robot/joint_states {GOAL_TOPIC}"
JOINTS = tuple(f"right_j{i}" for i in range(7))
FEEDBACK_DEFINITIONS = {
    "control_msgs/msg/FollowJointTrajectoryFeedback": (
        "Header header\nstring[] joint_names\ntrajectory_msgs/JointTrajectoryPoint desired\n"
        "trajectory_msgs/JointTrajectoryPoint actual\ntrajectory_msgs/JointTrajectoryPoint error\n"
    ),
    FEEDBACK: "Header header\nactionlib_msgs/GoalStatus status\nFollowJointTrajectoryFeedback feedback\n",
}


@pytest.fixture(scope="module", params=["velocity", "acceleration"])
def solution(request: pytest.FixtureRequest, solved: Callable[..., Any]) -> Solution:
    return solved("table5_paper", "solver.intervals=10", "solver.starts=1", f"task.rest={request.param}").solution


@pytest.fixture(scope="module")
def plan(solution: Solution) -> Plan:
    dense = resample(solution, 10)
    robot = dense.agents[1]
    return dense.time, robot.q[:, robot.moving]


@pytest.fixture(scope="module")
def joints(solution: Solution) -> JointMap:
    return JointMap.of(solution)


def trial(plan: Plan, begins: float, lasts: float = 10.0) -> RobotRecord:
    """Return a record of the planned motion that begins at a time: before and after it the arm holds still."""
    time = np.arange(round(lasts * RATE) + 1) / RATE
    return RobotRecord("made up", time, _at(plan, time - begins), None)


def _at(plan: Plan, time: Array) -> Array:
    return np.stack([np.interp(time, plan[0], column) for column in plan[1].T], axis=1)


@pytest.mark.parametrize("begins", [0.513, 0.5, 3.2071, 7.9])
def test_the_same_motion_tells_its_start(plan: Plan, begins: float) -> None:
    """Between two messages 10 ms apart the angle is linear to a quarter of a millisecond here."""
    assert motion_start(trial(plan, begins), *plan) == pytest.approx(begins, abs=2e-3)


def test_one_message_within_the_time_of_rest_is_no_rest() -> None:
    """Four messages a second of a cubic from rest to rest: at half a step at most the start is between two of them."""
    time, every = np.linspace(0.0, 2.0, 201), 0.25
    cubic = (time / 2.0) ** 2 * (3.0 - time)
    plan = (time, np.stack([0.8 * cubic, -0.4 * cubic], axis=1))
    messages = np.arange(0.0, 10.0, every)
    record = RobotRecord("made up", messages, _at(plan, messages - 3.07), None)
    assert motion_start(record, *plan) == pytest.approx(3.07, abs=every / 2)


def test_noise_and_an_arm_that_stands_a_little_beside_its_start(plan: Plan) -> None:
    record = trial(plan, 4.0)
    record.q[:] += np.random.default_rng(0).normal(0.0, 2e-4, record.q.shape) + 0.03
    assert motion_start(record, *plan) == pytest.approx(4.0, abs=5e-3)


def test_motions_before_and_after_are_no_lift(plan: Plan) -> None:
    """The arm goes to its start, waits, lifts, and goes back the same way, slower."""
    record = trial(plan, 5.0, lasts=14.0)
    record.q[:] += 0.3 * np.clip(2.0 - record.time, 0.0, 1.0)[:, None]
    after = record.time > 9.0
    record.q[after] = _at(plan, plan[0][-1] - (record.time[after] - 9.0) / 2.0)
    assert motion_start(record, *plan) == pytest.approx(5.0, abs=2e-3)


def test_an_arm_that_falls_behind_is_late_and_not_shifted(solution: Solution, plan: Plan) -> None:
    """First-order lag, 0.3 s in steady motion: 15 % of the lift, which the fit of the whole motion would take away."""
    record = trial(plan, 2.0)
    q, share = record.q.copy(), 1.0 - np.exp(-1.0 / RATE / 0.3)
    for k in range(1, len(q)):
        q[k] = q[k - 1] + share * (record.q[k - 1] - q[k - 1])
    record = RobotRecord("made up", record.time, q, None)
    assert motion_start(record, *plan) == pytest.approx(2.0, abs=0.12)
    phases = [one.measures.phase for one in experiment(solution, robot=[record]).group("robot_angle")]
    assert np.nanmedian(phases) > 6.0


def test_a_record_that_begins_with_the_motion_is_fitted(plan: Plan) -> None:
    record = trial(plan, 0.05)
    assert motion_start(record, *plan) == pytest.approx(0.05, abs=0.01)


def test_what_is_no_lift_is_refused(plan: Plan) -> None:
    still = RobotRecord("made up", np.arange(500) / RATE, np.zeros((500, 7)), None)
    with pytest.raises(InputError, match=r"the arm does not move by 0\.005 rad"):
        motion_start(still, *plan)
    with pytest.raises(InputError, match=r"= '1\.20 s': must last the lift's 2 s"):
        motion_start(trial(plan, 0.5, lasts=1.2), *plan)


def test_the_goal_counts_before_the_motion(plan: Plan) -> None:
    record = trial(plan, 3.1)
    told = RobotRecord("made up", record.time, record.q, None, sent=(3.0,), told_by="so", missed=3.05)
    assert lift_start(told, *plan, TOPICS) == (3.0, "so", "")
    start, _, known = lift_start(record, *plan, TOPICS)
    assert start == pytest.approx(3.1, abs=2e-3)
    assert "a delay of the whole motion does not show" in known and f"rosbag record {TOPICS}" in known


def test_of_several_goals_the_lifts_own_counts(plan: Plan) -> None:
    """One before to go to the start, one after to go back; the lift's was sent 0.2 s before the arm follows."""
    record = trial(plan, 4.2, lasts=12.0)
    told = RobotRecord("made up", record.time, record.q, None, sent=(1.0, 4.0, 7.5), told_by="so")
    assert lift_start(told, *plan, TOPICS)[0] == 4.0
    still = RobotRecord("made up", record.time, 0.0 * record.q, None, sent=(4.0, 4.001))
    assert lift_start(still, *plan, TOPICS)[0] == 4.001  # a trajectory and its goal, of which the arm did nothing


def test_the_page_on_robots_names_the_topics_to_record() -> None:
    """Its command must catch what a comparison looks for, in a bag that is begun before the exported one is played."""
    page = (Path(__file__).parents[3] / "docs" / "howto" / "robot.md").read_text(encoding="utf-8")
    assert f"rosbag record -O trial_1 /robot/joint_states {GOAL_TOPIC}\nrosbag play robot/trajectory.bag" in page


def bag(path: Path, plan: Plan, sent: float, late: float, **heard: Any) -> Path:
    """Write what ``rosbag record -a`` keeps of a follower that is late, without the goal; times since its begin [s]."""
    from rosbags.typesys import get_types_from_msg

    messages = RosMessages.of(ros1=True)
    types: dict[str, Any] = {}
    for name, text in FEEDBACK_DEFINITIONS.items():
        types |= get_types_from_msg(text, name)
    messages.store.register(types)
    make = messages._make

    def at(time: float) -> int:
        return round((BEGUN + time) * SECOND)

    def records() -> Iterator[Record]:
        for topic, when in heard.get("subscribed", {}).items():
            log = dict(level=2, name="/record", file="", function="", line=0, topics=[])
            line = make(LOG, header=messages._header(at(when)), msg=f"Subscribing to {topic}", **log)
            yield Record("/rosout", LOG, at(when + 0.001), line)
        joints = heard.get("joints", JOINTS)
        for when in heard.get("followed", ()):
            point = make(
                "trajectory_msgs/msg/JointTrajectoryPoint", positions=np.zeros(7), velocities=np.zeros(7),
                accelerations=np.zeros(7), effort=np.empty(0), time_from_start=messages._duration(round(when * SECOND)),
            )  # fmt: skip
            status = make(
                "actionlib_msgs/msg/GoalStatus", status=1, text="",
                goal_id=make("actionlib_msgs/msg/GoalID", stamp=messages._time(0), id="a"),
            )  # fmt: skip
            content = make(
                "control_msgs/msg/FollowJointTrajectoryFeedback", header=messages._header(0), joint_names=list(joints),
                desired=point, actual=point, error=point,
            )  # fmt: skip
            feedback = make(FEEDBACK, header=messages._header(0), status=status, feedback=content)
            yield Record(f"{ACTION}/feedback", FEEDBACK, at(sent + when + 0.0003), feedback)
        time = np.arange(round(8.0 * RATE) + 1) / RATE
        for when, q in zip(time, JOINT_SIGNS * _at(plan, time - sent - late), strict=True):
            state = messages.joint_state(at(when), JOINTS, q, 0.0 * q, 0.0 * q)
            yield Record("/robot/joint_states", JOINT_STATE, at(when), state)

    return write_bag(path, "ros1", messages, sorted(records(), key=lambda record: record.stamp))


@pytest.mark.parametrize(("late", "phase"), [(0.02, 1.0), (0.0, 0.0), (0.1, 5.0), (0.3, 15.0)])
def test_a_recorder_that_just_missed_the_goal_says_when_it_was_sent(
    solution: Solution, plan: Plan, joints: JointMap, tmp_path: Path, late: float, phase: float
) -> None:
    """The recorder subscribes as the goal is sent; the lift lasts 2 s, so 20 ms are 1 % of it, and 1.4 deg of Q4."""
    pytest.importorskip("rosbags", reason="rosbags is in the extra 'lab'")
    subscribed = {"/clock": 0.1, TRAJECTORY_TOPIC: 3.1, GOAL_TOPIC: 3.102}
    record = read_robot_record(bag(tmp_path / "trial", plan, 3.1, late, subscribed=subscribed), joints)
    assert record.sent == ()
    found = experiment(solution, robot=[record])
    assert any("at least as late as its phase says" in note for note in found.notes)
    shifted = np.degrees(_at(plan, 0.01 * np.arange(201.0) - late))
    planned = np.degrees(_at(plan, 0.01 * np.arange(201.0)))
    for j, one in enumerate(found.group("robot_angle")):
        assert one.measures.phase == pytest.approx(phase, abs=0.51), one.name
        rmse = float(np.sqrt(np.mean((shifted[:, j] - planned[:, j]) ** 2)))
        assert one.measures.rmse == pytest.approx(rmse, abs=0.02 * rmse + 0.05), one.name


@pytest.mark.parametrize("subscribed", [1.0, 3.4], ids=["long before the motion", "after it began"])
def test_a_subscription_that_explains_nothing_is_left_aside(
    plan: Plan, joints: JointMap, tmp_path: Path, subscribed: float
) -> None:
    """Had the recorder listened for two seconds, the goal were in the bag; after the motion began, it came too late."""
    pytest.importorskip("rosbags", reason="rosbags is in the extra 'lab'")
    record = read_robot_record(bag(tmp_path / "trial", plan, 3.1, 0.02, subscribed={GOAL_TOPIC: subscribed}), joints)
    start, how, _ = lift_start(record, *plan, TOPICS)
    assert start == pytest.approx(3.12, abs=2e-3) and "moves as the prediction" in how


def test_feedback_of_the_action_server_says_when_it_began(plan: Plan, joints: JointMap, tmp_path: Path) -> None:
    pytest.importorskip("rosbags", reason="rosbags is in the extra 'lab'")
    ticks = np.arange(200) / RATE
    record = read_robot_record(bag(tmp_path / "arm", plan, 3.1, 0.25, followed=ticks), joints)
    assert record.sent == pytest.approx((3.1,), abs=1e-3) and "feedback" in record.told_by
    gripper = read_robot_record(bag(tmp_path / "other", plan, 3.1, 0.25, followed=ticks, joints=("gripper",)), joints)
    assert gripper.sent == ()
