"""Where on the object each hand and each robot holds it: as given, by the name of a place, or at the edge before it.

A place is meant as its agent sees it: the near face of the box is the one across which the agent looks ahead, right and
left are the agent's own.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from liftopt.errors import NO_VALUE, InputError
from liftopt.multibody.edges import Hold, Point
from liftopt.scenario.agents import Person
from liftopt.scenario.box import HeldAt
from liftopt.scenario.fields import ScenarioFields
from liftopt.scenario.hands import Hand
from liftopt.scenario.placement import lead, partner, stand_of
from liftopt.scenario.task import GraspPlace, ObjectPlace

# How far in from the edge the middle of a hand underneath is, and a handle is below the top [m]; of a small box a
# quarter of it. Both are choices of this model. The wrist is 67 to 97 mm behind the middle of the hand (a woman of 1.5,
# a man of 1.95 m): it has to be outside the box by the forearm's thickness where the forearm comes from above.
UNDERNEATH, BELOW_TOP = 0.02, 0.05
SIDE_OF: dict[Hand | None, float] = {"right": -1.0, "left": 1.0}


class PlacedGrasp(NamedTuple):
    """One hold on the object.

    Attributes:
        name: in results: the agent's, with the hand's if two hold (``"human_right"``).
        agent: whose it is.
        hand: of a person; None of a robot.
        hold: how it holds; what names coupling, shapes of hands and the like go by.
        point: in the object's axes from its centre [m].
        quarters: quarter turns about Z from the object's X to the way ahead as the near face has it.
    """

    name: str
    agent: str
    hand: Hand | None
    hold: Hold
    point: Point
    quarters: int


def grasp_names(scenario: ScenarioFields) -> dict[str, tuple[str, Hand | None]]:
    """Return the agent and the hand of each grasp by its name, in the agents' order, a right hand first."""
    names: dict[str, tuple[str, Hand | None]] = {}
    for name, agent in scenario.agents.items():
        hands = agent.hands if isinstance(agent, Person) else (None,)
        for hand in hands:
            names[name if len(hands) == 1 else f"{name}_{hand}"] = (name, hand)
    return names


def placed_grasps(scenario: ScenarioFields) -> tuple[PlacedGrasp, ...]:
    """Return all holds on the object, in the agents' order, a right hand first.

    Raises:
        InputError: somebody cannot hold it there.
    """
    return tuple(_placed(scenario, name, *whose) for name, whose in grasp_names(scenario).items())


def grasp_points(scenario: ScenarioFields) -> dict[str, Point]:
    """Return where each grasp is, in the object's axes from its centre [m], in the order of ``placed_grasps``."""
    return {grasp.name: grasp.point for grasp in placed_grasps(scenario)}


def middle_of_hands(scenario: ScenarioFields, agent: str) -> Point:
    """Return the middle of where an agent holds the object, in the object's axes from its centre [m]."""
    points = [grasp.point for grasp in placed_grasps(scenario) if grasp.agent == agent]
    x, y, z = (sum(column) / len(points) for column in zip(*points, strict=True))
    return x, y, z


def middle_of_grasps(scenario: ScenarioFields) -> Point:
    """Return the point midway between the hands of the lead and what the partner holds, as ``middle_of_hands``."""
    first, opposite = lead(scenario), partner(scenario)
    one, other = (middle_of_hands(scenario, name) for name in (first, opposite or first))
    x, y, z = ((a + b) / 2.0 for a, b in zip(one, other, strict=True))
    return x, y, z


def grasp_heights(scenario: ScenarioFields) -> tuple[float, float]:
    """Return how high the middle of the grasps is at the start and at the end [m]."""
    return heights_of(scenario, middle_of_grasps(scenario))


def height_words(scenario: ScenarioFields) -> str:
    """Return what it is whose height ``grasp_heights`` gives, in words."""
    under = -scenario.object.height / 2.0
    at_edges = all(z == under for _, _, z in grasp_points(scenario).values())
    return "the edges they hold" if at_edges else "where they hold it, midway"


def heights_of(scenario: ScenarioFields, point: Point) -> tuple[float, float]:
    """Return how high a point of the object, in its axes from its centre, is at the start and at the end [m]."""
    start, end = (_height(scenario, place, point) for place in (scenario.task.start, scenario.task.end))
    return start, end


