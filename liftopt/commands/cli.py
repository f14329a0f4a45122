"""The command line ``liftopt``; each command stands in the module of its name.

Exit status: 0 solved and verified (or all cross-checks passed), 2 bad input, 3 no verified solution, 130 interrupted.
Results go to stdout, progress and errors to stderr. Modules that load the solver are imported when they are needed, so
that help and bad input are answered at once.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from typing import Any

import liftopt
from liftopt.commands.calibrate import add_calibrate_parser
from liftopt.commands.compare import add_compare_parser
from liftopt.commands.crosscheck import add_crosscheck_parser
from liftopt.commands.dry_run import add_dry_run_parser
from liftopt.commands.exit_status import BAD_INPUT, NOT_SOLVED
from liftopt.commands.export import add_export_parser
from liftopt.commands.forces import add_forces_parser
from liftopt.commands.mocap import add_mocap_parser
from liftopt.commands.pareto import add_pareto_parser
from liftopt.commands.parser import Parser
from liftopt.commands.plot import add_plot_parser
from liftopt.commands.record import add_record_parser
from liftopt.commands.report import add_report_parser
from liftopt.commands.robots import add_robots_parser
from liftopt.commands.scenario import add_scenario_parser
from liftopt.commands.sensitivity import add_sensitivity_parser
from liftopt.commands.solve import add_solve_parser
from liftopt.commands.terminal import complain, write
from liftopt.commands.view import add_view_parser
from liftopt.errors import InputError, LiftoptError
from liftopt.files.interrupt import INTERRUPTED

# In the order of the help.
COMMANDS = (
    add_solve_parser,
    add_crosscheck_parser,
    add_view_parser,
    add_report_parser,
    add_plot_parser,
    add_sensitivity_parser,
    add_pareto_parser,
    add_mocap_parser,
    add_calibrate_parser,
    add_record_parser,
    add_forces_parser,
    add_export_parser,
    add_dry_run_parser,
    add_compare_parser,
    add_scenario_parser,
    add_robots_parser,
)


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return its exit status.

    Args:
        argv: arguments after the program's name; None takes those of the process.

    Raises:
        SystemExit: from argparse, with status 0, for ``--help`` and ``--version``.
    """
    words = sys.argv[1:] if argv is None else list(argv)
    try:
        args = _parser().parse_args(words)
        status: int = args.run(args)
    except KeyboardInterrupt:
        complain("interrupted")
        return INTERRUPTED
    except LiftoptError as error:
        status = BAD_INPUT if isinstance(error, InputError) else NOT_SOLVED
        if "--json" in words:
            write(json.dumps(_error_dict(error, status)) + "\n")
        complain(str(error))
    except OSError as error:  # a full disk, a folder taken away meanwhile: nothing of ours to debug
        complain(str(error))
        return BAD_INPUT
    return status


def _parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="liftopt",
        description="Predict how a person and a robot lift an object together.",
        allow_abbrev=False,
    )
    parser.add_argument("--version", action="version", version=f"liftopt {liftopt.__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for add in COMMANDS:
        add(commands)
    return parser


def _error_dict(error: LiftoptError, status: int) -> dict[str, Any]:
    details: dict[str, Any] = {"message": str(error)}
    if isinstance(error, InputError):
        details |= {"key": error.key, "allowed": error.allowed}
    return {"status": type(error).__name__, "solved": False, "exit_status": status, "error": details}
