"""Every key of a scenario, from the models."""

from __future__ import annotations

from itertools import groupby

from liftopt.scenario.model import Scenario
from liftopt.scenario.schema import describe
from tables import table


def scenario_keys() -> str:
    """Return one table a section: key, meaning, what is allowed, default."""
    parts = []
    for section, entries in groupby(describe(Scenario), key=lambda entry: entry[0].rpartition(".")[0]):
        rows = []
        for key, what in entries:
            about, _, allowed = what.partition(": ")
            allowed, _, default = allowed.partition("; default ")
            rows.append((f"`{key}`", about, allowed, f"`{default}`" if default else ""))
        parts.append(f"### {section or 'Top level'}\n\n{table(('key', 'meaning', 'allowed', 'default'), rows)}")
    return "\n".join(parts)
