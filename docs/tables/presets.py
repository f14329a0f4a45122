"""What the presets of the objective differ in, from the code."""

from __future__ import annotations

import liftopt as lo
from liftopt.scenario.presets import DEFAULTS, defaults_at
from tables import table


def presets() -> str:
    """Return the keys that a preset brings, with their meaning and the value that each preset gives them."""
    scenario, rows = lo.load_scenario(), []
    for key, what in scenario.describe():
        first, _, rest = key.partition(".")
        kind = scenario.agents[first].kind if first in scenario.agents else first
        if values := defaults_at(f"{kind}.{rest}"):
            rows.append((f"`{key}`", what.partition(": ")[0], *(f"`{value}`" for value in values.values())))
    return table(("key", "meaning", *(f"`{preset}`" for preset in DEFAULTS)), rows)
