"""The simulated Sawyer under its action server. Oracles: Pinocchio, closed forms of the server's law, rosbags."""

from __future__ import annotations

import importlib.util
import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from liftopt.commands.cli import main
from liftopt.commands.exit_status import BAD_INPUT, DONE
from liftopt.lab.robot.action_server import ActionServer, MinimumJerk
from liftopt.lab.robot.command import PERIOD
from liftopt.lab.robot.dry_run import BEFORE, POSITION_NOISE, DryRun, dry_run
from liftopt.lab.robot.dry_run_plan import Plan
from liftopt.lab.robot.dry_run_summary import summarised
from liftopt.lab.robot.joint_trajectory import joint_trajectory
from liftopt.lab.robot.simulated_arm import STEP, SimulatedArm
from liftopt.multibody.robots.sawyer import JOINT_SIGNS
from liftopt.scenario.build import agents_of

CHEAP = ("solver.intervals=10", "solver.starts=1")
GOAL_TIME = 2.0
JOINTS = tuple(f"right_j{i}" for i in range(7))


@pytest.fixture(scope="module")
def result(solved: Callable[..., Any]) -> Any:
    pytest.importorskip("mujoco", minversion="3.7", reason="mujoco is in the extra 'lab'")
    return solved("table5_paper", *CHEAP)


@pytest.fixture(scope="module")
def runs(result: Any) -> dict[str, DryRun]:
    modes: Any = ("velocity", "position", "position_w_id")
    return {mode: dry_run(result.solution, mode, GOAL_TIME, trials=1) for mode in modes}


@pytest.fixture
def arm(result: Any) -> SimulatedArm:
    return SimulatedArm(result.solution, np.ones(7), stiff=True)


def _robot(solution: Any) -> Any:
    """Return Pinocchio's model of the robot without the virtual joints, and the frame of its grasp."""
    agent = agents_of(solution.scenario, solution.urdfs)[1]
    model = agent.reduced()
    return model, model.createData(), model.getFrameId(agent.hands[0])


def _torque(solution: Any, q: Any, v: Any, a: Any, force: Any) -> Any:
    model, data, frame = _robot(solution)
    slope = pin.computeFrameJacobian(model, data, q, frame, pin.LOCAL_WORLD_ALIGNED)[:3]
    return pin.rnea(model, data, q, v, a) - slope.T @ force


def test_the_arm_holds_still_with_the_torques_that_pinocchio_finds(result, arm):
    q, force = result.solution.agents[1].q[3, 3:], np.array([20.0, -3.0, -12.0])
    arm.rest(q, force)
    for _ in range(200):
        arm.advance(np.zeros(7), np.zeros(7), np.zeros(7), force)
    np.testing.assert_allclose(arm.position, q, rtol=0, atol=1e-9)
    np.testing.assert_allclose(arm.torque, _torque(result.solution, q, 0 * q, 0 * q, force), rtol=0, atol=1e-6)
    np.testing.assert_allclose(arm.gravity(q), _torque(result.solution, q, 0 * q, 0 * q, 0 * force), atol=1e-9)


def test_the_torque_it_reports_is_inverse_dynamics_of_how_it_moves(result, arm):
    force = np.array([-15.0, 4.0, -9.0])
    arm.rest(result.solution.agents[1].q[0, 3:], force)
    rate = np.array([0.3, -0.2, 0.4, -0.3, 0.5, 0.2, -0.6])
    for k in range(150):
        q, v = arm.position, arm.velocity
        arm.advance(rate * (k > 20), np.zeros(7), np.zeros(7), force)
        expected = _torque(result.solution, q, v, (arm.velocity - v) / STEP, force)
        np.testing.assert_allclose(arm.torque, expected, rtol=0, atol=1e-6)
    assert np.abs(arm.velocity - rate).max() < 0.1  # it does move


