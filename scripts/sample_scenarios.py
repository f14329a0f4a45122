"""Solve scenarios drawn from all that is sensible: is each one solved and verified, or told why it cannot be?

A seeded Latin hypercube over the person, the object, the task and where they stand. Every answer becomes one line of
JSON at once, and a run that is started again goes on where it stopped. ``--table`` sums up what is there.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import qmc

from liftopt.errors import InputError, LiftoptError
from liftopt.scenario.model import load_scenario
from liftopt.search.cache import SolverCache
from liftopt.search.solve import solve

RANGES = {
    "human.stature": (1.45, 2.05),
    "human.mass": (45.0, 130.0),
    "object.mass": (0.5, 15.0),
    "object.depth": (0.2, 1.2),
    "duration": (0.8, 6.0),
    "task.start.height": (0.3, 1.7),
    "task.end.height": (0.3, 1.7),
    "task.standing_distance": (1.2, 2.4),
    "task.start.human_distance": (0.25, 0.65),
    "task.end.human_distance": (0.25, 0.65),
    "task.start.pitch_deg": (-10.0, 10.0),
    "task.end.pitch_deg": (-10.0, 10.0),
}
CHOICES = ("sex", "free", "tilted")  # coordinates of the hypercube below and above one half


def drawn(count: int, seed: int) -> list[list[str]]:
    """Return the overrides of each scenario; half are women, half fix the distances, half are tilted at the ends."""
    unit = qmc.LatinHypercube(len(RANGES) + len(CHOICES), seed=np.random.default_rng(seed)).random(count)
    scenarios = []
    for point in unit:
        values = {key: low + u * (high - low) for (key, (low, high)), u in zip(RANGES.items(), point, strict=False)}
        woman, free, tilted = point[len(RANGES) :] < 0.5
        overrides = [f"human.sex={'female' if woman else 'male'}"]
        for key, value in values.items():
            if free and key.endswith("human_distance"):
                overrides.append(f"{key}=free")
            elif tilted or not key.endswith("pitch_deg"):
                overrides.append(f"{key}={value:.3f}")
        scenarios.append(overrides)
    return scenarios


def answer(overrides: list[str], cache: SolverCache) -> dict[str, Any]:
    """Return how a scenario ended, why, and how long it took."""
    began, cpu = time.monotonic(), time.process_time()
    entry: dict[str, Any] = {"overrides": overrides}
    try:
        solution = solve(load_scenario("table5", overrides), cache=cache)
        entry |= {"outcome": "solved" if solution.solved else solution.status.partition(":")[0].partition(" (")[0]}
        entry |= {"status": solution.status, "objective": solution.objective}
        entry |= {"starts": [(s.name, s.status, s.objective, s.iterations) for s in solution.starts]}
        entry |= {"notes": solution.notes, "kept": solution.kept_start, "intervals": solution.intervals}
        for name in ("reasons", "suggested_changes"):
            entry[name] = [item.message for item in getattr(solution, name)]
    except InputError as error:
        entry |= {"outcome": "refused", "status": str(error)}
    except LiftoptError as error:
        entry |= {"outcome": "error", "status": f"{type(error).__name__}: {error}"}
    except Exception as error:
        entry |= {"outcome": "crashed", "status": f"{type(error).__name__}: {error}"}
    return entry | {"seconds": time.monotonic() - began, "cpu_seconds": time.process_time() - cpu}


def table(entries: list[dict[str, Any]]) -> str:
    """Return counts of the outcomes, times and the slowest, as Markdown."""
    counts, lines = Counter(entry["outcome"] for entry in entries), ["| outcome | scenarios | median [s] | most [s] |"]
    lines.append("|---|---|---|---|")
    for outcome, count in counts.most_common():
        seconds = [entry["seconds"] for entry in entries if entry["outcome"] == outcome]
        lines.append(f"| {outcome} | {count} | {np.median(seconds):.2f} | {np.max(seconds):.2f} |")
    told = [entry for entry in entries if entry["outcome"] not in ("solved", "refused")]
    reasons = sum(bool(entry.get("reasons")) for entry in told)
    suggested_changes = sum(bool(entry.get("suggested_changes")) for entry in told)
    lines.append(f"\n{len(entries)} scenarios; of {len(told)} without a solution {reasons} have named reasons, ")
    lines[-1] += f"{suggested_changes} a change that was solved with."
    return "\n".join(lines)


def gaps(entries: dict[int, dict[str, Any]], yardstick: dict[int, dict[str, Any]]) -> str:
    """Return by how much the objectives are above those of a run with more starts, in one line."""
    both = [i for i in entries if i in yardstick and entries[i]["outcome"] == yardstick[i]["outcome"] == "solved"]
    # Objectives on different meshes cannot be compared.
    same = [i for i in both if entries[i]["intervals"] == yardstick[i]["intervals"]]
    if not same:
        return "no scenario in common"
    above = np.array([entries[i]["objective"] / min(yardstick[i]["objective"], entries[i]["objective"]) for i in same])
    above = 100 * (above - 1)
    return (
        f"objective above the long run's on {len(same)} scenarios ({len(both) - len(same)} more on another mesh): "
        f"median {np.median(above):.2f} %, 95 % below {np.quantile(above, 0.95):.2f} %, most {above.max():.2f} %"
    )


def _read(file: Path) -> dict[int, dict[str, Any]]:
    lines = file.read_text().splitlines() if file.exists() else []
    return {entry["index"]: entry for entry in map(json.loads, lines)}


def main() -> int:
    """Run what is not there yet and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", type=Path, help="JSON lines, read and appended to")
    parser.add_argument("--count", type=int, default=500)
    parser.add_argument("--seed", type=int, default=5)
    parser.add_argument("--first", type=int, default=0, help="go on from this scenario")
    parser.add_argument("--last", type=int, default=None, help="stop before this scenario")
    parser.add_argument("--set", action="append", default=[], dest="overrides", metavar="KEY=VALUE")
    parser.add_argument("--against", type=Path, help="the file of a run with more starts, to compare objectives")
    parser.add_argument("--table", action="store_true", help="only sum up what is there")
    args = parser.parse_args()
    entries = _read(args.file)
    cache = SolverCache()
    if not args.table:
        for i, overrides in enumerate(drawn(args.count, args.seed)[: args.last]):
            if i in entries or i < args.first:
                continue
            entries[i] = {"index": i} | answer([*overrides, *args.overrides], cache)
            with args.file.open("a") as out:
                out.write(json.dumps(entries[i]) + "\n")
    print(table(list(entries.values())))
    if args.against:
        print(gaps(entries, _read(args.against)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
