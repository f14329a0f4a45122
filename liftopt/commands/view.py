"""``liftopt view``: a solved lift in the browser, or its playback as a page."""

from __future__ import annotations

import argparse
from typing import Any

from liftopt.commands.exit_status import DONE
from liftopt.commands.meshes import add_meshes
from liftopt.commands.terminal import write


def add_view_parser(commands: Any) -> None:
    """Add the command to the subparsers ``commands``."""
    parser = commands.add_parser(
        "view",
        help="play a solved lift in the browser",
        description="Play a solved lift in the browser until Ctrl-C, or write the playback to a file.",
        allow_abbrev=False,
    )
    parser.add_argument("result", metavar="RESULT", help="the folder that solve wrote, or its solution.nc")
    parser.add_argument("--with", dest="other", metavar="OTHER", help="a second result, shown beside the first")
    parser.add_argument("--ghost", action="store_true", help="show the second one see-through in the first one's place")
    parser.add_argument("--html", metavar="FILE", help="write one self-contained page instead of opening the browser")
    parser.add_argument(
        "--sawyer", metavar="DIR", help="the manufacturer's sawyer_description folder: draw the robot with its meshes"
    )
    add_meshes(parser)
    parser.add_argument("--port", type=int, default=7000, metavar="N", help="first port to try (default: %(default)s)")
    parser.add_argument("--no-browser", action="store_false", dest="browser", help="serve the page, open no browser")
    parser.set_defaults(run=view)


def view(args: argparse.Namespace) -> int:
    """Do what the command line says and return the exit status.

    Raises:
        InputError: a result or an option is wrong, or the page cannot be written.
    """
    from liftopt.viz.viewer import view

    view(
        args.result,
        other=args.other,
        ghost=args.ghost,
        html=args.html,
        sawyer=args.sawyer,
        meshes=args.meshes,
        port=args.port,
        browser=args.browser,
        progress=lambda line: write(line + "\n"),
    )
    return DONE
