"""``liftopt export``: the robot's motion of a solved lift as files that the robot can be given."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from liftopt.commands.terminal import printing

MODES = ("velocity", "position", "position_w_id")
FORMATS = ("ros1", "ros2", "mcap", "csv", "json")
# The server's velocity mode is late; of what is missing at the end, exp(-2 * 3) = 0.25 % is left 3 s later. Its own
# default is 0 s: it stops where it is when the trajectory's time is over.
GOAL_TIME = 3.0


def add_export_parser(commands: Any) -> None:
    """Add the command to the subparsers ``commands``."""
    parser = commands.add_parser(
        "export",
        help="write the robot's motion as ROS bags, CSV and JSON",
        description="Write the robot's motion of a solved lift for its trajectory action server: Sawyer's own joint "
        "names and signs, positions, velocities and accelerations. It is checked against the robot's limits and the "
        "server's demands first. Playing the ROS 1 bag (rosbag play) sends the goal: THE ROBOT MOVES.",
        allow_abbrev=False,
    )
    parser.add_argument("result", metavar="RESULT", help="a result folder, or its solution.nc")
    parser.add_argument("--out", metavar="DIR", required=True, help="folder to write; it must not exist")
    parser.add_argument(
        "--format",
        action="append",
        choices=(*FORMATS, "all"),
        dest="formats",
        help="may be repeated (default: all)",
    )
    parser.add_argument("--rate", type=float, default=100.0, metavar="HZ", help="points a second (default: 100)")
    parser.add_argument(
        "--current-pose",
        metavar="POSE",
        help='where the arm is, right_j0 to right_j6 in rad, as "[a, b, c, d, e, f, g]": the start is checked by it',
    )
    parser.add_argument(
        "--mode",
        choices=MODES,
        default="position_w_id",
        help="of the action server, which says how far the arm may be from the start (default: %(default)s, its own)",
    )
    add_goal_time(parser)
    add_robot_name(parser)
    parser.add_argument("--json", action="store_true", help="print what was written, and the notes, as one JSON object")
    parser.set_defaults(run=printing(export_text))


def add_goal_time(parser: argparse.ArgumentParser) -> None:
    """Add the option that says how long the action server goes on after the motion's end."""
    parser.add_argument(
        "--goal-time",
        type=float,
        default=GOAL_TIME,
        metavar="S",
        help="how long the action server may go on towards the last point (default: %(default)s)",
    )


def add_robot_name(parser: argparse.ArgumentParser) -> None:
    """Add the option that says which robot is meant."""
    parser.add_argument("--robot", metavar="NAME", help="which robot, where the lift has several")


def export_text(args: argparse.Namespace) -> str:
    """Do what the command line says and return what it prints.

    Raises:
        InputError: the result, an option or a package is wrong or missing, or the robot cannot do the motion.
    """
    from liftopt.lab.extra import check_extra
    from liftopt.multibody.bounds import checked_number
    from liftopt.storage.reader import load_result

    formats: Any = FORMATS if args.formats is None or "all" in args.formats else args.formats
    if not {"ros1", "ros2", "mcap"}.isdisjoint(formats):
        check_extra("rosbags", "write ROS bags")
    goal_time = checked_number("--goal-time", args.goal_time, 0.0, 120.0, "s")  # 120 s is the server's own limit
    from liftopt.files.new_folder import new_folder
    from liftopt.lab.robot.joint_trajectory import joint_trajectory
    from liftopt.lab.robot.robot_limits import (
        NEAR,
        OFF_PLAN,
        START,
        check_limits,
        check_motion,
        check_server,
        check_start,
        read_pose,
        remarks,
    )
    from liftopt.lab.robot.trajectory_files import write_trajectory

    solution = load_result(args.result)
    trajectory = joint_trajectory(solution, args.rate, args.robot)
    check_limits(solution, args.robot)
    check_motion(trajectory)
    off_plan = check_server(solution, trajectory, args.rate, args.robot)
    notes = list(remarks(trajectory))
    if off_plan > OFF_PLAN:
        notes.append(
            f"the action server's curve through these points leaves the plan by {off_plan:.4f} rad: raise --rate"
        )
    if args.current_pose is None:
        accepted = f"{START[args.mode]:g} rad of the arm ({args.mode} mode)"
        notes.append(f"no --current-pose given: that the motion starts within {accepted} is not checked")
    elif (away := check_start(trajectory, read_pose(args.current_pose), args.mode)) > NEAR:
        notes.append(f"the arm is {away:.3f} rad from the start: move it there first, or it jerks")
    out = Path(args.out)
    with new_folder("--out", out) as folder:
        files = [path.name for path in write_trajectory(trajectory, folder, formats, goal_time)]
    summary = {
        "result": args.result,
        "out": args.out,
        "points": len(trajectory.time),
        "duration": float(trajectory.time[-1]),
        "rate": args.rate,
        "mode": args.mode,
        "off_plan": off_plan,
        "notes": notes,
        "files": files,
    }
    if args.json:
        return json.dumps(summary, allow_nan=False) + "\n"
    lines = [f"{len(trajectory.time)} points in {trajectory.time[-1]:.3f} s, within the robot's limits"]
    lines += [f"Note: {note}" for note in notes]
    return "\n".join([*lines, f"Written to {out}: {', '.join(files)}"]) + "\n"
