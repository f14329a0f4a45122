"""``liftopt report``: one page that holds all there is to know of a solved lift."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from liftopt.commands.meshes import add_meshes
from liftopt.commands.terminal import printing


def add_report_parser(commands: Any) -> None:
    """Add the command to the subparsers ``commands``."""
    parser = commands.add_parser(
        "report",
        help="write one page that holds all there is to know of a solved lift",
        description="Write a self-contained HTML page: playback, plots, tables, ergonomics, verification, warnings.",
        allow_abbrev=False,
    )
    parser.add_argument("result", metavar="RESULT", help="a result folder, or its solution.nc")
    parser.add_argument("--html", metavar="FILE", required=True, help="the page to write")
    add_meshes(parser)
    parser.set_defaults(run=printing(report_text))


def report_text(args: argparse.Namespace) -> str:
    """Do what the command line says and return what it prints.

    Raises:
        InputError: the result is wrong, or the page cannot be written.
    """
    from liftopt.storage.reader import load_result

    solution = load_result(args.result)
    from liftopt.viz.report import write_report

    write_report(solution, Path(args.html), meshes=args.meshes)
    return f"Written to {args.html}\n"
