"""The tables of a summary for a terminal, 80 columns wide, readable without colour."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from liftopt.assessment.joints import NEAR_LIMIT
from liftopt.multibody.joint_units import TURNS, units_of

WIDTH = 80
BLOCKS = "▁▂▃▄▅▆▇█"
ASCII_BLOCKS = "_.-~=+*#"


def print_details(summary: dict[str, Any], console: Console) -> None:
    """Print the tables of what ``summary_dict`` gave; of an iterate only how the solver fared."""
    lift: list[Table | str] = []
    if summary["solved"]:
        lift = [
            *(_joints(agent, rows) for agent, rows in summary["joints"].items()),
            _load_share(summary["load_share"], console.options.ascii_only),
            _forces(summary),
            _objective(summary["objective"]),
        ]
    solver = [
        _starts(summary["solver"]),
        _effort(summary["solver"]),
        _accuracy(summary["accuracy"], summary["solver"]["intervals"]),
        _verification(summary["verification"]),
    ]
    for part in (*lift, *solver):
        if not isinstance(part, str):
            console.print()
        console.print(part, width=min(console.width, WIDTH), highlight=False)


def _table(title: str, *columns: str, caption: str = "") -> Table:
    """Return an empty table whose columns are right-aligned but for those that begin with ``<``."""
    table = Table(
        title=escape(title),
        title_justify="left",
        title_style="bold",
        caption=escape(caption) or None,
        caption_justify="left",
        box=None,
        padding=(0, 2, 0, 0),
        header_style="dim",
    )
    for column in columns:
        table.add_column(escape(column.lstrip("<")), justify="left" if column.startswith("<") else "right")
    return table


def _joints(agent: str, rows: list[dict[str, Any]]) -> Table:
    table = _table(
        f"{agent.capitalize()} joint torques",
        *("<joint", "peak [Nm]", "at [s]", "share", "<", "q [deg]"),
        caption="between the knots too; share: largest torque / limit in its direction; ! from 80%",
    )
    for row in rows:
        largest, unit = row["largest_share_of_limit"], units_of("peak_force_N" in row)
        remarks = ["!"] if largest is not None and largest >= NEAR_LIMIT else []
        peak, turns = f"peak_{unit.effort}", unit is TURNS
        if row["largest_share_at_s"] != row[f"{peak}_at_s"]:
            remarks.append(f"at {_fixed(row['largest_share_at_s'], 2)}")
        table.add_row(
            escape(f"{row['joint']} {row['meaning']}".rstrip()),
            _fixed(row[f"{peak}_{unit.tau}"], 2, sign=True) + ("" if turns else f" {unit.tau}"),
            _fixed(row[f"{peak}_at_s"], 2),
            _percent(largest) + "%",
            " ".join(remarks),
            "..".join(_fixed(row[f"q_{end}_{unit.shown}"], 1) for end in ("min", "max"))
            + ("" if turns else f" {unit.shown}"),
        )
    return table


def _load_share(load: dict[str, Any], ascii_only: bool) -> Table:
    moments = {"0": 0.0, "T/4": 0.25, "T/2": 0.5, "3T/4": 0.75, "T": 1.0}
    title = "Load share: part of the vertical grasp force [%]"
    table = _table(title, "<", *moments, "lowest", "highest", "<over time")
    time = np.array(load["time_s"])
    for agent, data in load["agents"].items():
        share = np.array([np.nan if value is None else value for value in data["share"]])
        at = np.interp(np.array([*moments.values()]) * time[-1], time, share)
        extremes = (_percent(data["min"]), _percent(data["max"]))
        table.add_row(agent, *map(_percent, at), *extremes, _sparkline(share, ascii_only))
    return table


def _sparkline(values: npt.NDArray[np.float64], ascii_only: bool) -> str:
    """Return at most 17 characters that rise with the values, from 0 (lowest) to 1 (highest block)."""
    blocks = ASCII_BLOCKS if ascii_only else BLOCKS
    picked = values[np.linspace(0, len(values) - 1, min(len(values), 17)).round().astype(int)]
    return "".join(
        blocks[int(np.clip(value, 0.0, 1.0) * (len(blocks) - 1) + 0.5)] if np.isfinite(value) else " "
        for value in picked
    )


def _forces(summary: dict[str, Any]) -> Table:
    table = _table("Forces", "<", "peak", "<", "at [s]", "<")
    grasp, grounds = summary["grasp_force"], _grounds(summary)
    for agent, peak in grasp["agents"].items():
        of_limit = (
            "" if peak["peak_N"] is None else f"{peak['peak_N'] / grasp['limit_N']:.0%} of {grasp['limit_N']:g} N"
        )
        _force_row(table, f"grasp force, {agent}", peak, of_limit)
    for agent, peak in summary["grasp_moment"].items():
        limit = peak["limit_Nm"]
        of_limit = "" if peak["peak_Nm"] is None else f"{peak['peak_Nm'] / limit:.0%} of {limit:g} Nm"
        _force_row(table, f"grasp moment, {agent}", peak, of_limit)
    if "squeeze" in grasp:
        _force_row(table, "squeeze between the grasps", grasp["squeeze"], "+ presses the object together")
    for name, ground in grounds.items():
        of_weight = ground["vertical_over_body_weight"]
        times = "" if of_weight is None else f"{of_weight:.2f} x body weight"
        reaction, moment = ("ground", "moment at feet") if name else ("ground reaction", "ground moment at the feet")
        _force_row(table, f"{name}{reaction}, vertical", ground["vertical"], times)
        _force_row(table, f"{name}{reaction}, horizontal", ground["horizontal"], "")
        _force_row(table, f"{name}{moment}", ground["moment"], "")
        _force_row(table, "  sagittal (about Y)", ground["moment_sagittal"], "")
        _force_row(table, "  lateral (about X)", ground["moment_lateral"], "")
        _force_row(table, "  twisting (about Z)", ground["moment_vertical"], "")
    return table


def _grounds(summary: dict[str, Any]) -> dict[str, Any]:
    """Return what the ground does to each person, by what comes before its name in the table."""
    end = "ground_reaction"
    found = {key.removesuffix(end).rstrip("_"): one for key, one in summary.items() if key.endswith(end)}
    if len(found) < 2:
        return found
    first = next(name for name, agent in summary["scenario"]["agents"].items() if agent["kind"] == "person")
    return {f"{name or first}: ": one for name, one in found.items()}


def _force_row(table: Table, label: str, peak: dict[str, Any], remark: str) -> None:
    unit = "N" if "peak_N" in peak else "Nm"
    table.add_row(label, _fixed(peak[f"peak_{unit}"], 1), unit, _fixed(peak["at_s"], 2), remark)


def _objective(objective: dict[str, Any]) -> Table:
    table = _table("Objective", "<term", "integral", "<unit", "weight", "weighted", "share [%]")
    total = objective["total"]
    for name, term in objective["terms"].items():
        share = _percent(term["weighted"] / total) if total and term["weighted"] is not None else "-"
        table.add_row(
            name, _general(term["integral"]), term["unit"], f"{term['weight']:g}", _general(term["weighted"]), share
        )
    table.add_row("total", "", "", "", _general(total), "")
    return table


def _starts(solver: dict[str, Any]) -> Table:
    table = _table("Starts (* kept)", "<", "<start", "<status", "objective", "iterations", "[s]")
    for start in solver["starts"]:
        table.add_row(
            "*" if start["kept"] else "",
            escape(start["name"]),
            escape(start["status"]),
            _general(start["objective"]),
            str(start["iterations"]),
            _general(start["seconds"], 3),
        )
    return table


def _effort(solver: dict[str, Any]) -> str:
    seconds = ", ".join(f"{name} {_general(value, 3)} s" for name, value in solver["seconds"].items())
    return f"N = {solver['intervals']}, {solver['iterations']} iterations; {seconds}"


def _accuracy(accuracy: dict[str, Any] | None, intervals: int) -> str:
    if accuracy is None:
        return "Accuracy: not estimated, for this is no solution"
    if accuracy["objective_error"] is None:
        objective = f"error of the objective unknown: {accuracy['remark']}"
    else:
        objective = (
            f"objective {_percent(accuracy['objective_error'])}% above its limit of "
            f"{_general(accuracy['objective_limit'], 4)} +- {_short(accuracy['objective_bar'])} on ever finer meshes "
            f"(from N = {accuracy['compared_intervals']} and {intervals})"
        )
    closure, balance = _times(accuracy["closure_m"], 1e3), accuracy["balance_SI"]
    return (
        f"Accuracy (estimated): {escape(objective)}; between knots the grasps are up to {_short(closure)} mm apart, "
        f"the balance is off by {_short(balance)} N or Nm, torques exceed their limits by "
        f"{_short(accuracy['torque_excess_Nm'])} Nm"
    )


def _times(value: float | None, factor: float) -> float | None:
    return None if value is None else factor * value


def _verification(verification: dict[str, Any]) -> Table:
    verdict = "all passed" if verification["passed"] else "FAILED"
    table = _table(f"Verification: {verdict}", "<check", "<unit", "worst", "allowed", "<", "<where")
    for check in verification["checks"]:
        table.add_row(
            escape(check["name"]),
            escape(check["unit"]),
            _short(check["value"]),
            _short(check["limit"]),
            _state(check["passed"], check["limit"]),
            escape(check["where"]),
        )
    error, tolerance = verification["kkt_error"], verification["kkt_tolerance"]
    reached = error is not None and error <= tolerance
    table.add_row("KKT error", "", _short(error), _short(tolerance), _state(reached, tolerance))
    return table


def _state(passed: bool, limit: float | None) -> str:
    """Return how a check ended; a value without a limit is told and has not passed anything."""
    if limit is None:
        return "no limit"
    return "ok" if passed else "[bold red]FAILED[/bold red]"


def _fixed(value: float | None, digits: int, *, sign: bool = False) -> str:
    if value is None:
        return "-"
    return f"{value:+.{digits}f}" if sign else f"{value:.{digits}f}"


def _percent(value: float | None) -> str:
    return "-" if value is None or not np.isfinite(value) else f"{100.0 * value:.1f}"


def _general(value: float | None, digits: int = 5) -> str:
    return "-" if value is None else f"{value:.{digits}g}"


def _short(value: float | None) -> str:
    return "-" if value is None else f"{value:.2g}"
