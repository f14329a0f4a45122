"""Solve scenarios again and again: is the answer the same, bit by bit, whatever else the machine does?

Runs over the same scenarios, solvable and not: alone, beside six busy processes, with 1, 2 and 4 workers, and with the
vectors of other processors (AVX-512, AVX2, none beyond the baseline). The first six must agree in every bit; of the
kinds of vectors, which round differently, the verdict and the objective are compared. Prints a table in Markdown.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from sample_scenarios import drawn

from liftopt.errors import InputError

# Beside those drawn, which mostly have a solution: too far, too high, too heavy, too weak, too fast, hardly feasible.
HARD = (
    ("task.standing_distance=2.3",),
    ("task.standing_distance=3.5",),
    ("task.end.height=2.1",),
    ("object.mass=40",),
    ("object.mass=25",),
    ("limits.max_grasp_force=5",),
    ("limits.max_grasp_force=8", "duration=8"),
    ("duration=0.28", "object.mass=10"),
    ("duration=0.4", "object.mass=22"),
    ("duration=0.3", "object.mass=6"),
)
SEED, BUSY = 11, 6
SAME = 1e-6  # relative difference of the objective with other vectors
# The compiler's options for the kernels, the solver's own operations, and what makes the libraries take older code too.
SIMD: dict[str, tuple[tuple[str, ...], str, dict[str, str]]] = {
    "avx512": (("avx", "avx2", "fma", "avx512f", "avx512dq", "avx512vl"), "avx512", {}),
    "avx2": (
        ("avx", "avx2", "fma"),
        "avx2",
        {"OPENBLAS_CORETYPE": "Haswell", "NPY_DISABLE_CPU_FEATURES": "X86_V4 AVX512_ICL AVX512_SPR"},
    ),
    "plain": (
        (),
        "portable",
        {
            "OPENBLAS_CORETYPE": "Nehalem",
            "NPY_DISABLE_CPU_FEATURES": "X86_V3 X86_V4 AVX512_ICL AVX512_SPR",
            "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX512F,-AVX512DQ,-AVX512VL,-AVX2,-FMA,-AVX",
        },
    ),
}


@dataclass(frozen=True)
class Mode:
    """How the scenarios are solved in one run."""

    name: str
    workers: int = 2
    busy: int = 0
    simd: str = ""
    environment: dict[str, str] = field(default_factory=dict)


def modes() -> list[Mode]:
    """Return all runs, the one that the others are compared with first."""
    found = [Mode("alone"), Mode(f"beside {BUSY} busy processes", busy=BUSY)]
    found += [Mode(f"{n} workers" if n > 1 else "1 worker", workers=n) for n in (1, 2, 4)]
    alone = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
    found.append(Mode("one thread of BLAS", environment=alone))
    return found + [Mode(f"vectors: {kind}", simd=kind, environment=parts[2]) for kind, parts in SIMD.items()]


def scenarios(count: int) -> list[list[str]]:
    """Return overrides of ``count`` scenarios that are accepted, a third of them hard."""
    hard = min(len(HARD), count // 3)
    found = [overrides for overrides in drawn(2 * count, SEED) if is_accepted(overrides)][: count - hard]
    return [*found, *(list(overrides) for overrides in HARD[:hard])]


def is_accepted(overrides: list[str]) -> bool:
    """Whether a scenario is one."""
    from liftopt.scenario.model import load_scenario

    try:
        load_scenario("table5", overrides)
    except InputError:
        return False
    return True


def choose_vectors(kind: str, unoptimised: bool) -> bool:
    """Let kernels and solver of this process use one kind of vectors; return whether the processor has them.

    Args:
        kind: of ``SIMD``.
        unoptimised: compile the kernels at -O0, which rounds alike.
    """
    import _liftopt_banded

    from liftopt.collocation.codegen import simd_kernels as lanes

    extensions, operations, _ = SIMD[kind]
    lanes.EXTENSIONS = extensions
    if unoptimised:
        lanes.FLAGS = ("-O0", *(flag for flag in lanes.FLAGS if flag != "-O2"))
    return bool(_liftopt_banded.choose_instructions(operations)) and len(lanes._extensions()) == len(extensions)


def answer(overrides: Sequence[str], cache: Any) -> dict[str, Any]:
    """Solve one scenario and return what is compared."""
    from liftopt.scenario.model import load_scenario
    from liftopt.search.solve import solve
    from liftopt.solution.solution import CUT_SHORT

    began, used = time.monotonic(), time.process_time()
    solution = solve(load_scenario("table5", list(overrides)), cache=cache)
    digest = hashlib.sha256()
    for agent in solution.agents:
        for numbers in (agent.q, agent.v, agent.a, agent.tau, agent.grasp_force, agent.grasp_moment):
            digest.update(np.ascontiguousarray(numbers).tobytes())
    told = [solution.status, solution.notes, solution.kept_start, solution.accuracy]
    told += [solution.reasons, solution.suggested_changes]
    told += [(s.name, s.status, s.objective, s.iterations) for s in solution.starts]
    digest.update(repr(told).encode())
    return {
        "overrides": list(overrides),
        "verdict": solution.status.partition(":")[0].partition(" (")[0],
        "objective": solution.objective,
        "kept": solution.kept_start,
        "intervals": solution.intervals,
        "digest": digest.hexdigest(),
        "cut": any(CUT_SHORT in note for note in solution.notes),
        "seconds": time.monotonic() - began,
        "cpu_seconds": time.process_time() - used,
    }


def child(args: argparse.Namespace) -> int:
    """Solve all scenarios in this process, one line of JSON each."""
    from liftopt.search.cache import SolverCache

    if args.simd and not choose_vectors(args.simd, args.unoptimised):
        return 0
    cache = SolverCache()
    for overrides in scenarios(args.count):
        found = answer([*overrides, f"solver.workers={args.workers}", *args.overrides], cache)
        print(json.dumps(found), flush=True)
    return 0


@contextmanager
def busy(count: int) -> Iterator[None]:
    """Keep so many processes busy meanwhile."""
    code = "import os\nparent = os.getppid()\nwhile os.getppid() == parent:\n    sum(range(10**6))"
    processes = [subprocess.Popen([sys.executable, "-c", code]) for _ in range(count)]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait()


def run(mode: Mode, args: argparse.Namespace) -> list[dict[str, Any]]:
    """Return the answers of one run; none where this processor does not have its vectors."""
    command = [sys.executable, __file__, "--child", "--count", str(args.count), "--workers", str(mode.workers)]
    command += ["--simd", mode.simd] if mode.simd else []
    command += ["--unoptimised"] if args.unoptimised else []
    command += [word for overrides in args.overrides for word in ("--set", overrides)]
    with busy(mode.busy), tempfile.TemporaryFile("w+") as lines:
        subprocess.run(command, stdout=lines, env=os.environ | mode.environment, check=True)
        lines.seek(0)
        return [json.loads(line) for line in lines]


def agrees(one: dict[str, Any], other: dict[str, Any], mode: Mode) -> bool:
    """Whether an answer is that of the first run: in every bit, or with other vectors in verdict and objective."""
    if not mode.simd:
        return bool(one["digest"] == other["digest"])
    solved = one["verdict"] == "solved"
    near = abs(one["objective"] - other["objective"]) <= SAME * abs(one["objective"])
    return bool(one["verdict"] == other["verdict"] and (near or not solved))


def row(mode: Mode, found: list[dict[str, Any]], first: list[dict[str, Any]]) -> tuple[str, int]:
    """Return a line of the table, and how many answers differ."""
    if not found:
        return f"| {mode.name} | this processor has none | | | |", 0
    differ = [n for n, pair in enumerate(zip(found, first, strict=True)) if not agrees(*pair, mode)]
    seconds, cut = [entry["seconds"] for entry in found], sum(entry["cut"] for entry in found)
    which = f" (not {', '.join(map(str, differ))})" if differ else ""
    line = f"| {mode.name} | {len(found) - len(differ)} of {len(found)}{which} | {cut} "
    return f"{line}| {np.median(seconds):.1f} | {np.max(seconds):.1f} |", len(differ)


def explained(found: dict[str, list[dict[str, Any]]]) -> Iterator[str]:
    """Yield a line for every scenario that the runs do not agree about."""
    first = next(iter(found.values()))
    by_name = {mode.name: mode for mode in modes()}
    for n, one in enumerate(first):
        for name, entries in found.items():
            if entries and not agrees(entries[n], one, by_name[name]):
                yield (
                    f"- {n}, {name}: "
                    + "; ".join(
                        f"{e['verdict']}, J = {e['objective']:.9g} from {e['kept']} (N = {e['intervals']})"
                        for e in (one, entries[n])
                    )
                    + f"; {' '.join(one['overrides'])}"
                )


def main(words: Sequence[str] | None = None) -> int:
    """Run what is asked for and print the table; the exit status is 1 where bits differ that must not."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=30, help="scenarios")
    parser.add_argument("--only", nargs="*", default=[], metavar="WORD", help="runs whose names hold one of these")
    parser.add_argument("--set", action="append", default=[], dest="overrides", metavar="KEY=VALUE")
    parser.add_argument("--out", type=Path, help="all answers, as JSON")
    parser.add_argument(
        "--unoptimised",
        action="store_true",
        help="compile kernels of other vectors fast, to run slower and round alike",
    )
    parser.add_argument("--child", action="store_true", help=argparse.SUPPRESS)
    parser.add_argument("--workers", type=int, default=2, help=argparse.SUPPRESS)
    parser.add_argument("--simd", choices=SIMD, help=argparse.SUPPRESS)
    args = parser.parse_args(words)
    if args.child:
        return child(args)
    chosen = [m for n, m in enumerate(modes()) if n == 0 or not args.only or any(w in m.name for w in args.only)]
    print("| run | the same | cut short by time | median [s] | most [s] |\n|---|---|---|---|---|")
    found: dict[str, list[dict[str, Any]]] = {}
    wrong = 0
    for mode in chosen:
        found[mode.name] = run(mode, args)
        line, differ = row(mode, found[mode.name], found[chosen[0].name])
        wrong += 0 if mode.simd else differ
        print(line, flush=True)
    print(*explained(found), sep="\n")
    if args.out:
        args.out.write_text(json.dumps(found, indent=1), encoding="utf-8")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
