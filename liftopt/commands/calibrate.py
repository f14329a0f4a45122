"""``liftopt calibrate``: voltage-weight series of force sensors become their calibration."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from liftopt.commands.record import add_divider_arguments, divider_of
from liftopt.commands.terminal import printing


def add_calibrate_parser(commands: Any) -> None:
    """Add the command to the subparsers ``commands``."""
    parser = commands.add_parser(
        "calibrate",
        help="make a calibration of force sensors from voltage-weight series",
        description="Fit a monotone spline through the mean of repeated series. Each CSV has the columns "
        "voltage [V, mV or counts] and weight [g, kg or N]; a column series tells several in one file apart, a column "
        "channel says which sensor was loaded (otherwise the curve is for all).",
        allow_abbrev=False,
    )
    parser.add_argument("series", nargs="+", metavar="SERIES", help="CSV with one series or more")
    parser.add_argument("--out", required=True, metavar="CAL", help="calibration to write (TOML); it must not exist")
    add_divider_arguments(parser)
    parser.set_defaults(run=printing(calibrate_text))


def calibrate_text(args: argparse.Namespace) -> str:
    """Do what the command line says and return what it prints.

    Raises:
        InputError: a series or an option is wrong, or the calibration cannot be written.
    """
    from liftopt.lab.forces.calibration import calibrate, save_calibration

    fit = calibrate([Path(path) for path in args.series], divider_of(args))
    save_calibration(fit.calibration, Path(args.out))
    lines = []
    for name, curve in fit.calibration.curves.items():
        lines.append(
            f"{name}: {fit.series[name]} series, {curve.force[0]:.3g} to {curve.force[-1]:.3g} N, "
            f"{curve.voltage[0]:.3g} to {curve.voltage[-1]:.3g} V; "
            f"readings within {fit.residual_max[name]:.3g} N of the curve ({fit.residual_rms[name]:.3g} N rms)"
        )
    return "\n".join([*lines, *(f"Note: {note}" for note in fit.notes), f"Written to {args.out}"]) + "\n"
