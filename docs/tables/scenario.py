"""Every key of a scenario, from the models."""

from __future__ import annotations

import liftopt as lo
from tables import table

HEAD = ("key", "meaning", "allowed", "default")


def scenario_keys() -> str:
    """Return one table a section: key, meaning, what is allowed, default. Agents stand under their names."""
    scenario = lo.load_scenario()
    sections: dict[str, list[tuple[str, ...]]] = {}
    for key, what in scenario.describe():
        about, _, allowed = what.partition(": ")
        allowed, _, default = allowed.partition("; default ")
        row = (f"`{key}`", about, allowed, f"`{default}`" if default else "")
        sections.setdefault(key.rpartition(".")[0], []).append(row)
    parts = []
    for section, rows in sections.items():
        agent, _, inside = section.partition(".")
        who = scenario.agents.get(agent)
        place = f"agents.{section}" if who else section
        title = f"`[{place}]`" if section else "Top level"
        if who and not inside:
            title += f", a {who.kind}"
        parts.append(f"### {title}\n\n{table(HEAD, rows)}")
    return "\n".join(parts)
