"""``liftopt dry-run``: the exported motion on a simulated robot."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from liftopt.commands.export import add_goal_time, add_robot_name
from liftopt.commands.terminal import telling
from liftopt.types import Progress

MODES = ("velocity", "position", "position_w_id", "torque")


def add_dry_run_parser(commands: Any) -> None:
    """Add the command to the subparsers ``commands``."""
    parser = commands.add_parser(
        "dry-run",
        help="simulate what the robot would really do",
        description="Simulate the robot in MuJoCo, Sawyer under its trajectory action server, any other arm under a "
        "trajectory controller of positions: how far it is off and late, the torques, and where the person's hand "
        "would be led. Trials differ by friction, load and the noise of the sensors, and are written as bags that a "
        "robot could have recorded. The arm's inner loops are not published; what is assumed stands in "
        "liftopt/lab/robot/servo.py.",
        allow_abbrev=False,
    )
    parser.add_argument("result", metavar="RESULT", help="a result folder, or its solution.nc")
    parser.add_argument("--out", metavar="DIR", required=True, help="folder to write; it must not exist")
    parser.add_argument(
        "--mode",
        choices=MODES,
        help="of Sawyer's action server; torque is a client that streams the solved torques (default: velocity; any "
        "other robot has position)",
    )
    parser.add_argument("--trials", type=int, default=3, metavar="N", help="how many (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="of what differs between trials (default: 0)")
    add_goal_time(parser)
    add_robot_name(parser)
    parser.set_defaults(run=telling(dry_run_text))


def dry_run_text(args: argparse.Namespace, progress: Progress | None = None) -> str:
    """Do what the command line says and return what it prints.

    Raises:
        InputError: the result, an option or a package is wrong or missing.
    """
    from liftopt.lab.extra import check_extra
    from liftopt.multibody.bounds import checked_number
    from liftopt.storage.reader import load_result

    check_extra("rosbags", "write ROS bags")
    check_extra("mujoco", "simulate the robot")
    trials = int(checked_number("--trials", args.trials, 1, 100, "trials"))
    seed = int(checked_number("--seed", args.seed, 0, 2**32, "(a whole number)"))
    goal_time = checked_number("--goal-time", args.goal_time, 0.0, 120.0, "s")
    from liftopt.files.new_folder import new_folder
    from liftopt.lab.meant import the_robot
    from liftopt.lab.robot.dry_run import dry_run
    from liftopt.lab.robot.dry_run_files import write_dry_run
    from liftopt.lab.robot.dry_run_summary import reach_to_others, summarised, summary_text
    from liftopt.lab.robot.joint_map import JointMap

    solution, out = load_result(args.result), Path(args.out)
    with new_folder("--out", out) as folder:
        robot = the_robot(solution, args.robot).name
        joints = JointMap.of(solution, robot)
        mode: Any = args.mode or ("velocity" if joints.is_sawyer else "position")
        run = dry_run(solution, mode, goal_time, trials, seed, progress, robot)
        summary = summarised(run, reach_to_others(solution.scenario, robot))
        names = write_dry_run(run, summary, folder)
    others = [agent.kind for agent in solution.agents if agent.name != robot]
    hands = sum(len(agent.grasps) for agent in solution.agents if agent.name != robot)
    alone = "The person's hand is" if hands == 1 else "The middle of the person's hands is"
    followers = alone if others == ["person"] else "What the others hold is"
    return f"{summary_text(summary, followers, list(joints.sliding))}\nWritten to {out}: {', '.join(names)}\n"
