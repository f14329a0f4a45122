"""What a lift depends on: the values of its scenario that a reader thinks in, and the scenario with one changed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from liftopt.assessment.who import who_in
from liftopt.errors import InputError
from liftopt.files.entries import FREE
from liftopt.scenario.model import Scenario
from liftopt.scenario.placement import distance_key, lead, partner
from liftopt.scenario.task import GraspPlace


@dataclass(frozen=True)
class Parameter:
    """Something that a lift depends on.

    Attributes:
        name: in words.
        keys: of the scenario; several move together.
        change: that a reader thinks in, in ``unit``.
        unit: SI unit of both.
    """

    name: str
    keys: tuple[str, ...]
    change: float
    unit: str


def parameters_of(scenario: Scenario) -> tuple[Parameter, ...]:
    """Return what a scenario's lift depends on: everybody's measures, the object, and the task."""
    found: list[Parameter] = []
    for name, agent in scenario.agents.items():
        if agent.kind == "person":
            found.append(Parameter(_of(scenario, name, "stature"), (f"{name}.stature",), 0.01, "m"))
            found.append(Parameter(_of(scenario, name, "body mass"), (f"{name}.mass",), 1.0, "kg"))
    found += [
        Parameter("object mass", ("object.mass",), 0.1, "kg"),
        Parameter("object depth", ("object.depth",), 0.01, "m"),
        *_of_places(scenario),
    ]
    if (away := distance_key(scenario)) is not None:
        first = lead(scenario)
        whence = "feet" if scenario.agents[first].kind == "person" else first
        found.append(Parameter(f"{whence} to {partner(scenario)}", (away,), 0.01, "m"))
    for name, agent in scenario.agents.items():
        if agent.kind == "robot":
            found.append(
                Parameter(_of(scenario, name, "robot base height"), (f"{name}.{agent.height_key}",), 0.01, "m")
            )
    if scenario.limits.spine_compression is not None:
        found.append(Parameter("limit on the spine", ("limits.spine_compression",), 100.0, "N"))
    return (*found, Parameter("duration", ("duration",), 0.1, "s"))


def _of_places(scenario: Scenario) -> Iterator[Parameter]:
    """Yield where the object is at the start and at the end, in the words in which the scenario says it."""
    ends = {"start": scenario.task.start, "end": scenario.task.end}
    for end, place in ends.items():
        yield Parameter(
            f"{end} height", (f"task.{end}.{'height' if isinstance(place, GraspPlace) else 'z'}",), 0.01, "m"
        )
    for what, key in (("grasp from feet", "human_distance"), ("object along X", "x")):
        if keys := tuple(f"task.{end}.{key}" for end, place in ends.items() if key in type(place).model_fields):
            yield Parameter(what, keys, 0.01, "m")


def _of(scenario: Scenario, name: str, what: str) -> str:
    """Return what of an agent is meant; with others of its kind by its name."""
    return what + who_in(scenario.agents, name).of


def changed(scenario: Scenario, parameter: Parameter, change: float) -> Scenario:
    """Return the scenario with all keys of a parameter changed by as much.

    Raises:
        InputError: the change leads out of what a scenario may say.
    """
    values = {key: scenario.value(key) for key in parameter.keys}
    free = [key for key, value in values.items() if not isinstance(value, float)]
    if free:
        raise InputError(free[0], FREE, "is no number that could change")
    return scenario.replace({key: float(value + change) for key, value in values.items()})
