"""The option by which a robot from a file is drawn with its own meshes."""

from __future__ import annotations

import argparse


def add_meshes(parser: argparse.ArgumentParser) -> None:
    """Add ``--meshes`` to the parser of a command that draws a lift."""
    parser.add_argument(
        "--meshes",
        nargs="?",
        const=True,
        default=False,
        metavar="PATH",
        help="draw robots from a file with their own meshes: of the URDF that the scenario names, or of this one, a "
        "file or the folder that it is in; robots known by name are drawn with theirs anyhow",
    )
