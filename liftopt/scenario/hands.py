"""Which hands of a person hold: by default those that the body has."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from typing import Any, Literal, get_args

Body = Literal["arm", "whole"]
Hand = Literal["right", "left"]
BOTH: tuple[Hand, ...] = get_args(Hand)  # in the order of results
OF_BODY: dict[str, tuple[Hand, ...]] = {"arm": ("right",), "whole": BOTH}
BODY, HANDS, AGENTS = "body", "hands", "agents"


def in_order(hands: tuple[Hand, ...]) -> tuple[Hand, ...]:
    """Return hands with the right one first.

    Raises:
        ValueError: one is there twice.
    """
    if len(set(hands)) < len(hands):
        raise ValueError("each hand once")
    return tuple(hand for hand in BOTH if hand in hands)


def with_hands(person: object) -> object:
    """Return a person's entries with the hands that hold as the body has it; wrong ones stay wrong."""
    if not isinstance(person, Mapping) or HANDS in person:
        return person
    hands = OF_BODY.get(str(person.get(BODY)), OF_BODY["arm"])
    return {**person, HANDS: hands}


def without_hands(tables: Mapping[str, Any], changed: Mapping[str, Any]) -> dict[str, Any]:
    """Return a copy of a scenario's tables without the hands of those who are to have another body.

    Args:
        tables: of the scenario.
        changed: the same after a change.
    """
    copy = deepcopy(dict(tables))
    for name, agent in _agents(copy).items():
        after = _agents(changed).get(name)
        if isinstance(agent, dict) and isinstance(after, Mapping) and agent.get(BODY, "arm") != after.get(BODY, "arm"):
            agent.pop(HANDS, None)
    return copy


def _agents(tables: Mapping[str, Any]) -> Mapping[str, Any]:
    agents = tables.get(AGENTS)
    return agents if isinstance(agents, Mapping) else {}
