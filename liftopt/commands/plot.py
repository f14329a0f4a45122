"""``liftopt plot``: the plots of a solved lift as files."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from liftopt.commands.terminal import printing
from liftopt.viz import FORMATS


def add_plot_parser(commands: Any) -> None:
    """Add the command to the subparsers ``commands``."""
    parser = commands.add_parser(
        "plot",
        help="write the plots of a solved lift as SVG, PNG and PDF",
        description="Write the plots of a solved lift, those of its report, to a folder.",
        allow_abbrev=False,
    )
    parser.add_argument("result", metavar="RESULT", help="a result folder, or its solution.nc")
    parser.add_argument("--out", metavar="DIR", required=True, help="folder for the plots")
    parser.add_argument(
        "--format",
        action="append",
        choices=FORMATS,
        dest="formats",
        help="may be repeated (default: all three)",
    )
    parser.set_defaults(run=printing(plot_text))


def plot_text(args: argparse.Namespace) -> str:
    """Do what the command line says and return what it prints.

    Raises:
        InputError: the result is wrong, or a plot cannot be written.
    """
    from liftopt.storage.reader import load_result

    solution = load_result(args.result)
    from liftopt.viz.plots import write_plots

    files = write_plots(solution, Path(args.out), args.formats or FORMATS)
    return f"Written to {args.out}: {len(files)} files\n"
