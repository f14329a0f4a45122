"""Tables of the documentation, made from the code: keys, variables, names, rooms, commands."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

GALLERY = (
    "default_lift",
    "another_object",
    "who_lifts",
    "two_readings",
    "weights",
    "wrench_grasps",
    "sensitivity",
    "pareto",
    "replanning",
    "whole_person",
    "two_people",
    "two_robots",
    "robots_alone",
)


def gallery_place(filename: str) -> int:
    """Return the place of an example in the gallery."""
    return GALLERY.index(Path(filename).stem)


def table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(str(cell).replace('|', '&#124;') for cell in line)} |" for line in lines) + "\n"


def write_tables(folder: Path) -> None:
    """Write every table as a Markdown file into a folder, which is made, for pages to include."""
    from tables.checked_robots import checked_robots, checked_table1
    from tables.commands import commands
    from tables.faulty_robots import faulty_robots
    from tables.json_keys import json_keys
    from tables.names import urdf_names
    from tables.presets import presets
    from tables.result import attributes, solution_attributes, variables
    from tables.rooms import rooms
    from tables.scenario import scenario_keys
    from tables.terminal import terminal

    folder.mkdir(parents=True, exist_ok=True)
    told = (
        scenario_keys, presets, variables, attributes, solution_attributes, json_keys, urdf_names, rooms, commands,
        terminal, faulty_robots, checked_robots, checked_table1,
    )  # fmt: skip
    for make in told:
        (folder / f"{make.__name__}.md").write_text(make(), encoding="utf-8")
