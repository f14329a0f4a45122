"""Whole lifts: in a process that is up, in a fresh one, and many starts on two processes."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from benchmarks.case import measure, repeat
from benchmarks.goals import Row
from benchmarks.scenarios import table5_paper
from liftopt.search.cache import SolverCache
from liftopt.search.solve import solve
from liftopt.solution.solution import Solution

MANY = 64
# Runs a command and prints its wall time [s], processor time [s], peak memory [kB] and exit status. A small process of
# its own does it: the peak memory of a child counts what its parent held when it was forked.
LAUNCHER = """
import os, sys, time
began = time.perf_counter()
pid = os.posix_spawn(sys.argv[1], sys.argv[1:], os.environ, file_actions=[
    (os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0), (os.POSIX_SPAWN_OPEN, 2, os.devnull, os.O_WRONLY, 0)])
_, status, usage = os.wait4(pid, 0)
print(time.perf_counter() - began, usage.ru_utime + usage.ru_stime, usage.ru_maxrss, status)
"""


def in_process(name: str, starts: int, repeats: int) -> Row:
    """Time a lift, verified, in a process that has lifted before and keeps its solvers."""
    overrides, cache = [f"solver.name={name}", f"solver.starts={starts}"], SolverCache()
    scenario = table5_paper().scenario(*overrides, "solver.tries=0", "solver.workers=1")
    timing, solution = repeat(repeats, solve, scenario, cache=cache)
    alone, _ = measure(1, solve, scenario)
    by_default = table5_paper().scenario(*overrides)
    searched, _ = repeat(repeats, solve, by_default, cache=cache)
    note = (
        f"{name}, solver.tries=0; with nothing kept from the lift before: {1e3 * alone.median:.0f} ms; "
        f"as by default, after a coarse search, in {by_default.solver.workers} threads: "
        f"{1e3 * searched.median:.0f} ms"
    )
    details = timing.plain() | {f"{key}_ms": 1e3 * value for key, value in solution.seconds.items()}
    return Row(1e3 * timing.median, _doubt(solution) + note, _counts(solution), details)


def fresh_process(repeats: int, *overrides: str) -> tuple[Row, Row]:
    """Time the command, from its call to its exit, and take the most memory that it held."""
    times, cpu, memory, status = [], [], [], 0.0
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "liftopt", "solve", "table5_paper", "--out", str(Path(folder) / "result")]
        command += [word for override in overrides for word in ("--set", override)]
        for _ in range(repeats):
            launch = [sys.executable, "-I", "-S", "-c", LAUNCHER, *command]
            # From another folder: in that of the sources Python would import these, which no kernels came with.
            run = subprocess.run(launch, capture_output=True, text=True, check=True, env=os.environ, cwd=folder)
            wall, busy, kilobytes, status = (float(word) for word in run.stdout.split())
            times.append(1e3 * wall)
            cpu.append(1e3 * busy)
            memory.append(kilobytes / 1e3)
    note = " ".join(["liftopt solve table5_paper", *(f"--set {override}" for override in overrides)])
    if status:
        note = f"exit status {os.waitstatus_to_exitcode(int(status))}; {note}"
    details = {"cpu_median_ms": float(np.median(cpu)), "least_ms": min(times), "repeats": repeats}
    return Row(float(np.median(times)), note, {}, details), Row(max(memory), note, {}, {"MB": memory})


def many_starts(repeats: int) -> Row:
    """Time 64 starts, half in each of two processes that are up and have lifted before; the best is kept."""
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        list(pool.map(_half, (0, 1), (1, 1)))

        def both() -> list[float]:
            return list(pool.map(_half, (0, 1), (MANY // 2, MANY // 2)))

        timing, objectives = measure(repeats, both)
    kept = {"objective": min(objectives)}
    # Of the processor's time only that of this process is known, which waits.
    details = {key: value for key, value in timing.plain().items() if not key.startswith("cpu")}
    return Row(1e3 * timing.median, "banded; each process searches and solves half of them", kept, details)


@cache
def _cache() -> SolverCache:
    """Return what this worker keeps from lift to lift."""
    return SolverCache()


def _half(seed: int, starts: int) -> float:
    """Return the objective of the best of some starts; in a worker."""
    overrides = ["solver.name=banded", "solver.workers=1", f"solver.starts={starts}", f"solver.seed={seed}"]
    scenario = table5_paper().scenario(*overrides)
    solution = solve(scenario, cache=_cache())
    return solution.objective if solution.solved else float("inf")


def _counts(solution: Solution) -> dict[str, object]:
    return {
        "objective": solution.objective,
        "starts": len(solution.starts),
        "converged": sum(start.status.startswith("converged") for start in solution.starts),
        "iterations": sum(start.iterations for start in solution.starts),
    }


def _doubt(solution: Solution) -> str:
    return "" if solution.solved else f"{solution.status}; "
