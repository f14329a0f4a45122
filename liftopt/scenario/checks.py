"""What the entries of a scenario must agree on."""

from __future__ import annotations

from typing import TYPE_CHECKING

from liftopt.errors import NO_VALUE, InputError

if TYPE_CHECKING:
    from liftopt.scenario.model import Scenario

# What results call otherwise: attributes objective_<agent>, and the sections beside the agents.
TAKEN = ("acceleration", "force", "limit", "error", "bar", "schema", "table")


def check(scenario: Scenario) -> None:
    """Raise ``InputError`` where two entries of a scenario contradict each other."""
    _check_names(scenario)
    _check_weights(scenario)
    for end in ("start", "end"):
        _check_place(scenario, end)


def _check_names(scenario: Scenario) -> None:
    taken = {*TAKEN, *type(scenario).model_fields, scenario.object.name}
    for name in scenario.agents:
        if name in taken:
            raise InputError(f"agents.{name}", NO_VALUE, f"{name!r} is taken; give the agent another name")


def _check_weights(scenario: Scenario) -> None:
    weights = {f"{name}.weight": agent.weight for name, agent in scenario.agents.items()}
    objective = scenario.objective
    weights |= {
        "acceleration_weight": objective.acceleration_weight,
        "force_weight": objective.force_weight,
    }
    if not any(weights.values()):
        raise InputError("objective", weights, "at least one weight must be above 0")


def _check_place(scenario: Scenario, end: str) -> None:
    task, most = scenario.task, scenario.limits.table_pitch_deg
    place = getattr(task, end)
    if abs(place.pitch_deg) > most:
        allowed = f"must be from {-most:g} to {most:g} deg, or raise limits.table_pitch_deg"
        raise InputError(f"task.{end}.pitch_deg", place.pitch_deg, allowed)
    distance: float | None = place.human_distance
    room = task.standing_distance - scenario.object.depth
    if (distance or 0.0) >= room:
        where = f"standing_distance {task.standing_distance:g} m, object.depth {scenario.object.depth:g} m"
        raise InputError(
            f"task.{end}.human_distance",
            "free" if distance is None else distance,
            f"must be below {room:g} m, or the object reaches behind the robot's base ({where})",
        )
