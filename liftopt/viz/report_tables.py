"""The tables of the report, as rows ready to print."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from liftopt.ergonomics.lift import subject_in
from liftopt.multibody.joint_curves import JointCurve
from liftopt.multibody.joint_units import TURNS
from liftopt.multibody.person.provenance import subject_quantities
from liftopt.scenario.model import Scenario
from liftopt.solution.solution import Solution


@dataclass(frozen=True)
class Headline:
    """One of the numbers that matter most: the number, what it is, and a word on it."""

    value: str
    label: str
    remark: str


def joint_rows(curves: tuple[JointCurve, ...], dense: Solution) -> list[dict[str, Any]]:
    """Return a row a joint: range of motion used, largest torque and share of its limit, with their times."""
    rows = []
    for curve in curves:
        at, worst = int(np.argmax(np.abs(curve.tau))), int(np.argmax(curve.share))
        q_unit, tau_unit = ("", "") if curve.units is TURNS else (f" {curve.units.shown}", f" {curve.units.tau}")
        rows.append(
            {
                "label": curve.label,
                "part": curve.part,
                "q": f"{_number(curve.q.min())} to {_number(curve.q.max())}{q_unit}",
                "q_limits": _span(curve.q_limits) + q_unit,
                "tau": f"{_number(curve.tau[at], 2)}{tau_unit} at {dense.time[at]:.2f} s",
                "tau_limits": _span(curve.tau_limits) + tau_unit,
                "share": 100 * float(curve.share[worst]),
                "share_at": f"{dense.time[worst]:.2f} s",
            }
        )
    return rows


def scenario_rows(scenario: Scenario) -> list[dict[str, str]]:
    """Return a row an entry: key, value, what it is and what is allowed."""
    entries = scenario.entries().items()
    values = {key: f"{value:g}" if isinstance(value, float) else str(value) for key, value in entries}
    rows = []
    for key, about in scenario.describe():
        if key.startswith("task.") and key not in values:  # of the other way to say where the object is
            continue
        what, _, allowed = about.partition(": ")
        rows.append({"key": key, "value": values.get(key, ""), "what": what, "allowed": allowed})
    return rows


def check_rows(summary: dict[str, Any]) -> list[dict[str, Any]]:
    """Return a row a requirement: its worst value, the limit, and whether it holds; without a limit nothing can."""
    rows = [
        {
            "name": check["name"],
            "unit": check["unit"],
            "value": _short(check["value"]),
            "limit": _short(check["limit"]),
            "where": check["where"],
            "state": _state(check["passed"], check["limit"]),
        }
        for check in summary["verification"]["checks"]
    ]
    return [*rows, _kkt_row(summary["verification"])]


def source_rows(solution: Solution) -> list[dict[str, Any]]:
    """Return a row a group of numbers of the people's models and source: how many, where from, how certain."""
    bodies = dict.fromkeys(subject_in(solution, person.name) for person in solution.persons)
    groups: dict[tuple[str, str, str], int] = {}
    for item in (item for body in bodies for item in subject_quantities(body)):
        key = (item.group, item.source.citation, item.source.confidence)
        groups[key] = groups.get(key, 0) + 1
    return [
        {"group": group, "citation": citation, "confidence": confidence, "count": count}
        for (group, citation, confidence), count in groups.items()
    ]


def _kkt_row(verification: dict[str, Any]) -> dict[str, Any]:
    error, limit = verification["kkt_error"], verification["kkt_tolerance"]
    return {
        "name": "first-order optimality (KKT error)",
        "unit": "",
        "value": _short(error),
        "limit": _short(limit),
        "where": "",
        "state": _state(error is not None and error <= limit, limit),
    }


def _state(passed: bool, limit: float | None) -> str:
    """Return ``"ok"``, ``"fails"``, or ``"no limit"`` for what is only told."""
    if limit is None:
        return "no limit"
    return "ok" if passed else "fails"


def _number(value: float, digits: int = 1) -> str:
    return f"{round(float(value), digits) + 0.0:.{digits}f}".replace("-", "\N{MINUS SIGN}")


def _span(limits: tuple[float, float]) -> str:
    low, high = (f"{round(limit, 1) + 0.0:g}".replace("-", "\N{MINUS SIGN}") for limit in limits)
    return f"{low} to {high}"


def _short(value: float | None) -> str:
    return "\N{EM DASH}" if value is None else f"{value:.2g}".replace("-", "\N{MINUS SIGN}")
