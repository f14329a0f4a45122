"""Vary one constant of the search: what does each value gain on sampled scenarios, and what does it cost?

``python scripts/tune_search.py coarse_search.MARGIN 1.0 1.2 1.5`` solves the first scenarios of ``sample_scenarios.py``
with each of these values and with the value of the code, and prints a table in Markdown: how many are solved, how
far the objective is above the best of all values (geometric mean, and how many within 1 and 5 %), and what it took
(iterations of the starts that are recorded, processor time). Constants of the solvers go by ``collocation.``, as in
``collocation.solvers.banded.PRUNING_ITERATIONS``. ``docs/tuning.md`` tells which constants were chosen so.
"""

from __future__ import annotations

import argparse
import ast
import importlib
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from sample_scenarios import drawn

from liftopt.errors import LiftoptError
from liftopt.scenario.model import load_scenario
from liftopt.search.cache import SolverCache
from liftopt.search.solve import solve

WITHIN = (1.01, 1.05)


@dataclass(frozen=True)
class Answer:
    """How one lift ended: objective (NaN where it is not solved), intervals, iterations and processor time [s]."""

    objective: float
    intervals: int
    iterations: int
    seconds: float


def module_of(constant: str) -> tuple[Any, str]:
    """Return the module and the name of a constant; names without a room are the search's."""
    path, _, name = constant.rpartition(".")
    module = importlib.import_module(f"liftopt.{path}" if path.startswith("collocation.") else f"liftopt.search.{path}")
    if not hasattr(module, name):
        raise SystemExit(f"{module.__name__} has no constant {name}")
    return module, name


@contextmanager
def changed(constant: str, value: object) -> Iterator[None]:
    """Let every module that knows the constant by its name have another value."""
    module, name = module_of(constant)
    before = getattr(module, name)
    holders = [m for key, m in sys.modules.items() if key.startswith("liftopt.") and vars(m).get(name) is before]
    for holder in holders:
        setattr(holder, name, value)
    try:
        yield
    finally:
        for holder in holders:
            setattr(holder, name, before)


def answers(count: int, seed: int, overrides: list[str]) -> list[Answer]:
    """Solve the first so many sampled scenarios."""
    cache, found = SolverCache(), []
    for drawn_overrides in drawn(500, seed)[:count]:
        began = time.process_time()
        try:
            solution = solve(load_scenario("table5", [*drawn_overrides, *overrides]), cache=cache)
        except LiftoptError:
            found.append(Answer(np.nan, 0, 0, time.process_time() - began))
            continue
        iterations = sum(start.iterations for start in solution.starts)
        objective = solution.objective if solution.solved else np.nan
        found.append(Answer(objective, solution.intervals, iterations, time.process_time() - began))
    return found


def table(constant: str, by_value: dict[str, list[Answer]]) -> str:
    """Return what each value led to, as Markdown."""
    objective = np.array([[answer.objective for answer in found] for found in by_value.values()])
    # Objectives compare on one mesh only.
    meshes = np.array([[answer.intervals for answer in found] for found in by_value.values()])
    common = np.isfinite(objective).all(axis=0) & (meshes == meshes[0]).all(axis=0)
    above = objective[:, common] / objective[:, common].min(axis=0)
    lines = [f"| {constant} | solved | mean above the best | within 1 %, 5 % | iterations | processor [s] |"]
    lines.append("|---|---|---|---|---|---|")
    for (value, found), ratios, solved in zip(by_value.items(), above, np.isfinite(objective).sum(axis=1), strict=True):
        mean = f"{100 * (np.exp(np.log(ratios).mean()) - 1):.2f} %" if len(ratios) else "-"
        near = ", ".join(str(int((ratios <= bound).sum())) for bound in WITHIN) + f" of {int(common.sum())}"
        iterations, seconds = sum(answer.iterations for answer in found), sum(answer.seconds for answer in found)
        lines.append(f"| {value} | {solved} of {len(found)} | {mean} | {near} | {iterations} | {seconds:.1f} |")
    return "\n".join(lines)


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("constant", help="module and name, such as coarse_search.MARGIN")
    parser.add_argument("values", nargs="+", help="as Python writes them")
    parser.add_argument("--count", type=int, default=40, help="scenarios")
    parser.add_argument("--seed", type=int, default=5, help="of the scenarios")
    parser.add_argument("--set", action="append", default=[], dest="overrides", metavar="KEY=VALUE")
    args = parser.parse_args()
    own = getattr(*module_of(args.constant))
    values = {f"{own!r} (the code's)": own} | {text: ast.literal_eval(text) for text in args.values}
    by_value = {}
    for text, value in values.items():
        with changed(args.constant, value):
            by_value[text] = answers(args.count, args.seed, ["solver.time_limit=3600", *args.overrides])
        print(f"{args.constant} = {text}: done", file=sys.stderr, flush=True)
    print(table(args.constant, by_value))
    return 0


if __name__ == "__main__":
    sys.exit(main())
