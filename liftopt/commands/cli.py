"""The command line ``liftopt``; commands with options of their own stand in ``*_command`` modules.

Exit status: 0 solved and verified (or all cross-checks passed), 2 bad input, 3 no verified solution, 130 interrupted.
Results go to stdout, progress and errors to stderr. Modules that load the solver are imported when they are needed, so
that help and bad input are answered at once.
"""

from __future__ import annotations

import argparse
import gc
import json
import os
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import liftopt
from liftopt.commands.calibrate import add_calibrate_parser, calibrate_text
from liftopt.commands.compare import add_compare_parser, compare_text
from liftopt.commands.dry_run import add_dry_run_parser, dry_run_text
from liftopt.commands.export import add_export_parser, export_text
from liftopt.commands.forces import add_forces_parser, forces_text
from liftopt.commands.mocap import add_mocap_parser, mocap
from liftopt.commands.pareto import add_pareto_parser, pareto
from liftopt.commands.parser import Parser
from liftopt.commands.record import add_record_parser, record
from liftopt.commands.scenario import add_scenario_parser, scenario_text
from liftopt.commands.sensitivity import add_sensitivity_parser, sensitivity
from liftopt.errors import NO_VALUE, InputError, LiftoptError
from liftopt.files.interrupt import INTERRUPTED, interrupts
from liftopt.scenario.file import shipped_scenarios
from liftopt.scenario.model import load_scenario
from liftopt.storage.result_folder import in_the_way
from liftopt.storage.solved_scenario import scenario_or_solved
from liftopt.viz import FORMATS

