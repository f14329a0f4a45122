"""What a scenario says of a wrong entry: its key, the value and what is allowed, and what may have been meant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import BaseModel

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.section import keys_of, refusal_at, section_at, shown_key
from liftopt.files.suggestions import did_you_mean
from liftopt.scenario.agents import KINDS
from liftopt.scenario.keys import AGENTS, OBSTACLES
from liftopt.scenario.listing import DEFAULT_TEAM, fields_of
from liftopt.scenario.meant import nearest_keys
from liftopt.scenario.obstacles import Obstacle, name_of
from liftopt.scenario.task import PLACED, PLACES

ENDS = (["task", "start"], ["task", "end"])
BESIDE = {key for section in PLACES.values() for key in section.model_fields}
PLACED_BY = "must be a section with either height and human_distance, or x, y and z"
A_KIND = " or ".join(f'"{kind}"' for kind in KINDS) + " (what the agent is)"


def refusal(of: type[BaseModel], fault: Mapping[str, Any], values: Mapping[str, Any]) -> InputError:
    """Return the error of a fault that pydantic found in a scenario.

    Args:
        of: the model of a scenario.
        fault: as pydantic describes it.
        values: that were checked.
    """
    place, kind, value = list(fault["loc"]), fault["type"], fault["input"]
    if kind == "extra_forbidden" and place[:2] in ENDS and any(place[3:] == [key] for key in BESIDE):
        return InputError(
            ".".join((*place[:2], place[3])), value, f"cannot stand beside the others; task.{place[1]} {PLACED_BY}"
        )
    if kind == "extra_forbidden" and place[0] in DEFAULT_TEAM and AGENTS not in values:  # as in schema 1
        return InputError(
            place[0], NO_VALUE, f"unknown key; in schema 2 it is a table of an agent, [agents.{place[0]}]"
        )
    if place[0] == OBSTACLES and len(place) > 2:
        name = name_of(values.get(OBSTACLES), place[1])
        return refusal_at(Obstacle, tuple(place[2:]), kind, value, f"{OBSTACLES}.{name}.")
    if kind == "extra_forbidden":
        return _unknown(of, _without_tags(place), value, _kinds_in(values.get(AGENTS)))
    if place[:2] in ENDS and len(place) > 2:
        inside = tuple(place[3:])
        if not inside:
            return InputError(".".join(place[:2]), value, f"must be {PLACED}")
        return refusal_at(PLACES[place[2]], inside, kind, value, ".".join(place[:2]) + ".")
    if place[0] != AGENTS or len(place) == 1:
        return refusal_at(of, tuple(place), kind, value)
    name, *rest = place[1:]
    name = shown_key(str(name))
    if rest:
        return refusal_at(KINDS[str(rest[0])], tuple(rest[1:]), kind, value, f"{name}.")
    if not isinstance(value, Mapping):
        return InputError(name, value, f"must be a section of an agent, with its kind: {A_KIND}")
    if "kind" not in value:
        return InputError(f"{name}.kind", NO_VALUE, f"is missing; must be {A_KIND}")
    return InputError(f"{name}.kind", value["kind"], f"must be {A_KIND}")


def _unknown(of: type[BaseModel], place: Sequence[Any], value: Any, team: Mapping[str, str]) -> InputError:
    """Return the error for an unknown key, with those that may have been meant, or that are known beside it."""
    known = [key for key, _ in fields_of(of, team)]
    outer = ".".join(map(str, place[:-1]))
    beside = [key.rpartition(".")[2] for key in known if key.rpartition(".")[0] == outer]
    if not outer:
        beside = ["schema", *of.model_fields]
    if isinstance(value, Mapping) and value:
        # Of a section that is not known its first entry says more than all of it.
        inner, value = next(iter(value.items()))
        place = [*place, inner]
    inside = section_at(KINDS[team[place[0]]], place[1:-1]) if place[0] in team and len(place) > 2 else None
    if not beside and inside is not None:  # as of a joint, by its name
        known, beside = [f"{outer}.{key}" for key in keys_of(inside)], list(keys_of(inside))
    meant = nearest_keys(".".join(map(str, place)), [*known, *team], team)
    offer = did_you_mean(meant) or "; known here: " + ", ".join(beside)
    return InputError(".".join(shown_key(str(part)) for part in place), value, "unknown key" + offer)


def _without_tags(place: Sequence[Any]) -> list[Any]:
    """Return the keys of a fault as a user writes them: an agent by its name, no name of a kind."""
    if place[0] == AGENTS and len(place) > 2:
        return [place[1], *place[3:]]
    return [*place[:2], *place[3:]] if list(place[:2]) in ENDS and len(place) > 2 else list(place)


def _kinds_in(agents: object) -> dict[str, str]:
    """Return the kind of every agent by its name as far as they are right; the default team where there is none."""
    found: dict[str, str] = {}
    for name, agent in agents.items() if isinstance(agents, Mapping) else ():
        kind = agent.get("kind") if isinstance(agent, Mapping) else getattr(agent, "kind", None)
        if kind in KINDS:
            found[str(name)] = str(kind)
    return found or DEFAULT_TEAM
