"""A dry run as files: bags as a robot records them, NetCDF, a summary as JSON, and a plot."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from liftopt.lab.robot.bags import Record, write_bag
from liftopt.lab.robot.dry_run import BEFORE, DryRun, Trial
from liftopt.lab.robot.dry_run_summary import Summary
from liftopt.lab.robot.export_formats import goal_topic, state_topic
from liftopt.lab.robot.ros_messages import JOINT_STATE, SECOND, RosMessages
from liftopt.lab.robot.trajectory_files import goal_records

HEAD = "head_pan"  # Sawyer reports it among its joints
APART = 60 * SECOND  # the trials begin a minute from each other, the first a minute after time 0


def write_dry_run(run: DryRun, summary: Summary, folder: Path) -> list[str]:
    """Write a dry run into an empty folder and return the names of its files.

    A bag has what ``rosbag record`` would: sensor_msgs/JointState at 100 Hz with the noise of sensors, and the goal
    at the moment it was sent, half a second into the record; in torque mode only the trajectory.

    Raises:
        InputError: ``rosbags`` is not installed.
        OSError: a file cannot be written.
    """
    messages = RosMessages.of(ros1=True)
    names = []
    for number, trial in enumerate(run.trials, start=1):
        records = _records(messages, run, trial, number * APART)
        names.append(write_bag(folder / f"trial_{number}", "ros1", messages, records).name)
    _write_netcdf(run, folder / "dry_run.nc")
    (folder / "summary.json").write_text(json.dumps(summary.as_dict(), indent=1, allow_nan=False) + "\n", "utf-8")
    (folder / "dry_run.svg").write_bytes(_plot(run))
    return [*names, "dry_run.nc", "summary.json", "dry_run.svg"]


def _records(messages: RosMessages, run: DryRun, trial: Trial, start: int) -> Iterator[Record]:
    sawyer, joints = run.trajectory.joints.is_sawyer, run.trajectory.joints
    names = [*([HEAD] if sawyer else []), *joints.names]
    topic, ahead = goal_topic(joints), np.zeros(len(names) - len(joints.names))
    states, sent = state_topic(joints), False
    for k, time in enumerate(run.time):
        stamp = start + round((float(time) + BEFORE) * SECOND)
        if time >= -1e-9 and not sent:
            sent = True
            goal = list(goal_records(messages, run.trajectory, run.goal_time, stamp, topic))
            yield from goal[:1] if run.mode == "torque" else goal
        rows = (trial.measured_position[k], trial.measured_velocity[k], trial.measured_torque[k])
        state = messages.joint_state(stamp, names, *(np.append(ahead, row) for row in rows))
        yield Record(states, JOINT_STATE, stamp, state)


def _write_netcdf(run: DryRun, path: Path) -> None:
    import xarray

    axes: dict[str, Any] = {
        "time": ("time", run.time, {"units": "s", "long_name": "time since the goal was sent"}),
        "joint": list(run.trajectory.names),
        "xyz": ["x", "y", "z"],
    }
    joints, trials = ("time", "joint"), ("trial", "time", "joint")
    slides = run.trajectory.joints.sliding.any()
    angle, torque = ("rad or m", "N m or N") if slides else ("rad", "N m")
    variables: dict[str, Any] = {
        "planned_position": (joints, run.planned_position, angle, "planned joint angle"),
        "planned_torque": (joints, run.planned_torque, torque, "planned joint torque"),
        "planned_tip": (("time", "xyz"), run.planned_tip, "m", "planned grasp point of the robot, world axes"),
        "position": (trials, np.stack([t.position for t in run.trials]), angle, "joint angle"),
        "torque": (trials, np.stack([t.torque for t in run.trials]), torque, "torque that the joint passed on"),
        "tip": (("trial", "time", "xyz"), np.stack([t.tip for t in run.trials]), "m", "grasp point, world axes"),
    }
    data = {
        k: (dims, values, {"units": unit, "long_name": long}) for k, (dims, values, unit, long) in variables.items()
    }
    attributes = {"mode": run.mode, "goal_time": run.goal_time, "outcomes": json.dumps([t.outcome for t in run.trials])}
    xarray.Dataset(data, axes, attributes).to_netcdf(path, engine="h5netcdf")


def _plot(run: DryRun) -> bytes:
    """Return an SVG: planned and simulated joint angles and torques over time, and the hand's offset."""
    from matplotlib import rc_context

    from liftopt.viz.plots import rendered
    from liftopt.viz.plots_style import FAINT, LINES, STYLE, panels

    with rc_context(STYLE):
        figure, grid = panels(len(run.trajectory.names) + 1, 2, height=0.9)
        for j, name in enumerate(run.trajectory.names):
            units = run.trajectory.joints.units[j]
            sides = zip(
                grid[j],
                (units.factor * run.planned_position[:, j], run.planned_torque[:, j]),
                ([units.factor * t.position[:, j] for t in run.trials], [t.torque[:, j] for t in run.trials]),
                (units.shown, units.tau),
                strict=True,
            )
            for axes, planned, trials, unit in sides:
                axes.plot(run.time, planned, color=LINES[0].color, linestyle=LINES[0].linestyle, label="planned")
                for values in trials:
                    axes.plot(run.time, values, color=LINES[1].color, linewidth=0.9, label="simulated")
                axes.set(title=name, ylabel=unit)
        handles, labels = grid[0][0].get_legend_handles_labels()
        figure.legend(handles[:2], labels[:2], ncols=2, loc="upper right")
        hand, tilt = grid[-1]
        for trial in run.trials:
            off = 1e3 * (trial.tip - run.planned_tip)
            hand.plot(run.time, np.linalg.norm(off, axis=1), color=LINES[1].color, linewidth=0.9)
            for i, axis in enumerate("xyz"):
                label = axis if trial is run.trials[0] else None
                tilt.plot(run.time, off[:, i], color=LINES[i].color, linestyle=LINES[i].linestyle, label=label)
        hand.set(title="hand led off, distance", ylabel="mm")
        tilt.set(title="hand led off, world axes", ylabel="mm")
        tilt.legend(ncols=3, loc="lower right")
        for axes in (axes for row in grid for axes in row):
            axes.axvline(float(run.trajectory.time[-1]), color=FAINT, linewidth=0.8)
        for axes in grid[-1]:
            axes.set_xlabel("time since the goal was sent [s]")
        return rendered(figure, "svg")
