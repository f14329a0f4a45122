"""Any robot's arm simulated. Oracles: Pinocchio, the closed form of a critically damped joint, rosbags' reader."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from scipy.linalg import expm

from liftopt.commands.cli import main
from liftopt.commands.exit_status import BAD_INPUT, DONE
from liftopt.errors import InputError
from liftopt.lab.comparison.experiment import experiment
from liftopt.lab.comparison.plots import drawn_comparisons
from liftopt.lab.robot.dry_run import BEFORE, DryRun, dry_run
from liftopt.lab.robot.dry_run_summary import summarised, summary_text
from liftopt.lab.robot.joint_map import JointMap
from liftopt.lab.robot.robot_record import read_robot_record
from liftopt.lab.robot.servo import RESET
from liftopt.lab.robot.simulated_arm import STEP, SimulatedArm
from liftopt.scenario.build import agent_of
from liftopt.solution.solution import Solution

ROBOTS = ("ur10", "panda", "tiago_lifting")
FORCE, MOMENT = np.array([3.0, -1.0, -6.0]), np.array([0.5, 1.0, -0.3])
Lifts = Callable[[str], Solution]

pytest.importorskip("mujoco", minversion="3.7", reason="mujoco is in the extra 'lab'")


@pytest.fixture(scope="module")
def run(arm_lift: Lifts) -> DryRun:
    return dry_run(arm_lift("ur10"), "position", 0.5, trials=2)


def _model(solution: Solution) -> Any:
    agent = agent_of(solution.scenario, "arm", solution.urdfs)
    model = agent.reduced()
    return model, model.createData(), model.getFrameId(agent.hands[0])


@pytest.mark.parametrize("name", ROBOTS)
def test_an_arm_holds_still_with_the_torques_and_the_gains_that_pinocchio_finds(arm_lift: Lifts, name: str) -> None:
    solution = arm_lift(name)
    model, data, frame = _model(solution)
    q = solution["arm"].q[0, solution["arm"].moving]
    arm = SimulatedArm(solution, np.ones(len(q)), stiff=True)
    mass, most = np.diag(pin.crba(model, data, q)), solution["arm"].limits.tau_upper
    slack = np.where(JointMap.of(solution).sliding, 0.1, 0.2)
    swings = (10.0 * np.pi) ** 2 * mass > most / slack
    assert swings.any() or name == "tiago_lifting"
    np.testing.assert_allclose(arm.servo.stiffness[~swings], (most / slack)[~swings])
    np.testing.assert_allclose(arm.servo.stiffness[swings], ((10.0 * np.pi) ** 2 * mass)[swings], rtol=1e-5)
    critical = 2.0 * np.sqrt(arm.servo.stiffness * mass)
    np.testing.assert_allclose(arm.servo.damping[swings], critical[swings], rtol=1e-5)
    assert (arm.servo.damping >= critical * (1.0 - 1e-5)).all()
    np.testing.assert_allclose(arm.servo.friction, 0.03 * most)
    arm.rest(q, FORCE, MOMENT)
    none = np.zeros(len(q))
    for _ in range(100):
        arm.advance(none, none, none, FORCE, MOMENT)
    slope = pin.computeFrameJacobian(model, data, q, frame, pin.LOCAL_WORLD_ALIGNED)
    held = pin.computeGeneralizedGravity(model, data, q) - slope.T @ np.concatenate([FORCE, MOMENT])
    np.testing.assert_allclose(arm.position, q, rtol=0, atol=1e-7)
    np.testing.assert_allclose(arm.torque, held, rtol=0, atol=1e-4)


@pytest.mark.parametrize("joint", [0, 2, 5])
def test_a_joint_follows_a_ramp_as_its_servo_says(arm_lift: Lifts, joint: int) -> None:
    """Without friction, with Pinocchio's M: M e'' + D e' + P e + P I int(e) = 0 from e = 0 and e' = the rate.

    Step by step, implicit in the damping as MuJoCo is; and in closed form, from which steps of 1 ms differ by terms of
    the order 2 w STEP = 6 %. The last joint, far stiffer than it is heavy, is too fast for that.
    """
    solution = arm_lift("ur10")
    model, data, _ = _model(solution)
    q = solution["arm"].q[0, solution["arm"].moving]
    arm, rate = SimulatedArm(solution, np.zeros(6), stiff=True), 0.03 * np.eye(6)[joint]
    arm.rest(q, 0.0 * FORCE)
    mass = pin.crba(model, data, q)
    mass = np.triu(mass) + np.triu(mass, 1).T
    P, D, none, one = np.diag(arm.servo.stiffness), np.diag(arm.servo.damping), np.zeros((6, 6)), np.eye(6)
    slope = np.block([[none, one, none], [none, none, one], [-np.linalg.solve(mass, x) for x in (RESET * P, P, D)]])
    closed, onward = np.concatenate([0.0 * rate, 0.0 * rate, rate]), expm(STEP * slope)
    position, velocity, reference, held = 0.0 * rate, 0.0 * rate, 0.0 * rate, 0.0 * rate
    rows = []
    for _ in range(300):
        arm.advance(rate, 0.0 * rate, 0.0 * rate, 0.0 * FORCE)
        reference = reference + STEP * rate
        held = held + STEP * RESET * P @ (reference - position)
        push = P @ (reference - position) + D @ (rate - velocity) + held
        velocity = velocity + STEP * np.linalg.solve(mass + STEP * D, push)
        position = position + STEP * velocity
        closed = onward @ closed
        rows.append([arm.reference - arm.position, reference - position, closed[6:12]])
    found, stepped, exact = np.moveaxis(np.array(rows), 1, 0)
    most = np.abs(exact).max()
    np.testing.assert_allclose(found, stepped, rtol=0, atol=0.01 * np.abs(stepped).max())
    if joint < 3:
        np.testing.assert_allclose(found, exact, rtol=0, atol=0.12 * most)


def test_the_arm_follows_late_and_within_its_limits(arm_lift: Lifts, run: DryRun) -> None:
    solution = arm_lift("ur10")
    summary = summarised(run, 0.45)
    joints = JointMap.of(solution)
    assert summary.outcomes == ("followed to the end",) * 2 and summary.fast == ()
    assert summary.delay is not None and 0.0 <= summary.delay < 0.1
    assert [joint.name for joint in summary.joints] == list(joints.names)
    for joint, limit in zip(summary.joints, solution["arm"].limits.tau_upper, strict=True):
        assert joint.limit == limit and joint.torque_max == pytest.approx(joint.planned_torque_max, rel=0.15, abs=1.0)
    share = [joint.torque_max / joint.limit for joint in summary.joints]
    assert summary.margins is not None
    assert summary.margins.torque == pytest.approx(max(share)) and summary.margins.at_limit == 0.0
    assert summary.margins.torque_joint == joints.names[int(np.argmax(share))]
    planned = np.abs(run.trajectory.velocity) / solution["arm"].limits.velocity
    assert summary.margins.speed == pytest.approx(planned.max(), rel=0.15)
    still = run.time < -1e-9
    assert still.sum() == round(BEFORE / 0.01)
    np.testing.assert_allclose(run.trials[0].position[still], run.planned_position[still], rtol=0, atol=1e-3)
    assert summary.as_dict()["margins"]["speed_joint"] == summary.margins.speed_joint


def test_a_torque_limit_holds_the_arm_back_and_is_said(arm_lift: Lifts) -> None:
    """With a tenth less than the plan needs, the shoulder sags."""
    solution = arm_lift("ur10")
    human, arm = solution.agents
    most = 0.9 * np.abs(arm.tau[:, arm.moving]).max(axis=0)
    weak = replace(arm.limits, tau_lower=np.where(np.arange(6) == 1, -most, arm.limits.tau_lower),
                   tau_upper=np.where(np.arange(6) == 1, most, arm.limits.tau_upper))  # fmt: skip
    run = dry_run(replace(solution, agents=(human, replace(arm, limits=weak))), "position", 0.0, trials=1)
    summary = summarised(run, 0.45)
    assert summary.margins is not None and summary.margins.at_limit > 0.1
    assert summary.margins.torque_joint == "shoulder_lift_joint"
    assert summary.joints[1].error_max > 0.05
    assert "s at it) and" in summary_text(summary)


def test_modes_are_sawyers(arm_lift: Lifts, arm_folder: Callable[[str], Path], tmp_path: Path, capsys: Any) -> None:
    with pytest.raises(InputError, match="--mode = 'velocity': must be \"position\""):
        dry_run(arm_lift("ur10"), "velocity", 0.0)
    command = ["dry-run", str(arm_folder("ur10")), "--mode", "torque", "--out", str(tmp_path / "out")]
    assert main(command) == BAD_INPUT
    assert capsys.readouterr().err.count("\n") == 1


def test_a_lifting_column_is_dry_run_recorded_and_compared(
    arm_lift: Lifts, arm_folder: Callable[[str], Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("rosbags", reason="rosbags is in the extra 'lab'")
    import xarray

    out = tmp_path / "dry"
    command = ["dry-run", str(arm_folder("tiago_lifting")), "--trials", "1", "--goal-time", "0.2", "--out", str(out)]
    assert main(command) == DONE
    text = capsys.readouterr().out
    column = next(line for line in text.splitlines() if line.startswith("torso_lift_joint"))
    assert " mm " in column and column.endswith(" N") and "when the controller is done" in text
    assert "Of its limits it uses" in text
    with xarray.open_dataset(out / "dry_run.nc", engine="h5netcdf") as data:
        assert data.position.units == "rad or m" and data.sizes["joint"] == 8
        truth = data.position.values[0]
    solution = arm_lift("tiago_lifting")
    record = read_robot_record(out / "trial_1.bag", JointMap.of(solution))
    np.testing.assert_allclose(record.q, truth, rtol=0, atol=2e-3)
    assert record.sent[-1] == pytest.approx(BEFORE) and record.told_by == "when the trajectory was sent"
    found = experiment(solution, robot=[record])
    units = [
        (one.unit, two.unit) for one, two in zip(found.group("robot_angle"), found.group("robot_torque"), strict=True)
    ]
    assert units == [("mm", "N"), *[("deg", "Nm")] * 7]
    assert np.ptp(found.group("robot_angle")[0].predicted) < 350.0
    assert {plot.name for plot, _ in drawn_comparisons(found)} == {"compared_robot_angles", "compared_robot_torques"}
    for one in found.group("robot_angle"):
        assert one.measures.correlation > 0.9 or np.ptp(one.predicted) < 1.0, one.name
    assert json.loads((out / "summary.json").read_text())["mode"] == "position"