def test_the_servers_curve_is_minimum_jerk_from_rest_to_rest():
    curve = MinimumJerk.through(np.array([0.0, 2.0]), np.array([[1.0], [4.0]]))
    for s in (0.0, 0.1, 0.5, 0.9, 1.0):
        assert curve.at(2 * s)[0] == pytest.approx(1 + 3 * (10 * s**3 - 15 * s**4 + 6 * s**5))
    points = np.array([[0.0], [1.0], [3.0], [2.0]])
    curve = MinimumJerk.through(np.array([0.0, 1.0, 2.0, 4.0]), points)
    for time, value, slope in ((1.0, 1.0, 1.5), (2.0, 3.0, 0.0), (4.0, 2.0, 0.0)):
        assert curve.at(time)[0] == pytest.approx(value)
        assert (curve.at(time)[0] - curve.at(time - 1e-6)[0]) / 1e-6 == pytest.approx(slope, abs=1e-4)


def test_velocity_mode_lags_as_a_first_order_filter_of_gain_two(runs):
    # Closed form: an arm that did what it is told would follow dq/dt = 2 (planned - q).
    run = runs["velocity"]
    steps, fine = 20, PERIOD / 20
    planned = np.stack(
        [np.interp(np.arange(run.time[0], run.time[-1], fine), run.time, c) for c in run.planned_position.T]
    )
    ideal = np.empty_like(planned.T)
    ideal[0] = planned[:, 0]
    for k in range(1, len(ideal)):
        ideal[k] = ideal[k - 1] + fine * 2.0 * (planned[:, k] - ideal[k - 1])
    end = run.trajectory.time[-1] + GOAL_TIME
    rows = np.flatnonzero(run.time < end - PERIOD)
    off = np.abs(run.trials[0].position[rows] - ideal[rows * steps])
    lag = np.abs(run.planned_position[rows] - ideal[rows * steps])
    assert lag.max() > 0.3
    assert off.max() < 0.12 * lag.max()
    assert run.trials[0].outcome == "followed to the end"


def test_the_server_stops_where_it_is_when_the_goal_time_is_over(result, runs):
    short = dry_run(result.solution, "velocity", 0.0, trials=1)
    depth = result.solution.scenario.object.depth
    stopped, settled = summarised(short, depth), summarised(runs["velocity"], depth)
    # What is left decays as exp(-2 t) while the server goes on.
    assert settled.hand_final < 1.5 * np.exp(-2 * GOAL_TIME) * settled.hand_at_end
    assert stopped.hand_final > 0.5 * stopped.hand_at_end > 0.02


def test_position_mode_is_slower_than_the_plan_and_gives_up(result, runs):
    summary = summarised(runs["position"], result.solution.scenario.object.depth)
    assert summary.outcomes[0].startswith("gave up at 0.") and "rad off" in summary.outcomes[0]
    assert "right_j3" in summary.fast
    assert summary.delay is None


def test_position_with_inverse_dynamics_follows_closely(result, runs):
    summary = summarised(runs["position_w_id"], result.solution.scenario.object.depth)
    assert summary.outcomes == ("followed to the end",)
    assert max(joint.error_max for joint in summary.joints) < 0.1
    assert summary.hand_final < 5e-3 < summary.hand_max < 0.06
    assert 0.0 <= summary.delay < 0.05 < summarised(runs["velocity"], 0.45).delay
    for joint in summary.joints:
        assert joint.torque_max == pytest.approx(joint.planned_torque_max, rel=0.15, abs=0.5)


def test_before_the_goal_the_arm_carries_the_solutions_load_at_rest(runs):
    run = runs["velocity"]
    still = run.time < -PERIOD / 2
    assert still.sum() == round(BEFORE / PERIOD)
    np.testing.assert_allclose(run.trials[0].torque[still], run.planned_torque[still], rtol=0.06, atol=0.3)
    np.testing.assert_allclose(run.trials[0].position[still], run.planned_position[still], rtol=0, atol=1e-4)
    np.testing.assert_allclose(run.trials[0].tip[still], run.planned_tip[still], rtol=0, atol=1e-5)
    noise = run.trials[0].measured_position - run.trials[0].position
    assert noise.std() == pytest.approx(POSITION_NOISE, rel=0.1)


