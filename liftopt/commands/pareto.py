"""``liftopt pareto``: the front of human against robot effort as a table, files and a plot."""

from __future__ import annotations

import argparse
import csv
import io
import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from liftopt.errors import InputError, LiftoptError
from liftopt.files.atomic_file import write_whole
from liftopt.storage.solved_scenario import scenario_or_solved
from liftopt.viz import FORMATS

if TYPE_CHECKING:
    from liftopt.studies.pareto import Front, Point


def add_pareto_parser(commands: Any, run: Callable[[argparse.Namespace], int]) -> None:
    """Add the command to the subparsers ``commands``; ``run`` carries it out."""
    parser = commands.add_parser(
        "pareto",
        help="what the person gains where the robot works more: the front of their efforts",
        description="Solve a scenario for many ratios of human to robot weight, 100 : 1 to 1 : 100, keep what no other "
        "compromise beats in both efforts, and write pareto.csv, pareto.json and a plot.",
        allow_abbrev=False,
    )
    parser.add_argument(
        "scenario", nargs="?", metavar="SCENARIO", help="a TOML file, or one that is shipped (default: table5)"
    )
    parser.add_argument("--points", type=int, default=11, metavar="N", help="ratios of weights (default: %(default)s)")
    parser.add_argument("--out", required=True, metavar="DIR", help="folder for the files")
    parser.add_argument(
        "--set", action="append", default=[], dest="overrides", metavar="KEY=VALUE", help="as with solve"
    )
    parser.add_argument("--json", action="store_true", help="print pareto.json instead of the table")
    parser.set_defaults(run=run)


def pareto(args: argparse.Namespace, progress: Callable[[str], None] | None = None) -> str:
    """Do what the command line says and return what it prints.

    Raises:
        InputError: the scenario or an option is wrong, or a file cannot be written.
        LiftoptError: there is no verified solution at all.
    """
    scenario, out = scenario_or_solved(args.scenario, args.overrides), Path(args.out)
    there = next(folder for folder in (out, *out.absolute().parents) if os.path.exists(folder))
    if not there.is_dir():  # said before many solves, not after them
        raise InputError("--out", args.out, f"cannot be written: {there} is no folder")
    from liftopt.studies.pareto import pareto_front

    front = pareto_front(scenario, args.points, progress)
    if not front.points:
        raise LiftoptError(f"no verified solution for any ratio of weights; try liftopt solve {args.scenario or ''}")
    values = front_dict(front)
    write_front(front, values, out)
    if args.json:
        return json.dumps(values, allow_nan=False) + "\n"
    return table(values) + f"Written to {out}: pareto.csv, pareto.json, pareto.svg, pareto.png, pareto.pdf\n"


def write_front(front: Front, values: dict[str, Any], out: Path) -> None:
    """Write a front, and its ``values`` from ``front_dict``, into a folder as a table, as JSON and as a figure.

    Raises:
        InputError: a file cannot be written.
    """
    from matplotlib import rc_context

    from liftopt.viz.plots import rendered
    from liftopt.viz.plots_pareto import pareto_figure
    from liftopt.viz.plots_style import STYLE

    text = io.StringIO()
    rows = values["points"]
    writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    write_whole("--out", out / "pareto.csv", text.getvalue().encode())
    write_whole("--out", out / "pareto.json", (json.dumps(values, allow_nan=False) + "\n").encode())
    with rc_context(STYLE):
        figure = pareto_figure(front)
    for kind in FORMATS:
        write_whole("--out", out / f"pareto.{kind}", rendered(figure, kind))


def front_dict(front: Front) -> dict[str, Any]:
    """Return a front ready for JSON: dominated points are among the others, marked."""
    every = sorted((*front.points, *front.dominated), key=lambda point: point.weights)
    return {
        "scenario": front.scenario.to_dict(),
        "points": [_row(point, point in front.dominated) for point in every],
        "missing_weights": [list(weights) for weights in front.missing],
    }


def _row(point: Point, dominated: bool) -> dict[str, Any]:
    """Return figures of a point, units in the names."""
    import numpy as np

    from liftopt.solution.checks import FINER
    from liftopt.solution.summary import limit_share

    times = np.linspace(0.0, point.candidate.problem.task.duration, FINER * point.candidate.spline.intervals + 1)
    human, robot = (float(limit_share(agent).max()) for agent in point.candidate.at(times).agents)
    return {
        "human_weight": point.weights[0],
        "robot_weight": point.weights[1],
        "human_effort_N2m2s": point.efforts[0],
        "robot_effort_N2m2s": point.efforts[1],
        "human_load_share": point.share,
        "human_largest_share_of_limit": human,
        "robot_largest_share_of_limit": robot,
        "objective": float(point.candidate.result.objective),
        "verified": 1,
        "dominated": int(dominated),
    }


def table(values: dict[str, Any]) -> str:
    """Return the table that the command prints, of what ``front_dict`` returned."""
    from liftopt.studies.pareto import ratio_text

    lines = [
        "Effort is the integral of squared joint torques; load is the person's mean part of the object's weight, most",
        "used the largest part of a joint's torque limit.",
        "",
        f"{'weights person : robot':>22} {'person':>10} {'robot':>10} {'load':>6} {'most used':>15}",
        f"{'':>22} {'[N2 m2 s]':>10} {'[N2 m2 s]':>10} {'[%]':>6} {'person':>7} {'robot':>7}",
    ]
    for row in values["points"]:
        weights = ratio_text((row["human_weight"], row["robot_weight"]))
        used = [f"{100 * row[f'{who}_largest_share_of_limit']:.0f}%" for who in ("human", "robot")]
        lines.append(
            f"{weights:>22} {row['human_effort_N2m2s']:10.1f} {row['robot_effort_N2m2s']:10.1f} "
            f"{100 * row['human_load_share']:6.1f} {used[0]:>7} {used[1]:>7}"
            + ("  beaten in both" if row["dominated"] else "")
        )
    for human, robot in values["missing_weights"]:
        lines.append(f"{ratio_text((human, robot)):>22}  has no verified solution")
    return "\n".join(lines) + "\n"
