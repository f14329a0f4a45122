"""Robots that lifted with a person, as scripts/check_robots.py measured it, and those of the paper's Table 1."""

from __future__ import annotations

import csv
import tomllib
from pathlib import Path

from tables import table

HERE = Path(__file__).parent
HEAD = ("robot", "joints", "outcome", "first, again [s]", "torque", "speed", "apart", "data: warned of", "also")
LONGEST = 160  # characters of a reason


def checked_robots() -> str:
    """Return what came of the robots that are known by name."""
    return table(HEAD, [(f"`{row['name']}`, {row['maker']}", *_cells(row)) for row in _rows("checked_robots.csv")])


def checked_table1() -> str:
    """Return what came of the robots of Table 1 of the paper, and of others by the path of their description."""
    asked = tomllib.loads((HERE / "table1_robots.toml").read_text(encoding="utf-8"))["robot"]
    of = {robot["name"]: robot for robot in asked}
    lines = []
    for row in _rows("checked_table1.csv"):
        robot = of[row["name"]]
        lines.append((robot["of"], f"{robot['maker']} {row['name']}", robot["source"], *_cells(row)))
    return table(("in Table 1", "robot", "description", *HEAD[1:]), lines)


def _rows(name: str) -> list[dict[str, str]]:
    with (HERE / name).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def _cells(row: dict[str, str]) -> tuple[str, ...]:
    """Return what came of a robot, in the columns of ``HEAD`` after the first."""
    outcome = row["outcome"]
    if len(outcome) > LONGEST:
        outcome = outcome[:LONGEST].rsplit(" ", 1)[0] + " ..."
    if outcome == "solved":
        outcome = f"lifts {float(row['box_kg']):g} kg from {row['from_m']} to {row['to_m']} m"
    torque = f"{row['torque_percent']} %, {row['torque_joint']}" if row["torque_percent"] else ""
    return (
        row["joints"],
        outcome,
        f"{row['first_s']}, {row['again_s']}" if row["again_s"] else "",
        torque,
        f"{row['speed_percent']} %" if row["speed_percent"] else "",
        f"{row['apart_mm']} mm" if row["apart_mm"] else "",
        row["data"],
        row["shown"],
    )
