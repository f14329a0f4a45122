"""``liftopt crosscheck``: the dynamics, or a solved lift, by independent means."""

from __future__ import annotations

import argparse
from typing import Any

from liftopt.commands.exit_status import DONE, NOT_SOLVED
from liftopt.commands.terminal import progress_line, write
from liftopt.errors import NO_VALUE, InputError


def add_crosscheck_parser(commands: Any) -> None:
    """Add the command to the subparsers ``commands``."""
    parser = commands.add_parser(
        "crosscheck",
        help="check the dynamics, or a solved lift, by independent means",
        description="Without RESULT, compare the paper's DH recursion with Pinocchio on random states of the human and "
        "Sawyer. With one, of any robot, put the solved motion to MuJoCo's inverse and forward dynamics and the energy "
        "balance.",
        allow_abbrev=False,
    )
    parser.add_argument("result", nargs="?", metavar="RESULT", help="a result folder, or its solution.nc")
    parser.add_argument(
        "--transcription",
        action="store_true",
        help="solve RESULT again by this and a second transcription on 10 to 160 intervals; takes minutes",
    )
    parser.add_argument(
        "--samples", type=int, default=1000, metavar="N", help="random states of each (default: %(default)s)"
    )
    parser.set_defaults(run=crosscheck)


def crosscheck(args: argparse.Namespace) -> int:
    """Do what the command line says and return the exit status.

    Raises:
        InputError: the result or an option is wrong, or MuJoCo is missing.
    """
    if args.result is not None:
        return _of_result(args)
    if args.transcription:
        raise InputError("--transcription", NO_VALUE, "needs a RESULT to start from")
    from liftopt.crosscheck.report import crosscheck_report, render

    report = crosscheck_report(samples=args.samples, seed=0)
    write(render(report).rstrip("\n") + "\n")
    return DONE if report.passed else NOT_SOLVED


def _of_result(args: argparse.Namespace) -> int:
    from liftopt.crosscheck.motion_report import result_report
    from liftopt.storage.reader import load_result

    with progress_line() as progress:
        text, passed = result_report(load_result(args.result), args.transcription, progress)
    write(text + "\n")
    return DONE if passed else NOT_SOLVED
