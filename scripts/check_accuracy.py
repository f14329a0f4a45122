"""How near is an answer on 20 intervals to the lift in continuous time, and what does a solve with either rest cost?

On the benchmark's varied scenarios: the objective beside that of the same motion on 320 intervals, the limit that is
reported beside it, and whether its error bar holds it. Then one solve from the same start with zero velocity at the
ends and with zero acceleration as well, in turns: iterations, and the ratio of the fastest of ``--repeat`` solves.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

import numpy as np
from benchmarks.case import Case
from benchmarks.scenarios import PATIENT, Varied, varied_scenarios

from liftopt.collocation.solvers.deadline import NEVER
from liftopt.search.cache import SolverCache
from liftopt.search.mesh_accuracy import distance
from liftopt.search.optimum_on_mesh import FASTEST_FIRST, optimum_on_mesh
from liftopt.search.session import Session
from liftopt.search.solve import find_lift

FINE = (40, 80, 160, 320)
RESTS = ("velocity", "acceleration")


def accuracy(varied: Varied, cache: SolverCache) -> dict[str, float]:
    """Return a scenario's objective and limit over the objective on the finest mesh, less 1, and how far it moved."""
    scenario = varied.scenario(PATIENT)
    found = find_lift(Session(scenario, cache))
    best, known = found.best, found.accuracy
    fine = best
    if not best.solved or known is None:
        raise RuntimeError(f"not solved: {varied.overrides}")
    for intervals in FINE:
        if intervals > best.spline.intervals:
            there = optimum_on_mesh(cache, fine, intervals, FASTEST_FIRST, NEVER, lambda line: None)
            if there is None:
                raise RuntimeError(f"no optimum on {intervals} intervals: {varied.overrides}")
            fine = there
    finest = fine.result.objective
    return {
        "intervals": best.spline.intervals,
        "objective": best.result.objective / finest - 1,
        "limit": known.objective_limit / finest - 1,
        "bar": known.objective_bar / finest,
        "moved": distance(best, fine),
    }


def cost(varied: Varied, repeat: int) -> dict[str, list[float]]:
    """Return iterations and the fastest time [ms] of a solve with each rest, from the same start."""
    cases = [Case.of(varied.scenario(f"task.rest={rest}"), varied.ends) for rest in RESTS]
    solvers = [case.solver("banded") for case in cases]
    results = [[case.solve(solver) for case, solver in zip(cases, solvers, strict=True)] for _ in range(repeat)]
    return {
        "iterations": [float(result.iterations) for result in results[0]],
        "ms": [1e3 * min(row[i].seconds for row in results) for i in range(len(RESTS))],
    }


def told(entries: list[dict[str, float]], costs: list[dict[str, list[float]]]) -> str:
    """Return the figures as text."""
    columns = {name: np.array([entry[name] for entry in entries]) for name in entries[0]}
    limit = np.abs(columns["limit"])
    lines = [
        f"{len(entries)} scenarios; {int((columns['intervals'] == 20).sum())} on 20 intervals, beside the same motion "
        f"on {FINE[-1]} (largest distance {columns['moved'].max():.3f} rad or m):",
        f"objective above: median {np.median(columns['objective']):.2%}, most {columns['objective'].max():.2%}, "
        f"{int((columns['objective'] <= 0.035).sum())} within 3.5 %",
        f"reported limit off: median {np.median(limit):.3%}, most {limit.max():.3%}; its bar holds it in "
        f"{int((limit <= columns['bar']).sum())}, bar in the median {np.median(columns['bar']):.2%}",
    ]
    if costs:
        iterations, ms = (np.array([entry[name] for entry in costs]) for name in ("iterations", "ms"))
        ratio = ms[:, 0] / ms[:, 1]
        lines.append(
            f"one solve with zero velocity over one with zero acceleration: {iterations[:, 0].mean():.1f} and "
            f"{iterations[:, 1].mean():.1f} iterations in the mean, time {np.median(ratio):.2f} in the median "
            f"({np.sum(ms[:, 0]) / np.sum(ms[:, 1]):.2f} of all together)"
        )
    return "\n".join(lines)


def main() -> int:
    """Measure and print; ``--json`` keeps the figures of every scenario."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--json", type=Path)
    args = parser.parse_args()
    cache, kept = SolverCache(), varied_scenarios()[: args.count]
    entries = [accuracy(varied, cache) for varied in kept]
    costs = [cost(varied, args.repeat) for varied in kept] if args.repeat else []
    print(told(entries, costs))
    if args.json:
        args.json.write_text(json.dumps({"accuracy": entries, "cost": costs}, indent=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
