"""What an agent's effort is, in words: its part of the objective, which presets measure differently."""

from __future__ import annotations

from dataclasses import dataclass

from liftopt.scenario.model import Scenario


@dataclass(frozen=True)
class Effort:
    """An agent's part of the objective, as everybody tells it.

    Attributes:
        about: what it is.
        formula: the same as a formula.
        unit: of it, in plain text.
        signs: the unit with superscripts.
        key: the unit at the end of a key.
        decimals: that a table shows.
    """

    about: str
    formula: str
    unit: str
    signs: str
    key: str
    decimals: int


EFFORTS = {
    "paper": Effort("integral of squared joint torques", "∫ Σ τ² dt", "N2 m2 s", "N² m² s", "N2m2s", 1),
    "natural": Effort(
        "integral of squared joint torques as shares of strength", "∫ Σ (τ / strength)² dt", "s", "s", "s", 3
    ),
}


def effort_in(scenario: Scenario) -> Effort:
    """Return what effort is in a scenario."""
    return EFFORTS[scenario.objective.preset]
