"""Measure liftopt against its goals and against others: a table, a file, a plot. See ``--help``."""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console

if TYPE_CHECKING:
    from benchmarks.goals import Row


PARTS = {
    "ipopt": "IPOPT, one solve from a given start",
    "ipopt_warm": "IPOPT, warm re-solves",
    "banded": "banded, one solve from a given start",
    "banded_warm": "banded, 100 warm re-solves",
    "lift": "a whole lift in process",
    "process": "`liftopt solve`, time and memory",
    "varied": "60 varied scenarios with the banded solver",
    "scaling": "time against N, with its plot",
    "many_starts": "64 starts on 2 processes",
    "objective": "J of 40 varied scenarios against before",
    "virtual_machine": "the same NLP in CasADi's virtual machine",
    "snopt": "SNOPT at the paper's size and on the same NLP (needs drake)",
    "moco": "the same lift in OpenSim Moco (needs opensim)",
    "floor": "Pinocchio's computeRNEADerivatives",
    "profile": "where each millisecond goes",
}
# Read when NumPy is imported, which nothing is before they are set: with more threads times say little.
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
QUICK = ("ipopt", "ipopt_warm", "banded", "banded_warm", "lift", "process", "floor")


def main(words: list[str] | None = None) -> int:
    """Run what is asked for; return 0, or 1 where a part failed."""
    os.environ.update(dict.fromkeys(THREADS, "1"))
    options = _parser().parse_args(words)
    wanted = options.only or (QUICK if options.quick else tuple(PARTS))
    wanted = [part for part in wanted if part not in options.skip]
    from benchmarks import report

    console = Console(width=None if sys.stdout.isatty() else 200)
    rows: dict[str, Row] = {}
    stages: dict[str, dict[str, float]] = {}
    jobs, failed = _jobs(options, rows, stages), False
    for part in wanted:
        console.print(f"[dim]{PARTS[part]} ...[/]")
        try:
            jobs[part]()
        except Exception as error:
            # One part that fails must not take the others' hours of measuring with it.
            console.print(f"[red]{part} failed: {type(error).__name__}: {error}[/]", markup=True)
            failed = True
    run = report.record(rows, stages, " ".join(words if words is not None else sys.argv[1:]))
    report.show(run, console)
    out = Path(options.out)
    report.write(run, out / "benchmark.json")
    console.print(f"written: {out / 'benchmark.json'}")
    if "scaling" in rows:
        from benchmarks.plot import plot_scaling

        plot_scaling(rows["scaling"].details, out / "time_against_N.svg")
        console.print(f"written: {out / 'time_against_N.svg'}")
    if options.compare:
        report.compare(json.loads(Path(options.compare).read_text(encoding="utf-8")), run, console)
    return int(failed)


def _jobs(
    options: argparse.Namespace, rows: dict[str, Row], stages: dict[str, dict[str, float]]
) -> dict[str, Callable[[], None]]:
    """Return what measures each part; every one adds to ``rows`` or ``stages``."""
    from benchmarks import moco, rivals, solves, varied, whole
    from benchmarks.case import Case
    from benchmarks.scenarios import table5_paper
    from benchmarks.stages import profile

    quick, repeats = options.quick, 3 if options.quick else 10
    case = Case.of(table5_paper().scenario(), table5_paper().ends)

    def add(*keys: str) -> Callable[[Row | tuple[Row, ...]], None]:
        def keep(found: Row | tuple[Row, ...]) -> None:
            rows.update(zip(keys, found if isinstance(found, tuple) else (found,), strict=True))

        return keep

    few = min(repeats, 3)
    count = 6 if quick else None
    return {
        "ipopt": lambda: add("ipopt")(solves.cold("ipopt", case, repeats)),
        "ipopt_warm": lambda: add("ipopt_warm")(solves.warm_named(case, repeats)),
        "banded": lambda: add("banded")(solves.cold("banded", case, repeats)),
        "banded_warm": lambda: add("banded_warm")(solves.warm_mixes(case, 20 if quick else solves.MIXES)),
        "lift": lambda: add("lift")(whole.in_process("banded", 8, repeats)),
        "process": lambda: add("process", "memory")(whole.fresh_process(repeats)),
        "varied": lambda: add("first_try", "fallback")(varied.first_try(count)),
        "scaling": lambda: add("scaling")(solves.scaling(repeats)),
        "many_starts": lambda: add("many_starts")(whole.many_starts(few)),
        "objective": lambda: add("objective")(varied.objectives(options.objective_with, count)),
        "virtual_machine": lambda: add("virtual_machine")(rivals.virtual_machine(few)),
        "snopt": lambda: add("snopt_zero", "snopt_small", "snopt")(rivals.through_snopt(options.rival_seconds)),
        "moco": lambda: add("moco", "moco_naive", "moco_fine")(moco.measure(case, options.rival_seconds)),
        "floor": lambda: add("floor")(rivals.floor(case, repeats)),
        "profile": lambda: stages.update(profile(case, repeats)),
    }


def _parser() -> argparse.ArgumentParser:
    listed = "\n".join(f"  {name:16} {what}" for name, what in PARTS.items())
    parser = argparse.ArgumentParser(
        description="Measure liftopt against its goals, and others on the same problem.",
        epilog=f"parts:\n{listed}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--quick", action="store_true", help=f"3 repeats instead of 10, and only {', '.join(QUICK)}")
    parser.add_argument("--only", nargs="+", choices=PARTS, metavar="PART", help="only these parts")
    parser.add_argument("--skip", nargs="+", choices=PARTS, default=(), metavar="PART", help="not these parts")
    parser.add_argument("--out", default="results/benchmark", help="folder for benchmark.json and the plot")
    parser.add_argument("--compare", metavar="OLD.json", help="say what changed since another run's benchmark.json")
    parser.add_argument(
        "--rival-seconds", type=float, default=600.0, help="most for one solve: processor time of SNOPT, wall of Moco"
    )
    parser.add_argument("--objective-with", choices=("ipopt", "banded"), default="ipopt",
                        help="solver whose best of eight starts is compared with before")  # fmt: skip
    return parser


if __name__ == "__main__":
    sys.exit(main())
