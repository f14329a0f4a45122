"""``liftopt pareto``: the front of two efforts, a person's and a robot's, as a table, files and a plot."""

from __future__ import annotations

import argparse
import csv
import io
import json
import os
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

from liftopt.commands.terminal import telling
from liftopt.errors import InputError, LiftoptError
from liftopt.files.atomic_file import write_whole
from liftopt.storage.solved_scenario import scenario_or_solved
from liftopt.types import Progress
from liftopt.viz import FORMATS

if TYPE_CHECKING:
    from liftopt.studies.pareto import Front, Point


def add_pareto_parser(commands: Any) -> None:
    """Add the command to the subparsers ``commands``."""
    parser = commands.add_parser(
        "pareto",
        help="what the person gains where the robot works more: the front of their efforts",
        description="Solve a scenario for many ratios of human to robot weight, from 100 times to a hundredth of the "
        "preset's, keep what no other compromise beats in both efforts, and write pareto.csv, pareto.json and a plot.",
        allow_abbrev=False,
    )
    parser.add_argument(
        "scenario", nargs="?", metavar="SCENARIO", help="a TOML file, or one that is shipped (default: table5)"
    )
    parser.add_argument("--points", type=int, default=11, metavar="N", help="ratios of weights (default: %(default)s)")
    parser.add_argument(
        "--between",
        nargs=2,
        metavar="NAME",
        help="whose efforts, where more than two lift (default: first person and first robot)",
    )
    parser.add_argument("--out", required=True, metavar="DIR", help="folder for the files")
    parser.add_argument(
        "--set", action="append", default=[], dest="overrides", metavar="KEY=VALUE", help="as with solve"
    )
    parser.add_argument("--json", action="store_true", help="print pareto.json instead of the table")
    parser.set_defaults(run=telling(pareto))


def pareto(args: argparse.Namespace, progress: Progress | None = None) -> str:
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

    front = pareto_front(scenario, args.points, progress, args.between)
    if not front.points:
        raise LiftoptError(f"no verified solution for any ratio of weights; try liftopt solve {args.scenario or ''}")
    values = front_dict(front)
    write_front(front, values, out)
    if args.json:
        return json.dumps(values, allow_nan=False) + "\n"
    return table(front, values) + f"Written to {out}: pareto.csv, pareto.json, pareto.svg, pareto.png, pareto.pdf\n"


def write_front(front: Front, values: dict[str, Any], out: Path) -> None:
    """Write a front, and its ``values`` from ``front_dict``, into a folder as a table, as JSON and as a figure.

    Raises:
        InputError: a file cannot be written.
    """
    from matplotlib import rc_context

    from liftopt.studies.pareto_plot import pareto_figure
    from liftopt.viz.plots import rendered
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
        "points": [_row(front, point) for point in every],
        "missing_weights": [list(weights) for weights in front.missing],
    }


def _row(front: Front, point: Point) -> dict[str, Any]:
    """Return figures of a point, units in the names: of the two, then of everybody."""
    import numpy as np

    from liftopt.collocation.motion import objective_terms
    from liftopt.multibody.trajectory import limit_share
    from liftopt.solution.checks import FINER
    from liftopt.solution.effort import effort_in

    candidate, (one, other) = point.candidate, front.between
    duration = candidate.problem.task.duration
    times = np.linspace(0.0, duration, FINER * candidate.spline.intervals + 1)
    used = {agent.name: float(limit_share(agent).max()) for agent in candidate.at(times).agents}
    others = [name for name in used if name not in front.between]
    efforts = dict(zip(front.between, point.efforts, strict=True))
    if others:
        terms = objective_terms(candidate.problem, candidate.at(candidate.spline.phase * duration))
        efforts |= {name: terms[name] for name in others}
    everybody = (*front.between, *others)
    return {
        f"{one}_weight": point.weights[0],
        f"{other}_weight": point.weights[1],
        **{f"{name}_effort_{effort_in(front.scenario).key}": efforts[name] for name in everybody},
        f"{one}_load_share": point.share,
        **{f"{name}_largest_share_of_limit": used[name] for name in everybody},
        "objective": float(candidate.result.objective),
        "verified": 1,
        "dominated": int(point in front.dominated),
    }


def table(front: Front, values: dict[str, Any]) -> str:
    """Return the table that the command prints, of a front and what ``front_dict`` returned of it."""
    from liftopt.solution.effort import effort_in
    from liftopt.studies.pareto import ratio_text, who_of

    effort, (one, other) = effort_in(front.scenario), front.between
    everybody = (one, other, *(name for name in front.scenario.agents if name not in front.between))
    labels = {name: who_of(front, name).label for name in everybody}
    ratio, first = f"weights {labels[one]} : {labels[other]}", who_of(front, one).called
    left = max(22, len(ratio))
    wide, narrow = ({name: max(least, len(labels[name])) for name in everybody} for least in (10, 7))
    used = sum(narrow.values()) + len(narrow) - 1
    lines = [
        *wrap(
            f"Effort is the {effort.about}; load is {first}'s mean part of the object's weight, most used the largest "
            "part of a joint's torque limit.",
            112,
        ),
        *_traded(front),
        "",
        f"{ratio:>{left}} " + " ".join(f"{labels[name]:>{wide[name]}}" for name in everybody)
        + f" {'load':>6} {'most used':>{used}}",
        f"{'':>{left}} " + " ".join(f"{f'[{effort.unit}]':>{wide[name]}}" for name in everybody)
        + f" {'[%]':>6} " + " ".join(f"{labels[name]:>{narrow[name]}}" for name in everybody),
    ]  # fmt: skip
    for row in values["points"]:
        weights = ratio_text((row[f"{one}_weight"], row[f"{other}_weight"]))
        efforts = " ".join(
            f"{row[f'{name}_effort_{effort.key}']:{wide[name]}.{effort.decimals}f}" for name in everybody
        )
        most = [f"{100 * row[f'{name}_largest_share_of_limit']:.0f}%" for name in everybody]
        lines.append(
            f"{weights:>{left}} {efforts} {100 * row[f'{one}_load_share']:6.1f} "
            + " ".join(f"{text:>{narrow[name]}}" for name, text in zip(everybody, most, strict=True))
            + ("  beaten in both" if row["dominated"] else "")
        )
    for weights in values["missing_weights"]:
        lines.append(f"{ratio_text(tuple(weights)):>{left}}  has no verified solution")
    return "\n".join(lines) + "\n"


def _traded(front: Front) -> list[str]:
    """Return what is traded, where more than two lift."""
    kept = [f"{name} {agent.weight:g}" for name, agent in front.scenario.agents.items() if name not in front.between]
    if not kept:
        return []
    return [f"Traded: {front.between[0]} against {front.between[1]}; weights kept: {', '.join(kept)}."]
