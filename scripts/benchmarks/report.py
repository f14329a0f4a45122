"""What a run says: a table, a file, and what changed since another file."""

from __future__ import annotations

import json
import os
import platform
import subprocess
import time
from collections.abc import Iterator
from dataclasses import asdict
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from benchmarks.goals import GOALS, Row

RIVALS = {
    "virtual_machine": "the same NLP, CasADi's virtual machine, IPOPT",
    "snopt_zero": "the paper's size through SNOPT, zero guess",
    "snopt_small": "the paper's size through SNOPT, our start",
    "snopt": "the same NLP, SNOPT in Drake, our start",
    "moco": "the same lift in OpenSim Moco, our start",
    "moco_naive": "the same lift in OpenSim Moco, its naive guess",
    "moco_fine": "the same lift in OpenSim Moco, our tolerance",
    "floor": "Pinocchio's computeRNEADerivatives, all knots",
}
PACKAGES = ("liftopt", "casadi", "pin", "numpy", "scipy", "drake", "opensim")
PROCESSOR = "cpu_median_ms"  # key of the processor time, which says more than the wall's on a busy machine
MARKS = {"beyond": "[green]beyond[/]", "reached": "[green]reached[/]", "missed": "[red]missed[/]"}


def record(rows: dict[str, Row], stages: dict[str, dict[str, float]], arguments: str) -> dict[str, Any]:
    """Return all of a run as plain values."""
    kept: dict[str, Any] = {}
    for key, row in rows.items():
        kept[key] = asdict(row)
        if (goal := GOALS.get(key)) is not None:
            kept[key] |= {"title": goal.title, "unit": goal.unit, "goal": goal.goal, "beyond": goal.beyond}
            kept[key]["verdict"] = None if row.value is None else goal.verdict(row.value)
        else:
            kept[key] |= {"title": RIVALS[key], "unit": "ms"}
    return {
        "made": time.strftime("%Y-%m-%dT%H:%M:%S%z"),
        "arguments": arguments,
        "commit": _commit(),
        "machine": _machine(),
        "versions": {name: _version(name) for name in PACKAGES},
        "rows": kept,
        "ratios": _ratios(rows),
        "profile_ms": stages,
    }


def show(run: dict[str, Any], console: Console) -> None:
    """Print the goals, the rivals and the profile."""
    machine = run["machine"]
    console.print(f"{machine['cpu']}, {machine['cores']} cores, load {machine['load']:.1f}; commit {run['commit']}")
    goals = Table(
        "",
        "measured",
        "processor",
        "goal",
        "beyond",
        "",
        "note",
        title="table5_paper, N = 20, tolerance 1e-6, one thread",
    )
    for key in filter(run["rows"].__contains__, GOALS):
        row, goal = run["rows"][key], GOALS[key]
        mark = "skipped" if row["value"] is None else MARKS[goal.verdict(row["value"])]
        goals.add_row(goal.title, _figure(row["value"], goal.unit), _figure(row["details"].get(PROCESSOR), "ms"),
                      _figure(goal.goal, goal.unit),
                      _figure(goal.beyond, goal.unit), mark, row["note"])  # fmt: skip
    if goals.row_count:
        console.print(goals)
    if rivals := [key for key in RIVALS if key in run["rows"]]:
        table = Table("", "measured", "by IPOPT here", "by banded here", "note", title="Others, in the same run")
        for key in rivals:
            row, ratio = run["rows"][key], run["ratios"].get(key, {})
            table.add_row(RIVALS[key], _figure(row["value"], "ms") or "-", _times(ratio.get("ipopt")),
                          _times(ratio.get("banded")), row["note"])  # fmt: skip
        console.print(table)
    for title, stages in run["profile_ms"].items():
        table = Table("", "ms", title=f"Profile: {title}")
        for name, ms in stages.items():
            table.add_row(name, f"{ms:.3f}" if ms < 10 else f"{ms:.0f}")
        console.print(table)


