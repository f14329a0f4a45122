"""``liftopt export``: the robot's motion of a solved lift as files that the robot can be given."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from liftopt.commands.terminal import printing
from liftopt.errors import InputError

if TYPE_CHECKING:
    from liftopt.lab.robot.joint_trajectory import JointTrajectory

MODES = ("velocity", "position", "position_w_id")
MODE = "position_w_id"
FORMATS = ("ros1", "ros2", "mcap", "csv", "json", "urscript")
# Sawyer's velocity mode is late; of what is missing at the end, exp(-2 * 3) = 0.25 % is left 3 s later. Its server's
# own default is 0 s: it stops where it is when the trajectory's time is over.
GOAL_TIME = 3.0


def add_export_parser(commands: Any) -> None:
    """Add the command to the subparsers ``commands``."""
    parser = commands.add_parser(
        "export",
        help="write the robot's motion as ROS bags, CSV, JSON and URScript",
        description="Write the robot's motion of a solved lift for its trajectory controller: the robot's own joint "
        "names and signs, positions, velocities and accelerations; for the arms of Universal Robots as a URScript "
        "program too. It is checked against the robot's limits and the controller's demands first. Playing the ROS 1 "
        "bag (rosbag play) sends the goal, running the program asks twice: THE ROBOT MOVES.",
        allow_abbrev=False,
    )
    parser.add_argument("result", metavar="RESULT", help="a result folder, or its solution.nc")
    parser.add_argument("--out", metavar="DIR", required=True, help="folder to write; it must not exist")
    parser.add_argument(
        "--format",
        action="append",
        choices=(*FORMATS, "all"),
        dest="formats",
        help="may be repeated (default: all that the robot has)",
    )
    parser.add_argument("--rate", type=float, default=100.0, metavar="HZ", help="points a second (default: 100)")
    parser.add_argument(
        "--servo-rate",
        choices=("125", "500"),
        default="125",
        help="targets a second of URScript: 125 for CB3 and e-Series, 500 for e-Series (default: %(default)s)",
    )
    parser.add_argument(
        "--controller",
        metavar="NAME",
        help="whose goals the bags hold (default: /joint_trajectory_controller; Sawyer's own)",
    )
    parser.add_argument(
        "--held-joints",
        action="store_true",
        help="write the joints that the scenario locks too, for a controller that has them",
    )
    parser.add_argument(
        "--current-pose",
        metavar="POSE",
        help='where the arm is, its joints in order, for Sawyer right_j0 to right_j6 in rad, as "[a, b, ...]": the '
        "start is checked by it",
    )
    parser.add_argument(
        "--mode",
        choices=MODES,
        help=f"of Sawyer's action server, which says how far it may be from the start (default: {MODE}, its own)",
    )
    add_goal_time(parser)
    add_robot_name(parser)
    parser.add_argument("--json", action="store_true", help="print what was written, and the notes, as one JSON object")
    parser.set_defaults(run=printing(export_text))


def add_goal_time(parser: argparse.ArgumentParser) -> None:
    """Add the option that says how long the controller goes on after the motion's end."""
    parser.add_argument(
        "--goal-time",
        type=float,
        default=GOAL_TIME,
        metavar="S",
        help="how long the controller may go on towards the last point (default: %(default)s)",
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

    asked = args.formats or ["all"]
    if not {"all", "ros1", "ros2", "mcap"}.isdisjoint(asked):
        check_extra("rosbags", "write ROS bags")
    goal_time = checked_number("--goal-time", args.goal_time, 0.0, 120.0, "s")  # 120 s is Sawyer's server's own limit
    from liftopt.files.new_folder import new_folder
    from liftopt.lab.robot.export_formats import asked_formats, goal_topic
    from liftopt.lab.robot.joint_trajectory import joint_trajectory, trajectory_at
    from liftopt.lab.robot.robot_limits import check_curve, check_limits, check_motion
    from liftopt.lab.robot.trajectory_files import write_text, write_trajectory
    from liftopt.lab.robot.urscript import PERIODS, servo_times, urscript

    solution = load_result(args.result)
    trajectory = joint_trajectory(solution, args.rate, args.robot)
    joints = trajectory.joints
    formats, topic = asked_formats(asked, joints), goal_topic(joints, args.controller)
    mode = _mode(args.mode, sawyer=joints.is_sawyer)
    check_limits(solution, args.robot)
    check_motion(trajectory)
    off_plan = check_curve(solution, trajectory, args.rate, args.robot)
    program = ""
    if "urscript" in formats:
        period = PERIODS[args.servo_rate]
        targets = trajectory_at(solution, servo_times(float(trajectory.time[-1]), period), args.robot)
        program = urscript(targets, period, solution.scenario.name)
    notes = list(_notes(trajectory, args, mode, off_plan, bool(program)))
    written = trajectory.with_held() if args.held_joints else trajectory
    out = Path(args.out)
    with new_folder("--out", out) as folder:
        kinds = [kind for kind in formats if kind != "urscript"]
        paths = write_trajectory(written, folder, kinds, goal_time, topic)
        files = [path.name for path in (*paths, *([write_text(program, folder, "script")] if program else []))]
    summary = {
        "result": args.result,
        "out": args.out,
        "points": len(trajectory.time),
        "duration": float(trajectory.time[-1]),
        "rate": args.rate,
        "mode": mode,
        "off_plan": off_plan,
        "notes": notes,
        "files": files,
    }
    if not joints.is_sawyer:
        summary |= {"joints": list(written.names), "topic": topic}
    if args.json:
        return json.dumps(summary, allow_nan=False) + "\n"
    lines = [f"{len(trajectory.time)} points in {trajectory.time[-1]:.3f} s, within the robot's limits"]
    if not joints.is_sawyer:
        lines.append(f"Joints: {', '.join(written.names)}")
    lines += [f"Note: {note}" for note in notes]
    return "\n".join([*lines, f"Written to {out}: {', '.join(files)}"]) + "\n"


def _mode(asked: str | None, *, sawyer: bool) -> Any:
    if asked is not None and not sawyer:
        raise InputError("--mode", asked, "is of Sawyer's action server; this robot is another: leave it out")
    return (asked or MODE) if sawyer else None


def _notes(
    trajectory: JointTrajectory, args: argparse.Namespace, mode: Any, off_plan: float, program: bool
) -> Iterator[str]:
    from liftopt.lab.robot.robot_limits import OFF_PLAN
    from liftopt.lab.robot.robot_remarks import remarks
    from liftopt.lab.robot.robot_start import NEAR, accepted_start, check_start, read_pose

    joints = trajectory.joints
    yield from remarks(trajectory)
    if off_plan > OFF_PLAN:
        whose = "the action server's" if joints.is_sawyer else "the controller's"
        yield f"{whose} curve through these points leaves the plan by {off_plan:.4f} rad: raise --rate"
    if args.current_pose is None:
        of_mode = f" ({mode} mode)" if joints.is_sawyer else ""
        accepted = f"{accepted_start(mode):g} rad of the arm{of_mode}"
        yield f"no --current-pose given: that the motion starts within {accepted} is not checked"
    elif (away := check_start(trajectory, read_pose(args.current_pose, joints), mode)) > NEAR:
        yield f"the arm is {away:.3f} rad from the start: move it there first, or it jerks"
    if joints.held and not args.held_joints:
        held = ", ".join(f"{name} at {value:g}" for name, value in joints.held)
        yield f"held and not written: {held}; bring them there, or write them with --held-joints"
    if program:
        yield "the program sets neither payload nor tool: set both before, the robot's share of the object included"
