"""The varied scenarios: does the banded solver solve them, and is the answer as good as before?"""

from __future__ import annotations

from typing import Any

import numpy as np

from benchmarks.case import Case
from benchmarks.goals import Row
from benchmarks.scenarios import PATIENT, REST, STARTS, varied_scenarios
from liftopt.search.cache import SolverCache
from liftopt.search.solve import solve

AS_GOOD = 1e-3  # relative


def first_try(count: int | None = None) -> tuple[Row, Row]:
    """Solve each from its one start with the banded solver, and with IPOPT where that fails; all verified."""
    took, iterations, statuses = [], [], []
    first, in_the_end = 0, 0
    kept = varied_scenarios()[:count]
    for varied in kept:
        case = Case.of(varied.scenario(), varied.ends)
        result = case.solve(case.solver("banded"))
        took.append(1e3 * result.seconds)
        iterations.append(result.iterations)
        good = case.verified(result)
        first += good
        if not good:
            statuses.append({"overrides": varied.overrides, "status": result.status})
            good = case.verified(case.solve(case.solver("ipopt")))
        in_the_end += good
    counts = {"iterations": iterations, "first_try": first, "fallback": in_the_end, "of": len(kept)}
    details: dict[str, Any] = {"ms": took, "failed": statuses}
    times = f"median {np.median(took):.0f} ms, p90 {np.percentile(took, 90):.0f} ms"
    note = f"{first} of {len(kept)}; {times}, {np.mean(iterations):.0f} iterations"
    return (
        Row(100.0 * first / len(kept), note, counts, details),
        Row(100.0 * in_the_end / len(kept), f"{in_the_end} of {len(kept)}", {}, {}),
    )


def objectives(name: str, count: int | None = None) -> Row:
    """Compare the best of eight starts with the best before the work on speed."""
    cache, ratios, seconds, unsolved = SolverCache(), [], [], 0
    kept = [varied for varied in varied_scenarios() if varied.objective is not None][:count]
    for varied in kept:
        overrides = (f"solver.name={name}", f"solver.starts={STARTS}", PATIENT, REST)
        solution = solve(varied.scenario(*overrides), cache=cache)
        ratios.append(solution.objective / varied.objective if solution.solved and varied.objective else np.inf)
        seconds.append(solution.seconds["total"])
        unsolved += not solution.solved
    good, lower = (int(np.sum(np.array(ratios) <= 1.0 + bound)) for bound in (AS_GOOD, -AS_GOOD))
    worst = [f"{ratio:.3f}" for ratio in sorted(ratios)[-3:]]
    note = f"{name}: {good} of {len(kept)}, {lower} of them lower; worst J / J before {', '.join(worst)}"
    if unsolved:
        note += f"; {unsolved} unsolved"
    details = {"median_ms": 1e3 * float(np.median(seconds))}
    return Row(100.0 * good / len(kept), note, {"ratios": ratios}, details)
