"""What a dry run says in figures: how far off, how late, how much torque, and where the person's hand is led."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from io import StringIO
from typing import Any

import numpy as np

from liftopt.lab.robot.action_server import SPEED_RATIO
from liftopt.lab.robot.dry_run import DryRun
from liftopt.multibody.joint_units import units_of
from liftopt.scenario.grasps import grasp_points
from liftopt.scenario.model import Scenario
from liftopt.solution.interpolation import linear
from liftopt.types import Array

LATEST = 1.5  # [s]: delays are sought up to this
AT_LIMIT = 0.999  # of the torque's limit; what drives a joint ends at it, friction is taken off what it passes on
PATH_STEPS = 20  # points between two of the plan's, for the distance from its path


@dataclass(frozen=True)
class JointSummary:
    """One joint over all trials; metres and newtons where it slides.

    Attributes:
        name: of the joint.
        error_max: off the plan, the most [rad].
        error_rms: off the plan, root mean square over the time of the motion [rad].
        error_at_end: off when the motion's time is over, the worst trial [rad].
        error_final: off when the server is done [rad].
        torque_max: that the joint passed on [Nm].
        planned_torque_max: of the solution [Nm].
        limit: of its torque [Nm].
    """

    name: str
    error_max: float
    error_rms: float
    error_at_end: float
    error_final: float
    torque_max: float
    planned_torque_max: float
    limit: float


@dataclass(frozen=True)
class Margins:
    """How near a robot comes to its limits, of all joints and trials the most; shares of the limit.

    Attributes:
        torque, torque_joint: of the torque that a joint passed on, and which.
        speed, speed_joint: of the speed, and which.
        at_limit: how long in all some joint's torque is at its limit, in the worst trial [s].
    """

    torque: float
    torque_joint: str
    speed: float
    speed_joint: str
    at_limit: float


@dataclass(frozen=True)
class Summary:
    """A dry run in figures; lengths are the worst trial's.

    Attributes:
        mode: of the server.
        outcomes: how each trial ended.
        joints: one each.
        delay: by which the plan must be shifted to fit what the joints did best [s]; None where they did not follow.
        hand_max, hand_at_end, hand_final: how far the gripper, and with it the hand that follows, is off where it
            should be at that time: the most, at the end of the motion, and when the server is done [m].
        off_path: the most it is off the planned path, whenever it should be there [m].
        tilt: by which the object would be tilted at most if the hand kept to the plan instead [rad].
        fast: joints that the plan turns faster than Sawyer's position mode does; none in other modes.
        margins: to the limits; None of Sawyer, whose torques stand beside their limits alone.
    """

    mode: str
    outcomes: tuple[str, ...]
    joints: tuple[JointSummary, ...]
    delay: float | None
    hand_max: float
    hand_at_end: float
    hand_final: float
    off_path: float
    tilt: float
    fast: tuple[str, ...]
    margins: Margins | None = None

    def as_dict(self) -> dict[str, Any]:
        """Return it as plain data, without margins where there are none."""
        return {key: value for key, value in asdict(self).items() if key != "margins" or value is not None}


def summarised(run: DryRun, depth: float) -> Summary:
    """Return a dry run in figures.

    Args:
        run: of the simulated arm.
        depth: from the robot's grasp to the middle of the others' [m].
    """
    end = float(run.trajectory.time[-1])
    lift, last = (run.time >= 0.0) & (run.time <= end + 1e-9), int(np.searchsorted(run.time, end - 1e-9))
    error = np.abs(np.stack([trial.position for trial in run.trials]) - run.planned_position)
    torque = np.abs(np.stack([trial.torque for trial in run.trials]))
    off = np.stack([trial.tip for trial in run.trials]) - run.planned_tip
    away, limits = np.linalg.norm(off, axis=2), np.abs(run.trajectory.joints.effort).max(axis=0)
    joints = tuple(
        JointSummary(
            name,
            float(error[:, :, j].max()),
            float(np.sqrt(np.square(error[:, lift, j]).mean())),
            float(error[:, last, j].max()),
            float(error[:, -1, j].max()),
            float(torque[:, :, j].max()),
            float(np.abs(run.planned_torque[:, j]).max()),
            float(limits[j]),
        )
        for j, name in enumerate(run.trajectory.names)
    )
    return Summary(
        run.mode,
        tuple(trial.outcome for trial in run.trials),
        joints,
        _delay(run) if run.mode != "torque" and not any(trial.gave_up for trial in run.trials) else None,
        float(away.max()),
        float(away[:, last].max()),
        float(away[:, -1].max()),
        max(_off_path(run, trial.tip) for trial in run.trials),
        float(np.arctan2(np.abs(off[:, :, 2]), depth).max()),
        _fast(run) if run.mode == "position" and run.trajectory.joints.is_sawyer else (),
        None if run.trajectory.joints.is_sawyer else _margins(run),
    )


def reach_to_others(scenario: Scenario, robot: str) -> float:
    """Return the distance from where a robot holds the object to the middle of where the others do [m]."""
    points = {name: np.array(point) for name, point in grasp_points(scenario).items()}
    own = points.pop(robot)
    return float(np.linalg.norm(own - np.mean(list(points.values()), axis=0)))


def summary_text(
    summary: Summary, followers: str = "The person's hand is", sliding: Sequence[bool] | None = None
) -> str:
    """Return a summary as a plain text table and a few lines.

    Args:
        summary: of a dry run.
        followers: those whom the robot leads.
        sliding: which of its joints slide; None for none.
    """
    from rich.console import Console
    from rich.table import Table

    table = Table(box=None, pad_edge=False)
    table.add_column("joint", no_wrap=True)
    for heading in ("off, most", "rms", "at the end", "when done", "torque", "planned", "limit"):
        table.add_column(heading, no_wrap=True, justify="right")
    for joint, slides in zip(summary.joints, sliding or [False] * len(summary.joints), strict=True):
        errors = (joint.error_max, joint.error_rms, joint.error_at_end, joint.error_final)
        torques = (joint.torque_max, joint.planned_torque_max, joint.limit)
        units, digits = units_of(slides), 1 if slides else 2
        off = (f"{units.factor * e:.{digits}f} {units.shown}" for e in errors)
        table.add_row(joint.name, *off, *(f"{t:.1f} {units.tau}" for t in torques))
    text = StringIO()
    console = Console(file=text, width=200, color_system=None, force_terminal=False, markup=False, highlight=False)
    console.print(table)
    lines = [line.rstrip() for line in text.getvalue().splitlines()]
    lines += [f"Trial {i}: {outcome}" for i, outcome in enumerate(summary.outcomes, start=1)]
    if summary.delay is not None:
        lines.append(f"The arm is {summary.delay:.2f} s late.")
    controller = "server" if summary.margins is None else "controller"
    lines += [
        f"{followers} led off by at most {1e3 * summary.hand_max:.0f} mm ({1e3 * summary.off_path:.0f} mm off "
        f"the planned path), {1e3 * summary.hand_at_end:.0f} mm at the end of the motion, "
        f"{1e3 * summary.hand_final:.0f} mm when the {controller} is done.",
        f"If it kept to the plan instead, the object would tilt by {np.degrees(summary.tilt):.1f} deg.",
    ]
    if summary.fast:
        lines.append(
            f"Note: position mode turns joints at no more than {100 * SPEED_RATIO:.0f} % of their top speed, less than "
            f"the plan needs at {', '.join(summary.fast)}: set_joint_position_speed(1.0), or position_w_id"
        )
    if (near := summary.margins) is not None:
        at_limit = f" ({near.at_limit:.2f} s at it)" if near.at_limit > 0.0 else ""
        lines.append(
            f"Of its limits it uses {100 * near.torque:.0f} % of the torque of {near.torque_joint}{at_limit} and "
            f"{100 * near.speed:.0f} % of the speed of {near.speed_joint}."
        )
    if summary.mode == "velocity":
        lines.append("Note: with the server's own goal time, 0 s, the arm stops where it is at the end of the motion")
    return "\n".join(lines)


def _fast(run: DryRun) -> tuple[str, ...]:
    peak = np.abs(run.trajectory.velocity).max(axis=0) / (SPEED_RATIO * run.trajectory.joints.speed)
    return tuple(name for name, share in zip(run.trajectory.names, peak, strict=True) if share > 1.0)


def _margins(run: DryRun) -> Margins:
    joints, step = run.trajectory.joints, float(run.time[1] - run.time[0])
    torque = np.stack([np.abs(trial.torque) for trial in run.trials]) / np.abs(joints.effort).max(axis=0)
    speed = np.stack([np.abs(np.gradient(trial.position, step, axis=0)) for trial in run.trials]) / joints.speed
    strongest, fastest = (int(np.argmax(share.max(axis=(0, 1)))) for share in (torque, speed))
    return Margins(
        float(torque.max()),
        joints.names[strongest],
        float(speed.max()),
        joints.names[fastest],
        step * int((torque >= AT_LIMIT).any(axis=2).sum(axis=1).max()),
    )


def _delay(run: DryRun) -> float:
    """Return the delay, to the recording's period, whose shifted plan is nearest to what the trials did."""
    step = float(run.time[1] - run.time[0])
    span = float(run.trajectory.time[-1])
    moving = (run.time >= 0.0) & (run.time <= span + LATEST)
    costs = []
    for k in range(round(min(LATEST, span) / step)):
        # Before its start the plan stands still, so the first rows repeat.
        shifted = np.vstack([np.repeat(run.planned_position[:1], k, axis=0), run.planned_position])[: len(run.time)]
        costs.append(sum(float(np.square(t.position - shifted)[moving].sum()) for t in run.trials))
    return step * int(np.argmin(costs))


def _off_path(run: DryRun, tip: Array) -> float:
    rows = np.arange(len(run.time), dtype=float)
    fine = np.linspace(0, len(rows) - 1, PATH_STEPS * (len(rows) - 1) + 1)
    path = linear(rows, run.planned_tip, fine)
    path = path[np.concatenate([[True], np.any(np.diff(path, axis=0) != 0.0, axis=1)])]
    return max(float(np.sqrt(np.square(path - point).sum(axis=1).min())) for point in tip)
