"""``liftopt scenario``: a recorded lift becomes a scenario that can be solved and compared with it."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from liftopt.commands.terminal import printing


def add_scenario_parser(commands: Any) -> None:
    """Add the command to the subparsers ``commands``."""
    parser = commands.add_parser(
        "scenario",
        help="the scenario of a recorded lift, to predict it",
        description="Write the scenario of a recorded lift: the person, where the hand starts and ends, and how long "
        "it takes. A whole person lifts alone with both hands; to one of trunk and right arm a robot, which cannot "
        "shape the motion, stands for the other hand and bears the other half.",
        allow_abbrev=False,
    )
    parser.add_argument("recorded", metavar="FOLDER", help="that liftopt mocap wrote")
    parser.add_argument("--object-mass", type=float, metavar="KG", required=True, help="of all that is lifted")
    parser.add_argument("--lift", type=int, metavar="N", help="which lift, from 1, where the recording has several")
    parser.add_argument("--out", metavar="FILE", required=True, help="TOML file to write; it must not exist")
    parser.set_defaults(run=printing(scenario_text))


def scenario_text(args: argparse.Namespace) -> str:
    """Do what the command line says and return what it prints.

    Raises:
        InputError: the folder holds no recorded lift with an object, or the file exists.
    """
    from liftopt.files.new_file import write_new
    from liftopt.lab.mocap.recorded_file import load_recorded
    from liftopt.lab.mocap.recorded_scenario import recorded_scenario
    from liftopt.scenario.grasps import grasp_heights

    lift = load_recorded(args.recorded)
    if args.lift is not None:
        lift = lift.of_lift(args.lift)
    scenario = recorded_scenario(lift, args.object_mass)
    source = " ".join(lift.source.split())
    head = f"# Made from {source}; what stands for what: liftopt/lab/mocap/recorded_scenario.py.\n"
    write_new("--out", Path(args.out), head + scenario.to_toml())
    (low, high), ends = grasp_heights(scenario), ("start", "end")
    what, key = ("box's centre", "x") if lift.whole else ("hand", "human_distance")
    near, far = (scenario.value(f"task.{end}.{key}") for end in ends)
    return (
        f"{scenario.object.mass:g} kg from {low:g} to {high:g} m in {scenario.duration:g} s, "
        f"the {what} {near:g} to {far:g} m ahead of the feet\nWritten to {args.out}\n"
    )