def test_at_rest_before_and_after_the_object_is_in_balance(result, solved):
    """Oracles: the sums of forces and of moments by hand, Pinocchio's gravity torques, the motion itself at rest."""
    solution = result.solution
    plan, lifted = Plan.of(solution), solution.object
    assert np.abs(lifted.acceleration[[0, -1], :3]).max() > 1.0  # or motion and rest were the same
    _, robot = agents_of(solution.scenario, solution.urdfs)
    moving, data, frame = solution.agents[1].moving, robot.model.createData(), robot.model.getFrameId("robot_grasp")
    for row, k in ((0, 0), (-1, -1)):
        on_object = -plan.force[row]
        others = np.array([0.0, 0.0, 2.0 * 9.81]) - on_object  # the person's, so that nothing accelerates
        arms = lifted.grasp_position[k] - lifted.pose[k, :3]
        np.testing.assert_allclose(np.cross(arms[0], others) + np.cross(arms[1], on_object), 0.0, atol=1e-6)
        q = solution.agents[1].q[k]
        pull = pin.computeFrameJacobian(robot.model, data, q, frame, pin.LOCAL_WORLD_ALIGNED)[:3].T @ plan.force[row]
        torque = pin.computeGeneralizedGravity(robot.model, data, q) - pull
        np.testing.assert_allclose(plan.torque[row], JOINT_SIGNS * torque[moving], atol=1e-6)
    gentle = Plan.of(solved("table5_paper", *CHEAP, "task.rest=acceleration").solution)
    for rows in (gentle.force, gentle.moment, gentle.torque):
        np.testing.assert_allclose(rows[[0, -1]], rows[[1, -2]], atol=1e-5)


def test_streamed_torques_alone_do_not_hold_the_motion(result):
    # The grasps push on each other by some 30 N through points: soft springs cannot keep that from running off.
    run = dry_run(result.solution, "torque", 0.5, trials=1)
    summary = summarised(run, result.solution.scenario.object.depth)
    assert summary.hand_max > 0.1
    assert summary.delay is None
    # It grows from nothing, by how much until the start depends on the posture.
    off = np.abs(run.trials[0].position - run.planned_position).max(axis=1)
    assert off[: round(BEFORE / PERIOD)].max() < 0.05 * off.max()


def test_torque_mode_streams_the_plan_on_the_plan(result):
    trajectory = joint_trajectory(result.solution)
    streamed = np.sin(trajectory.time)[:, None] * np.arange(1.0, 8.0)
    server = ActionServer("torque", trajectory, 0.0, streamed)
    k = 57
    command = server.command(trajectory.time[k], trajectory.position[k], trajectory.velocity[k], np.zeros(7))
    np.testing.assert_allclose(command.torque, streamed[k], atol=1e-9)
    np.testing.assert_array_equal(command.rate, 0.0)


def test_the_same_seed_gives_the_same_trial_and_trials_differ(result, runs):
    again = dry_run(result.solution, "position_w_id", GOAL_TIME, trials=2)
    np.testing.assert_array_equal(again.trials[0].measured_torque, runs["position_w_id"].trials[0].measured_torque)
    assert np.abs(again.trials[0].torque - again.trials[1].torque).max() > 0.05