SOLVED, BAD_INPUT, NOT_SOLVED = 0, 2, 3


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
        _complain("interrupted")
        return INTERRUPTED
    except LiftoptError as error:
        status = BAD_INPUT if isinstance(error, InputError) else NOT_SOLVED
        if "--json" in words:
            _write(json.dumps(_error_dict(error, status)) + "\n")
        _complain(str(error))
    except OSError as error:  # a full disk, a folder taken away meanwhile: nothing of ours to debug
        _complain(str(error))
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

    solve = commands.add_parser(
        "solve",
        help="find the motion, joint torques and grasp forces of one lift",
        description="Find the motion, joint torques and grasp forces of one lift; write them and sum them up.",
        epilog=_scenario_help(),
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    solve.add_argument(
        "scenario",
        nargs="?",
        metavar="SCENARIO",
        help=f"a TOML file, a result folder, or one that is shipped: {', '.join(shipped_scenarios())} "
        "(default: table5)",
    )
    solve.add_argument("--out", metavar="DIR", help="folder for the result (default: results/<scenario name>)")
    solve.add_argument(
        "--set",
        action="append",
        default=[],
        dest="overrides",
        metavar="KEY=VALUE",
        help="change one entry of the scenario, for example object.mass=3; may be repeated",
    )
    solve.add_argument("--json", action="store_true", help="print the summary as one JSON object")
    solve.add_argument(
        "--details", action="store_true", help="print all findings, and tables of joints, forces, starts and checks too"
    )
    solve.add_argument(
        "--refine",
        action="append_const",
        const="refine.on=true",
        dest="overrides",
        help="solve on finer and finer meshes until the scenario's tolerances in [refine] hold; takes seconds",
    )
    solve.set_defaults(run=_solve)

    crosscheck = commands.add_parser(
        "crosscheck",
        help="check the dynamics, or a solved lift, by independent means",
        description="Without RESULT, compare the paper's DH recursion with Pinocchio on random states of the human and "
        "the robot. With one, put the solved motion to MuJoCo's inverse and forward dynamics and the energy balance.",
        allow_abbrev=False,
    )
    crosscheck.add_argument("result", nargs="?", metavar="RESULT", help="a result folder, or its solution.nc")
    crosscheck.add_argument(
        "--transcription",
        action="store_true",
        help="solve RESULT again by this and a second transcription on 10 to 160 intervals; takes minutes",
    )
    crosscheck.add_argument(
        "--samples", type=int, default=1000, metavar="N", help="random states of each (default: %(default)s)"
    )
    crosscheck.set_defaults(run=_crosscheck)
    view = commands.add_parser(
        "view",
        help="play a solved lift in the browser",
        description="Play a solved lift in the browser until Ctrl-C, or write the playback to a file.",
        allow_abbrev=False,
    )
    view.add_argument("result", metavar="RESULT", help="the folder that solve wrote, or its solution.nc")
    view.add_argument("--with", dest="other", metavar="OTHER", help="a second result, shown beside the first")
    view.add_argument("--ghost", action="store_true", help="show the second one see-through in the first one's place")
    view.add_argument("--html", metavar="FILE", help="write one self-contained page instead of opening the browser")
    view.add_argument(
        "--sawyer", metavar="DIR", help="the manufacturer's sawyer_description folder: draw the robot with its meshes"
    )
    view.add_argument("--port", type=int, default=7000, metavar="N", help="first port to try (default: %(default)s)")
    view.add_argument("--no-browser", action="store_false", dest="browser", help="serve the page, open no browser")
    view.set_defaults(run=_view)

    report = commands.add_parser(
        "report",
        help="write one page that holds all there is to know of a solved lift",
        description="Write a self-contained HTML page: playback, plots, tables, ergonomics, verification, warnings.",
        allow_abbrev=False,
    )
    report.add_argument("result", metavar="RESULT", help="a result folder, or its solution.nc")
    report.add_argument("--html", metavar="FILE", required=True, help="the page to write")
    report.set_defaults(run=_report)

    plot = commands.add_parser(
        "plot",
        help="write the plots of a solved lift as SVG, PNG and PDF",
        description="Write the plots of a solved lift, those of its report, to a folder.",
        allow_abbrev=False,
    )
    plot.add_argument("result", metavar="RESULT", help="a result folder, or its solution.nc")
    plot.add_argument("--out", metavar="DIR", required=True, help="folder for the plots")
    plot.add_argument(
        "--format",
        action="append",
        choices=FORMATS,
        dest="formats",
        help="may be repeated (default: all three)",
    )
    plot.set_defaults(run=_plot)
    add_sensitivity_parser(commands, _telling(sensitivity))
    add_pareto_parser(commands, _telling(pareto))
    add_mocap_parser(commands, _printing(mocap))
    add_calibrate_parser(commands, _printing(calibrate_text))
    add_record_parser(commands, _record)
    add_forces_parser(commands, _printing(forces_text))
    add_export_parser(commands, _printing(export_text))
    add_dry_run_parser(commands, _telling(dry_run_text))
    add_compare_parser(commands, _printing(compare_text))
    add_scenario_parser(commands, _printing(scenario_text))
    return parser


def _solve(args: argparse.Namespace) -> int:
    scenario = scenario_or_solved(args.scenario, args.overrides)
    out = Path("results", scenario.name) if args.out is None else Path(args.out)
    with _output_folder(out), _progress() as progress:
        with _no_collection():
            from liftopt.search.solve import solve
            from liftopt.storage.writer import save

        solution = solve(scenario, progress=progress)
        progress("writing the result")
        folder = save(solution, out)
    from liftopt.commands.solved_text import solved_text

    _write(solved_text(solution, folder, as_json=args.json, details=args.details))
    if solution.solved:
        return SOLVED
    from liftopt.assessment.failure_text import failure_text

    _say_on_stderr(f"liftopt: error: {failure_text(solution, out, folder)}")
    return NOT_SOLVED


def _report(args: argparse.Namespace) -> int:
    from liftopt.storage.reader import load_result

    solution = load_result(args.result)
    from liftopt.viz.report import write_report

    write_report(solution, Path(args.html))
    _write(f"Written to {args.html}\n")
    return SOLVED


def _plot(args: argparse.Namespace) -> int:
    from liftopt.storage.reader import load_result

    solution = load_result(args.result)
    from liftopt.viz.plots import write_plots

    files = write_plots(solution, Path(args.out), args.formats or FORMATS)
    _write(f"Written to {args.out}: {len(files)} files\n")
    return SOLVED


def _printing(job: Callable[[argparse.Namespace], str]) -> Callable[[argparse.Namespace], int]:
    """Return the command that prints what a job returns."""

    def run(args: argparse.Namespace) -> int:
        _write(job(args))
        return SOLVED

    return run


def _telling(job: Callable[[argparse.Namespace, Any], str]) -> Callable[[argparse.Namespace], int]:
    """Return the command that prints what a long job returns, and meanwhile where it is."""

    def run(args: argparse.Namespace) -> int:
        with _progress() as progress:
            text = job(args, progress)
        _write(text)
        return SOLVED

    return run


def _record(args: argparse.Namespace) -> int:
    record(args, progress=lambda line: _write(line + "\n"))
    return SOLVED


def _crosscheck(args: argparse.Namespace) -> int:
    if args.result is not None:
        from liftopt.crosscheck.motion_report import result_report
        from liftopt.storage.reader import load_result

        with _progress() as progress:
            text, passed = result_report(load_result(args.result), args.transcription, progress)
        _write(text + "\n")
        return SOLVED if passed else NOT_SOLVED
    if args.transcription:
        raise InputError("--transcription", NO_VALUE, "needs a RESULT to start from")
    from liftopt.crosscheck.report import crosscheck_report, render

    report = crosscheck_report(samples=args.samples, seed=0)
    _write(render(report).rstrip("\n") + "\n")
    return SOLVED if report.passed else NOT_SOLVED


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
def _progress() -> Iterator[Callable[[str], None]]:
    """Give a function that shows where the solve is, on a terminal, and ends it there if an interrupt was lost."""
    with interrupts() as found:
        if not sys.stderr.isatty():
            yield lambda message: found.check()
            return
        from rich.console import Console
        from rich.markup import escape

        def show(message: str) -> None:
            found.check()
            line.update(escape(message))

        with Console(stderr=True).status("loading the solver") as line:
            yield show


def _view(args: argparse.Namespace) -> int:
    from liftopt.viz.viewer import view

    view(
        args.result,
        other=args.other,
        ghost=args.ghost,
        html=args.html,
        sawyer=args.sawyer,
        port=args.port,
        browser=args.browser,
        progress=lambda line: _write(line + "\n"),
    )
    return SOLVED


def _scenario_help() -> str:
    lines = [f"  {key}\n      {what}" for key, what in load_scenario().describe()]
    return "keys of a scenario, for a TOML file and for --set:\n" + "\n".join(lines)


def _error_dict(error: LiftoptError, status: int) -> dict[str, Any]:
    details: dict[str, Any] = {"message": str(error)}
    if isinstance(error, InputError):
        details |= {"key": error.key, "allowed": error.allowed}
    return {"status": type(error).__name__, "solved": False, "exit_status": status, "error": details}


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


def _complain(message: str) -> None:
    _say_on_stderr(f"liftopt: error: {' '.join(message.split())}\n")


def _say_on_stderr(text: str) -> None:
    encoding = sys.stderr.encoding or "utf-8"
    sys.stderr.write(text.encode(encoding, "replace").decode(encoding))
    sys.stderr.flush()


def _write(text: str) -> None:
    encoding = sys.stdout.encoding or "utf-8"
    try:
        sys.stdout.write(text.encode(encoding, "replace").decode(encoding))
        sys.stdout.flush()
    except BrokenPipeError:  # the reader has seen enough; keep the interpreter from trying again on its way out
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
