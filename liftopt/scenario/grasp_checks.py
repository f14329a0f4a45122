"""What a scenario may say of hands and of where they hold the object."""

from __future__ import annotations

from itertools import combinations
from math import dist

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.suggestions import did_you_mean, nearest
from liftopt.scenario.agents import Person
from liftopt.scenario.fields import ScenarioFields
from liftopt.scenario.grasps import PlacedGrasp, grasp_names, placed_grasps

SAME_PLACE = 1e-3  # [m]
BESIDE = 0.10  # [m]: how far outside the box a grasp may be, on a handle that sticks out
A_PLACE = "[x, y, z] from the object's centre in its axes"
FROM_BELOW = ("edge", "bottom", "corner")


def check_grasps(scenario: ScenarioFields) -> None:
    """Raise ``InputError`` where hands cannot hold as a scenario says."""
    _check_hands(scenario)
    names = grasp_names(scenario)
    for name in scenario.object.grasps:
        if name not in names:
            raise InputError(f"object.grasps.{name}", NO_VALUE, f"is the grasp of nobody{_meant(scenario, name)}")
    grasps = placed_grasps(scenario)
    for grasp in grasps:
        _check_point(scenario, grasp)
        agent = scenario.agents[grasp.agent]
        if isinstance(agent, Person) and agent.contact == "flat" and grasp.hold not in FROM_BELOW:
            allowed = " or ".join(f'"{hold}"' for hold in FROM_BELOW)
            raise InputError(
                f"object.grasps.{grasp.name}", grasp.hold, f"must be {allowed} for a flat hand, which only pushes up"
            )
    _check_line(scenario, grasps)
    for one, other in combinations(grasps, 2):
        if dist(one.point, other.point) < SAME_PLACE:
            _refuse_one_place(scenario, one, other)


def _check_hands(scenario: ScenarioFields) -> None:
    for name, agent in scenario.agents.items():
        if not isinstance(agent, Person):
            continue
        if agent.body == "arm" and agent.hands != ("right",):
            raise InputError(
                f"{name}.hands", list(agent.hands), 'must be ["right"] of an arm; set body = "whole" for the left hand'
            )
        taken = [f"{name}_{hand}" for hand in agent.hands if f"{name}_{hand}" in scenario.agents]
        if len(agent.hands) > 1 and taken:
            raise InputError("agents", taken[0], f"is the name of a hand of {name}; give the agent another one")


def _meant(scenario: ScenarioFields, name: str) -> str:
    names = grasp_names(scenario)
    own = [grasp for grasp, (agent, _) in names.items() if agent == name]
    offer = did_you_mean(own or nearest(name, names))
    return offer or f"; there are {', '.join(names)}"


def _check_point(scenario: ScenarioFields, grasp: PlacedGrasp) -> None:
    box = scenario.object
    size = (box.depth, box.width, box.height)
    for axis, at, edge in zip("xyz", grasp.point, size, strict=True):
        most = edge / 2.0 + BESIDE
        if abs(at) > most:
            raise InputError(
                f"object.grasps.{grasp.name}",
                list(grasp.point),
                f"{axis} must be from {-most:g} to {most:g} m, at most {BESIDE:g} m outside the object",
            )


def _check_line(scenario: ScenarioFields, grasps: tuple[PlacedGrasp, ...]) -> None:
    """Raise ``InputError`` where forces act along one line only and the object's weight beside it."""
    if len(grasps) < 2 or any(agent.grasp == "wrench" for agent in scenario.agents.values()):
        return
    points = [grasp.point for grasp in grasps]
    for which, beside in ((0, 1), (1, 0)):
        others = {point[:which] + point[which + 1 :] for point in points}
        if len(others) == 1 and abs(points[0][beside]) > SAME_PLACE:
            raise InputError(
                f"{grasps[0].agent}.grasp",
                "point",
                f"forces on one line along {'XY'[which]} do not hold an object whose weight is beside it; must be "
                '"wrench", or give object.grasps elsewhere',
            )


def _refuse_one_place(scenario: ScenarioFields, one: PlacedGrasp, other: PlacedGrasp) -> None:
    """Raise ``InputError``: two grasps are at one point, by the key of one that a user may say or has said."""
    given = scenario.object.grasps
    wrong, there = (one, other) if one.name in given and other.name not in given else (other, one)
    value, said = (list(wrong.point), "is") if wrong.name in given else (NO_VALUE, "is missing: by default it is")
    raise InputError(
        f"object.grasps.{wrong.name}", value, f"{said} where {there.name} holds; must be {A_PLACE}, apart from it"
    )
