"""The exported motion on a simulated robot: what it would do, and recordings as three trials would give them.

The arm lifts alone. The person and the object are the force and the moment that the solution has at the gripper.
Simulating the person as well would take a controller of the person, which nobody knows and which would decide the
result. The person is taken to follow the arm: force and moment are those of the plan where the arm has got to, not
when, since a force of 40 N meant for another posture would be a disturbance of the simulation's own making; and the
hand is led off its path by what the gripper is off.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftopt.errors import InputError, ModelError
from liftopt.lab.meant import the_robot
from liftopt.lab.robot.action_server import ActionServer, Mode
from liftopt.lab.robot.command import PERIOD, Command
from liftopt.lab.robot.dry_run_plan import Plan
from liftopt.lab.robot.joint_trajectory import JointTrajectory, joint_trajectory
from liftopt.lab.robot.simulated_arm import STEP, SimulatedArm
from liftopt.lab.robot.trajectory_controller import TrajectoryController
from liftopt.solution.solution import Solution
from liftopt.types import Array, Progress

BEFORE, AFTER = 0.5, 0.5  # recorded before the goal is sent and after the server is done [s]
TICKS = round(PERIOD / STEP)
RUNAWAY = 50.0  # [rad/s]: ten times what a joint can do; MuJoCo itself would start again at its own zero
FASTEST = 2.0  # seconds of the plan in a second: an arm that is late cuts corners, the person's force does not jump
# Estimates: no figures are published for Sawyer, or known here of others. Half the width of what differs between
# trials, and the noise (one standard deviation) of what the arm reports.
FRICTION_SPREAD = 0.2  # of each joint's friction
LOAD_SPREAD = 0.05  # of the person's part
POSITION_NOISE, VELOCITY_NOISE = 2e-4, 5e-3  # [rad], [rad/s]
TORQUE_NOISE = 0.005  # of each joint's limit
# In torque mode a loop around the joint's spring takes most of the friction before it out; estimate of what is left.
FRICTION_LEFT = 0.2


@dataclass(frozen=True)
class Trial:
    """One run, in the robot's joint names, signs and order, at the K times of its ``DryRun``.

    Attributes:
        position: (K, n) where the joints were [rad].
        torque: (K, n) that they passed on [Nm].
        tip: (K, 3) where the gripper's grasp point was in the world [m].
        measured_position, measured_velocity, measured_torque: (K, n) what the arm reported: noise added.
        outcome: how the server ended, in words.
        gave_up: whether it did before the end.
    """

    position: Array
    torque: Array
    tip: Array
    measured_position: Array
    measured_velocity: Array
    measured_torque: Array
    outcome: str
    gave_up: bool


@dataclass(frozen=True)
class DryRun:
    """What the arm made of a trajectory.

    Attributes:
        mode: of Sawyer's action server; ``"position"`` of any other robot.
        trajectory: that was sent.
        goal_time: of the goal [s].
        time: (K,) every 10 ms, 0 where the goal was sent [s].
        planned_position: (K, n) the plan at those times, at rest before and after it [rad].
        planned_torque: (K, n) [Nm].
        planned_tip: (K, 3) [m].
        trials: of which friction, load, phase of the clocks and noise differ.
    """

    mode: Mode
    trajectory: JointTrajectory
    goal_time: float
    time: Array
    planned_position: Array
    planned_torque: Array
    planned_tip: Array
    trials: tuple[Trial, ...]


def dry_run(
    solution: Solution,
    mode: Mode,
    goal_time: float,
    trials: int = 3,
    seed: int = 0,
    progress: Progress | None = None,
    robot: str | None = None,
) -> DryRun:
    """Simulate the controller and the arm; the same arguments give the same numbers.

    Args:
        solution: a solved lift.
        mode: of Sawyer's action server; any other robot has ``"position"``.
        goal_time: how long after the motion's end the controller goes on [s].
        trials: how many.
        seed: of what differs between them.
        progress: called with one line for each trial.
        robot: its name; None where there is only one.

    Raises:
        InputError: the solution is not solved, MuJoCo is not installed, the robot has not that mode, or no robot is the
            one that is meant.
        ModelError: the arm runs away.
    """
    arm = the_robot(solution, robot)
    trajectory, plan = joint_trajectory(solution, robot=arm.name), Plan.of(solution, arm.name)
    if not trajectory.joints.is_sawyer and mode != "position":
        raise InputError("--mode", mode, 'must be "position": the others are of Sawyer\'s action server')
    duration = float(trajectory.time[-1])
    first, last = -round(BEFORE / PERIOD), round((duration + goal_time + AFTER) / PERIOD)
    time = PERIOD * np.arange(first, last + 1, dtype=float)
    runs = []
    for trial in range(trials):
        if progress is not None:
            progress(f"trial {trial + 1} of {trials} in {mode} mode")
        rng = np.random.default_rng([seed, trial])
        runs.append(_trial(solution, arm.name, trajectory, plan, mode, goal_time, time, rng))
    return DryRun(
        mode, trajectory, goal_time, time, plan.at(plan.position, time), plan.at(plan.torque, time),
        plan.at(plan.tip, time), tuple(runs),
    )  # fmt: skip


def _trial(
    solution: Solution,
    robot: str,
    trajectory: JointTrajectory,
    plan: Plan,
    mode: Mode,
    goal_time: float,
    time: Array,
    rng: np.random.Generator,
) -> Trial:
    stiff = mode != "torque"
    joints, n = trajectory.joints, len(trajectory.names)
    friction = rng.uniform(1 - FRICTION_SPREAD, 1 + FRICTION_SPREAD, n) * (1.0 if stiff else FRICTION_LEFT)
    load = rng.uniform(1 - LOAD_SPREAD, 1 + LOAD_SPREAD)
    phase = int(rng.integers(TICKS))  # of the server's clock to the recorder's [steps]
    arm = SimulatedArm(solution, friction, stiff, robot)
    streamed, holding = (None, np.zeros(n)) if stiff else _above_gravity(arm, trajectory, plan)
    server = (
        ActionServer(mode, trajectory, goal_time, streamed) if joints.is_sawyer else TrajectoryController(trajectory)
    )
    arm.rest(joints.signs * trajectory.position[0], load * plan.force[0], load * plan.moment[0])
    noise = rng.standard_normal((len(time), 3, n))
    noise *= np.array([POSITION_NOISE, VELOCITY_NOISE, 1.0])[:, None]
    noise[:, 2] *= TORQUE_NOISE * solution[robot].limits.tau_upper
    reached, played, fastest = 0, 0, round(FASTEST * PERIOD / plan.step)
    command = Command(np.zeros(n), np.zeros(n), holding)  # before the goal: hold still
    states, tips = np.zeros((len(time), 3, n)), np.zeros((len(time), 3))
    for k in range(len(time)):
        states[k] = joints.signs * np.stack([arm.position, arm.velocity, arm.torque])
        if not np.all(np.abs(states[k, 1]) < RUNAWAY):
            advice = "; try position_w_id" if joints.is_sawyer else ""
            raise ModelError(f"the simulated arm runs away in {mode} mode at {time[k]:.2f} s{advice}")
        reached = plan.progress(states[k, 0], reached, time[k])
        played = min(reached, played + fastest)
        force, moment = load * plan.force[played], load * plan.moment[played]
        for step in range(TICKS):
            now = time[k] + STEP * step
            if now >= 0.0 and (step == phase or not stiff):
                q, v, reference = (joints.signs * row for row in (arm.position, arm.velocity, arm.reference))
                command = server.command(now, q + noise[k, 0], v + noise[k, 1], reference)
            rate, acceleration, torque = (
                joints.signs * row for row in (command.rate, command.acceleration, command.torque)
            )
            arm.advance(rate, acceleration, torque, force, moment)
            if step == 0:
                tips[k] = arm.tip  # of the state before the step
    seen = states + noise
    return Trial(states[:, 0], states[:, 2], tips, seen[:, 0], seen[:, 1], seen[:, 2], server.outcome, server.gave_up)


def _above_gravity(arm: SimulatedArm, trajectory: JointTrajectory, plan: Plan) -> tuple[Array, Array]:
    """Return what to stream (K, n), and (n,) to hold the start: torques without what the arm adds, in its signs.

    The last point is one of rest, as the server takes it.
    """
    signs = trajectory.joints.signs
    gravity = np.stack([signs * arm.gravity(signs * q) for q in trajectory.position])
    streamed = plan.at(plan.torque, trajectory.time) - gravity
    streamed[-1] = plan.torque[-1] - gravity[-1]
    return streamed, plan.torque[0] - gravity[0]