def _height(scenario: ScenarioFields, place: GraspPlace | ObjectPlace, point: Point) -> float:
    (x, _, z), above = point, 0.0
    if isinstance(place, GraspPlace):
        known = middle_of_grasps(scenario)
        if point == known:
            return place.height
        x, z, above = x - known[0], z - known[2], place.height
    else:
        above = place.z
    pitch = math.radians(place.pitch_deg)
    return above + z * math.cos(pitch) - x * math.sin(pitch)


def _placed(scenario: ScenarioFields, name: str, agent: str, hand: Hand | None) -> PlacedGrasp:
    given, quarters = scenario.object.grasps.get(name, "edge"), _quarters(scenario, agent)
    point = given if isinstance(given, tuple) else None
    hold: Hold = given if isinstance(given, str) else "edge"
    if isinstance(given, HeldAt):
        hold, point = given.place, given.position
    if hand is None and hold != "edge":
        raise InputError(f"object.grasps.{name}", hold, 'must be "edge" or [x, y, z] for a robot')
    if point is None:
        across, along = scenario.object.width, scenario.object.depth
        if quarters % 2:
            across, along = along, across
        size = (along, across, scenario.object.height)
        side = SIDE_OF.get(hand, 0.0)
        spread = _spread(scenario, agent, across) if hold in ("edge", "bottom") else across / 2.0
        point = _turned(_near(hold, size, side * spread), quarters)
    return PlacedGrasp(name, agent, hand, hold, point, quarters)


def _quarters(scenario: ScenarioFields, agent: str) -> int:
    """Return which way an agent holds on: along the one of the object's axes that is nearest to the agent's heading.

    The two who stand opposite each other hold opposite edges, whichever of both ways along X they face.
    """
    quarters = round(stand_of(scenario, agent).yaw_deg / 90.0) % 4
    if quarters % 2 == 0:
        return {lead(scenario): 0, partner(scenario): 2}.get(agent, quarters)
    return quarters


def _near(hold: Hold, size: tuple[float, float, float], left: float) -> Point:
    """Return a place on a box of a size (along the way ahead, across, up), in axes ahead, left and up.

    Args:
        hold: the name of the place.
        size: of the box [m].
        left: of the middle, where the hand is [m].
    """
    along, _, height = size
    ahead, up = -along / 2.0, -height / 2.0
    if hold == "bottom":
        ahead += min(UNDERNEATH, along / 4.0)
    if hold in ("side", "handle"):
        ahead, up = 0.0, 0.0
    if hold == "handle":
        up = height / 2.0 - min(BELOW_TOP, height / 4.0)
    return ahead, left, up


def _turned(point: Point, quarters: int) -> Point:
    """Return a point turned about Z by quarter turns, exactly."""
    x, y, z = point
    for _ in range(quarters):
        x, y = -y, x
    return x + 0.0, y + 0.0, z  # no negative zeros


def _spread(scenario: ScenarioFields, name: str, across: float) -> float:
    """Return how far from the middle of an edge of a length each of an agent's hands holds [m].

    One hand, and a robot, holds in the middle. Two hands are a shoulder's breadth apart; on a narrower edge they are at
    its ends, with the whole breadth of the hand on it. That is a choice of this model: what is published (Drury, 1980)
    says of heavy loads that both hands are to be placed alike, which needs the least force of the arms.

    Raises:
        InputError: the edge is too short for two hands.
    """
    person = scenario.agents[name]
    if not isinstance(person, Person) or len(person.hands) == 1:
        return 0.0
    # With NumPy, which most scenarios are checked without.
    from liftopt.multibody.person.anthropometry import dimension
    from liftopt.multibody.person.subject import Subject

    subject = Subject(person.stature, person.mass, person.sex)
    shoulders, hand = (dimension(subject, which) for which in ("biacromialbreadth", "handbreadth"))
    if across < 2.0 * hand:
        raise InputError(
            f"object.grasps.{name}_right",
            NO_VALUE,
            f"two hands of {1e3 * hand:.0f} mm are too broad for an edge of {1e3 * across:.0f} mm; give both a place "
            f'such as "side", or {name}.hands = ["right"]',
        )
    return round(min(shoulders, across - hand) / 2.0, 3)