def test_the_command_writes_bags_as_a_robot_records_them(result, tmp_path, capsys):
    pytest.importorskip("rosbags", reason="rosbags is in the extra 'lab'")
    import xarray
    from rosbags.highlevel import AnyReader

    out = tmp_path / "dry"
    command = ["dry-run", str(result.folder), "--mode", "position_w_id", "--trials", "1", "--goal-time", "0.2"]
    assert main([*command, "--out", str(out)]) == DONE
    text = capsys.readouterr().out
    assert "right_j3" in text and "The person's hand is led off by at most" in text
    files = ["dry_run.nc", "dry_run.svg", "summary.json", "trial_1.bag"]
    assert sorted(path.name for path in out.iterdir()) == files
    with AnyReader([out / "trial_1.bag"]) as reader:
        seen = [(c.topic, stamp, reader.deserialize(raw, c.msgtype)) for c, stamp, raw in reader.messages()]
    states = [(stamp, message) for topic, stamp, message in seen if topic == "/robot/joint_states"]
    stamps = np.array([stamp for stamp, _ in states])
    assert set(np.diff(stamps)) == {10_000_000}
    goal = next(stamp for topic, stamp, _ in seen if topic.endswith("/goal"))
    assert goal - stamps[0] == 500_000_000
    with xarray.open_dataset(out / "dry_run.nc", engine="h5netcdf") as data:
        assert data.attrs["mode"] == "position_w_id"
        assert data.position.dims == ("trial", "time", "joint") and data.position.units == "rad"
        assert len(states) == len(data.time)
        kinds = (("position", data.position, 2e-3), ("effort", data.torque, 2.5))
        for kind, truth, bound in kinds:
            rows = np.array([getattr(message, kind) for _, message in states])
            assert list(states[0][1].name) == ["head_pan", *JOINTS]
            assert np.abs(rows[:, 1:] - truth.values[0]).max() < bound
        assert len(states[0][1].velocity) == 8
    summary = json.loads((out / "summary.json").read_text())
    assert [joint["name"] for joint in summary["joints"]] == list(JOINTS)


def test_bad_options_and_a_missing_package_say_so(result, tmp_path, capsys, monkeypatch):
    command = ["dry-run", str(result.folder), "--out", str(tmp_path / "out")]
    for options, named in (
        (["--trials", "0"], "--trials = 0"),
        (["--seed", "-1"], "--seed"),
        (["--goal-time", "-1"], "--goal-time"),
    ):
        assert main([*command, *options]) == BAD_INPUT
        assert named in capsys.readouterr().err
    there = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None if name == "mujoco" else there(name))
    assert main(command) == BAD_INPUT
    assert 'pip install "liftopt[lab]"' in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_signs_of_the_arm_and_of_its_record_are_the_robots(runs):
    run = runs["position_w_id"]
    np.testing.assert_array_equal(JOINT_SIGNS, [1, 1, 1, -1, 1, 1, 1])
    moved = run.trials[0].position[-1] - run.trials[0].position[0]
    planned = run.trajectory.position[-1] - run.trajectory.position[0]
    np.testing.assert_allclose(moved, planned, rtol=0, atol=5e-3)


def test_a_whole_person_with_two_hands_is_dry_run_too(solved, tmp_path, capsys):
    """Of three hands the robot's is its own: its place, Pinocchio's torques at rest under what it bears."""
    result = solved("table5", "solver.intervals=10", "solver.starts=1", "human.body=whole")
    solution = result.solution
    plan, robot = Plan.of(solution), solution["robot"]
    assert [len(agent.grasps) for agent in solution.agents] == [2, 1]
    np.testing.assert_allclose(plan.tip[1], robot.p_world_hold[0], atol=1e-9)
    np.testing.assert_allclose(plan.force[1], -robot.load[0], atol=1e-9)
    _, model = agents_of(solution.scenario, solution.urdfs)
    data, frame = model.model.createData(), model.model.getFrameId("robot_grasp")
    for row, k in ((0, 0), (-1, -1)):
        pull = np.concatenate([plan.force[row], plan.moment[row]])
        jacobian = pin.computeFrameJacobian(model.model, data, robot.q[k], frame, pin.LOCAL_WORLD_ALIGNED)
        torque = pin.computeGeneralizedGravity(model.model, data, robot.q[k]) - jacobian.T @ pull
        np.testing.assert_allclose(plan.torque[row], JOINT_SIGNS * torque[robot.moving], atol=1e-6)
    command = ["dry-run", str(result.folder), "--trials", "1", "--goal-time", "0.2", "--out", str(tmp_path / "dry")]
    assert main(command) == 0
    printed = capsys.readouterr().out
    assert "followed to the end" in printed
    assert "The middle of the person's hands is led off" in printed
