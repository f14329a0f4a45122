"""``liftopt compare``: a prediction beside recordings of the lift, as a table, files, plots and a page."""

from __future__ import annotations

import argparse
import json
import math
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from liftopt.commands.record import add_divider_arguments, add_unloaded_argument, calibration_of, unloaded_of
from liftopt.commands.terminal import captured, printing

if TYPE_CHECKING:
    from rich.console import Console

    from liftopt.lab.comparison.experiment import Experiment
    from liftopt.lab.robot.robot_record import RobotRecord
    from liftopt.solution.solution import Solution

WIDEST = 27  # of a quantity's name; the tables stand below each other


def add_compare_parser(commands: Any) -> None:
    """Add the command to the subparsers ``commands``."""
    parser = commands.add_parser(
        "compare",
        help="put recordings of a lift beside its prediction",
        description="Compare a solved lift with what motion capture, force sensors and the robot recorded: curves "
        "over the lift in percent, mean and spread over the trials, peak difference, RMSE, correlation and phase. "
        "Recordings are never changed.",
        allow_abbrev=False,
    )
    parser.add_argument("result", metavar="RESULT", help="a result folder, or its solution.nc")
    parser.add_argument("--mocap", nargs="+", default=[], metavar="FOLDER", help="of liftopt mocap, one a trial")
    parser.add_argument("--forces", nargs="+", default=[], metavar="CSV", help="of force sensors; each holds trials")
    parser.add_argument("--calibration", metavar="CAL", help="of the sensors, where a CSV holds voltages")
    add_unloaded_argument(parser)
    parser.add_argument(
        "--forces-lift",
        nargs=2,
        type=float,
        metavar=("START", "END"),
        help="of the lift, seconds after each trial's first sample (default: the whole trial)",
    )
    parser.add_argument(
        "--robot", nargs="+", default=[], metavar="BAG", help="with sensor_msgs/JointState, one a trial (ROS 1 or 2)"
    )
    parser.add_argument("--person", metavar="NAME", help="whom --mocap and --forces are of, where several lift")
    parser.add_argument("--robot-name", metavar="NAME", help="whose --robot is, where the lift has several")
    parser.add_argument("--out", metavar="DIR", required=True, help="folder to write; it must not exist")
    parser.add_argument("--report", action="store_true", help="add the report of the lift with the experiment in it")
    parser.add_argument("--json", action="store_true", help="print the summary as one JSON object")
    add_divider_arguments(parser)
    parser.set_defaults(run=printing(compare_text))


def compare_text(args: argparse.Namespace) -> str:
    """Do what the command line says and return what it prints.

    Raises:
        InputError: the result, a recording or an option is wrong, or a package is missing.
    """
    from liftopt.storage.reader import load_result

    solution, out = load_result(args.result), Path(args.out)
    from liftopt.files.new_folder import new_folder
    from liftopt.lab.comparison.plots import drawn_comparisons
    from liftopt.viz import FORMATS
    from liftopt.viz.plots import rendered

    found = _experiment(args, solution)
    summary = summary_dict(found) | {"result": args.result, "out": args.out}
    with new_folder("--out", out) as folder:
        (folder / "comparison.json").write_text(_json(summary, indent=1), "utf-8")
        (folder / "comparison.csv").write_text(csv_text(found), "utf-8")
        for plot, figure in drawn_comparisons(found):
            for kind in FORMATS:
                (folder / f"{plot.name}.{kind}").write_bytes(rendered(figure, kind))
        if args.report:
            from liftopt.lab.comparison.section import experiment_section
            from liftopt.viz.report import write_report

            write_report(solution, folder / "report.html", [experiment_section(found)])
    return _json(summary) if args.json else captured(lambda console: _print(found, args.out, console))


def _experiment(args: argparse.Namespace, solution: Solution) -> Experiment:
    from liftopt.lab.comparison.experiment import experiment
    from liftopt.lab.forces.force_file import read_forces
    from liftopt.lab.mocap.recorded_file import load_recorded
    from liftopt.multibody.bounds import checked_number

    calibration, unloaded = calibration_of(args), unloaded_of(args)
    span = None
    if args.forces_lift is not None:
        start = checked_number("--forces-lift", args.forces_lift[0], 0.0, 3600.0, "s")
        span = (start, checked_number("--forces-lift", args.forces_lift[1], 0.0, 3600.0, "s"))
    return experiment(
        solution,
        mocap=[load_recorded(path) for path in args.mocap],
        forces=[one for path in args.forces for one in read_forces(Path(path), calibration, unloaded)],
        robot=_robot_records(args, solution),
        forces_lift=span,
        person=args.person,
        robot_name=args.robot_name,
    )


def _robot_records(args: argparse.Namespace, solution: Solution) -> list[RobotRecord]:
    from liftopt.lab.robot.joint_map import JointMap
    from liftopt.lab.robot.robot_record import read_robot_record

    if not args.robot:
        return []
    joints = JointMap.of(solution, args.robot_name, "--robot-name")
    return [read_robot_record(Path(path), joints) for path in args.robot]


def summary_dict(found: Experiment) -> dict[str, Any]:
    """Return what the command prints with ``--json``; a measure that says nothing is null."""
    return {
        "duration": found.duration,
        "quantities": [
            {"group": one.group, "name": one.name, "label": one.label, "unit": one.unit, "trials": len(one.trials)}
            | {key: value if math.isfinite(value) else None for key, value in asdict(one.measures).items()}
            | {"spread": float(one.spread.mean())}
            for one in found.comparisons
        ],
        "notes": list(found.notes),
    }


def csv_text(found: Experiment) -> str:
    """Return one line a quantity and percent of the lift: predicted, mean, standard deviation, then the trials."""
    from liftopt.lab.comparison.comparison import PERCENT

    most = max(len(one.trials) for one in found.comparisons)
    head = ["group", "name", "unit", "percent", "predicted", "mean", "sd", *(f"trial {i + 1}" for i in range(most))]
    lines = [",".join(head)]
    for one in found.comparisons:
        mean, spread = one.mean, one.spread
        for k, percent in enumerate(PERCENT):
            values = [one.predicted[k], mean[k], spread[k], *one.trials[:, k]]
            cells = [one.group, one.name, one.unit, f"{percent:g}", *(f"{value:.6g}" for value in values)]
            lines.append(",".join(cells + [""] * (len(head) - len(cells))))
    return "\n".join(lines) + "\n"


def _json(summary: dict[str, Any], indent: int | None = None) -> str:
    return json.dumps(summary, indent=indent, allow_nan=False) + "\n"


def _print(found: Experiment, out: str, console: Console) -> None:
    from rich.markup import escape
    from rich.table import Table

    from liftopt.lab.comparison.plots import HEADER, experiment_tables

    for title, rows in experiment_tables(found).items():
        table = Table(title, *HEADER[:-1], box=None, header_style="bold", pad_edge=False)
        table.columns[0].min_width = WIDEST
        for column in table.columns[2:]:
            column.justify, column.no_wrap = "right", True
        for row in rows:
            table.add_row(*(escape(cell) for cell in row[:-1]))
        console.print(table)
    console.print(
        "differ: predicted peak against the recorded one, in %; phase: how late the record is, in % of the lift",
        highlight=False,
        soft_wrap=True,
    )
    for note in found.notes:
        console.print(f"Note: {note}", markup=False, highlight=False, soft_wrap=True)
    console.print(f"Written to {out}", markup=False, highlight=False, soft_wrap=True)
