"""``liftopt solve``: one lift, from the scenario to the result and the verdicts on it."""

from __future__ import annotations

import argparse
import gc
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from liftopt.commands.exit_status import DONE, NOT_SOLVED
from liftopt.commands.terminal import progress_line, write, write_error
from liftopt.errors import InputError
from liftopt.scenario.file import shipped_scenarios
from liftopt.scenario.listing import DEFAULT_TEAM, describe
from liftopt.scenario.model import Scenario
from liftopt.storage.result_folder import in_the_way
from liftopt.storage.solved_scenario import scenario_or_solved

SCENARIO_HELP = """keys of a scenario, for --set, with what is allowed and the default. An agent is addressed by the
name that the scenario gives it, here human and robot; in a TOML file its keys stand in [agents.human] and
[agents.robot], and schema = 2 before all. table.* is object.*:
"""


def add_solve_parser(commands: Any) -> None:
    """Add the command to the subparsers ``commands``."""
    parser = commands.add_parser(
        "solve",
        help="find the motion, joint torques and grasp forces of one lift",
        description="Find the motion, joint torques and grasp forces of one lift; write them and sum them up.",
        epilog=_scenario_help(),
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument(
        "scenario",
        nargs="?",
        metavar="SCENARIO",
        help=f"a TOML file, a result folder, or one that is shipped: {', '.join(shipped_scenarios())} "
        "(default: table5)",
    )
    parser.add_argument("--out", metavar="DIR", help="folder for the result (default: results/<scenario name>)")
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        dest="overrides",
        metavar="KEY=VALUE",
        help="change one entry of the scenario, for example object.mass=3; may be repeated",
    )
    parser.add_argument("--json", action="store_true", help="print the summary as one JSON object")
    parser.add_argument(
        "--details", action="store_true", help="print all findings, and tables of joints, forces, starts and checks too"
    )
    parser.add_argument(
        "--refine",
        action="append_const",
        const="refine.on=true",
        dest="overrides",
        help="solve on finer and finer meshes until the scenario's tolerances in [refine] hold; takes seconds",
    )
    parser.set_defaults(run=solve)


def solve(args: argparse.Namespace) -> int:
    """Do what the command line says and return the exit status.

    Raises:
        LiftoptError: the scenario or an option is wrong, or the solver cannot run.
    """
    scenario = scenario_or_solved(args.scenario, args.overrides)
    out = Path("results", scenario.name) if args.out is None else Path(args.out)
    with _output_folder(out), progress_line() as progress:
        with _no_collection():
            from liftopt.search.solve import solve as solve_lift
            from liftopt.storage.writer import save

        solution = solve_lift(scenario, progress=progress)
        progress("writing the result")
        folder = save(solution, out)
    from liftopt.commands.solved_text import solved_text

    write(solved_text(solution, folder, as_json=args.json, details=args.details))
    if solution.solved:
        return DONE
    from liftopt.assessment.failure_text import failure_text

    write_error(f"liftopt: error: {failure_text(solution, out, folder)}")
    return NOT_SOLVED


def _scenario_help() -> str:
    lines = [f"  {key}\n      {what}" for key, what in describe(Scenario, DEFAULT_TEAM)]
    return SCENARIO_HELP + "\n".join(lines)


@contextmanager
def _output_folder(out: Path) -> Iterator[None]:
    """Make sure before a long solve that a result can be written; take back the folders made if there is none."""
    made: list[Path] = []
    try:
        _make_writable(out, made)
        yield
    finally:
        with suppress(OSError):  # not empty: there is a result
            for folder in reversed(made):
                folder.rmdir()


def _make_writable(out: Path, made: list[Path]) -> None:
    try:
        for folder in reversed((out, *out.parents)):
            if not folder.exists():
                folder.mkdir()
                made.append(folder)
        with tempfile.TemporaryFile(dir=out):
            pass
        blocked = in_the_way(out)
    except OSError as error:
        raise InputError("--out", str(out), f"cannot be written: {error.strerror or error}") from None
    if blocked is not None:
        raise InputError("--out", str(out), f"cannot be written: {blocked} is in the way")


@contextmanager
def _no_collection() -> Iterator[None]:
    """Search for no garbage while modules are imported, nor in them later: they stay until the end.

    That spares a fifth of the time of the imports and of leaving the interpreter.
    """
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        gc.enable()