def compare(old: dict[str, Any], new: dict[str, Any], console: Console) -> None:
    """Print what changed: counts, which depend on no machine, then figures and ratios, which are of one run each."""
    table = Table("count", "old", "new", "change", title=f"Counts: {old['commit']} to {new['commit']}")
    before = dict(_counts(old))
    for name, value in _counts(new):
        if name in before and before[name] != value:
            table.add_row(name, f"{before[name]:.8g}", f"{value:.8g}", _change(before[name], value))
    console.print(table if table.row_count else "No count has changed.")
    table = Table("figure", "old", "new", "change", title="Figures (other machine, other load: compare the ratios)")
    for key in filter(new["rows"].__contains__, old["rows"]):
        was, now = old["rows"][key], new["rows"][key]
        if was["value"] is not None and now["value"] is not None:
            table.add_row(now["title"], _figure(was["value"], was["unit"]), _figure(now["value"], now["unit"]),
                          _change(was["value"], now["value"]))  # fmt: skip
    for key in filter(new["ratios"].__contains__, old["ratios"]):
        for name in filter(new["ratios"][key].__contains__, old["ratios"][key]):
            was, now = old["ratios"][key][name], new["ratios"][key][name]
            table.add_row(f"{key} by {name}", _times(was), _times(now), _change(was, now))
    console.print(table)


def write(run: dict[str, Any], path: Path) -> None:
    """Write the file, whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    new = path.with_name(f".{path.name}.new")
    new.write_text(json.dumps(run, indent=1) + "\n", encoding="utf-8")
    os.replace(new, path)


def _ratios(rows: dict[str, Row]) -> dict[str, dict[str, float]]:
    """Return each time over that of one cold solve by ours: what is left when machine and load are taken out.

    A rival is compared with ours on its very problem, start and tolerance; the others with the paper's lift at 1e-6, by
    processor time where both have it.
    """
    units = {key: GOALS[key].unit if key in GOALS else "ms" for key in rows}
    found: dict[str, dict[str, float]] = {}
    for key, row in rows.items():
        beside: dict[str, dict[str, Any]] = row.details.get("beside", {})
        for name, own in beside.items():
            # Without an optimum on both sides there is nothing to compare. One that uses all cores has no ratio by
            # processor time.
            if row.value is not None and own["objective"] is not None:
                ratio = row.value / own["median_ms"]
                if PROCESSOR in row.details:
                    ratio = row.details[PROCESSOR] / own[PROCESSOR]
                found.setdefault(key, {})[name] = ratio
        for ours in () if "beside" in row.details else ("ipopt", "banded"):
            reference = rows.get(ours, Row(None))
            if row.value is not None and reference.value is not None and key != ours and units[key] == "ms":
                both = PROCESSOR in row.details and PROCESSOR in reference.details
                took, unit = (row.value, reference.value)
                if both:
                    took, unit = (each.details[PROCESSOR] for each in (row, reference))
                found.setdefault(key, {})[ours] = took / unit
    return found


def _counts(run: dict[str, Any]) -> Iterator[tuple[str, float]]:
    for key, row in run["rows"].items():
        yield from _numbers(key, row["counts"])


def _numbers(name: str, value: Any) -> Iterator[tuple[str, float]]:
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _numbers(f"{name}, {key}", inner)
    elif isinstance(value, list):
        for i, inner in enumerate(value):
            yield from _numbers(f"{name} {i + 1}", inner)
    elif isinstance(value, int | float):
        yield name, float(value)


def _machine() -> dict[str, Any]:
    cpu = platform.processor() or platform.machine()
    listed = Path("/proc/cpuinfo")
    if listed.exists():
        models = [line for line in listed.read_text(encoding="utf-8").splitlines() if line.startswith("model name")]
        cpu = models[0].partition(":")[2].strip() if models else cpu
    return {
        "cpu": cpu,
        "cores": os.cpu_count(),
        "load": os.getloadavg()[0],
        "system": platform.platform(),
        "python": platform.python_version(),
    }


def _commit() -> str:
    """Return the commit of the working tree, with a + if it was changed; empty outside a clone."""
    command = ["git", "describe", "--always", "--dirty=+"]
    try:
        found = subprocess.run(command, cwd=Path(__file__).parent, capture_output=True, text=True, check=False)
    except OSError:
        return ""
    return found.stdout.strip()


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"


def _figure(value: float | None, unit: str) -> str:
    if value is None:
        return ""
    if unit == "ms" and value >= 1000:
        return f"{value / 1000:.2f} s"
    return f"{value:.{0 if value >= 100 else 3 if value < 1 else 1}f} {unit}".strip()


def _times(ratio: float | None) -> str:
    return "" if ratio is None else f"{ratio:.3g} x"


def _change(was: float, now: float) -> str:
    return f"{100.0 * (now / was - 1.0):+.1f} %" if was else ""
