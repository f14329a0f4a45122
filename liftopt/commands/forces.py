"""``liftopt forces``: a recording of force sensors becomes the force of the hand."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from liftopt.commands.record import add_divider_arguments, add_unloaded_argument, calibration_of, unloaded_of
from liftopt.commands.terminal import printing


def add_forces_parser(commands: Any) -> None:
    """Add the command to the subparsers ``commands``."""
    parser = commands.add_parser(
        "forces",
        help="the hand's force from a recording of force sensors",
        description="Turn the voltages of a recording into newtons, subtract the preload, and add the fingers minus "
        "the thumb up to the hand's force. The recording is never changed.",
        allow_abbrev=False,
    )
    parser.add_argument("recording", metavar="FILE", help="CSV of liftopt record, or with the columns it has")
    parser.add_argument("--calibration", metavar="CAL", help="of the sensors, where FILE holds voltages")
    parser.add_argument("--out", metavar="FILE", help="CSV in newtons to write; it must not exist")
    add_unloaded_argument(parser)
    add_divider_arguments(parser)
    parser.set_defaults(run=printing(forces_text))


def forces_text(args: argparse.Namespace) -> str:
    """Do what the command line says and return what it prints.

    Raises:
        InputError: a file or an option is wrong.
    """
    import numpy as np

    from liftopt.lab.forces.force_file import read_forces, write_forces

    unloaded = unloaded_of(args)
    trials = read_forces(Path(args.recording), calibration_of(args), unloaded)
    lines = []
    for one in trials:
        hand = one.hand_force
        if np.isfinite(hand).any():
            peak = int(np.nanargmax(hand))
            shown = f"hand {np.nanmean(hand):.2f} N on average, at most {hand[peak]:.2f} N at {one.time[peak]:.2f} s"
        else:
            shown = "no complete sample"
        lines.append(f"Trial {one.trial}: {one.time[-1] - one.time[0]:.2f} s, {shown}")
        lines += [f"  {note}" for note in one.notes]
    if args.out is not None:
        write_forces(trials, Path(args.out))
        lines.append(f"Written to {args.out}")
    return "\n".join(lines) + "\n"
