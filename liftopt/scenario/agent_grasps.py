"""From a scenario's holds to the grasps that an agent's model has."""

from __future__ import annotations

import math
from dataclasses import replace

from liftopt.multibody.agent import Agent, Grasp
from liftopt.multibody.dh import rotation_z
from liftopt.multibody.person.anthropometry import link_lengths
from liftopt.multibody.person.holds import along_bar, hand_on
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.robots.sawyer import LEVEL_TOOL
from liftopt.scenario.agents import Person
from liftopt.scenario.grasps import PlacedGrasp, heights_of, placed_grasps
from liftopt.scenario.model import Scenario
from liftopt.scenario.placement import stand_of
from liftopt.scenario.robot import Robot
from liftopt.types import Array

ON_TOP = 1e-3  # [m]
AGAINST_A_SIDE = ("side", "handle")


def with_grasps(scenario: Scenario, agent: Agent) -> Agent:
    """Return an agent whose grasps are named and hold as the scenario says; it has one for each hold already."""
    holds = [hold for hold in placed_grasps(scenario) if hold.agent == agent.name]
    grasps = [
        _grasp(scenario.agents[agent.name], replace(grasp, name=hold.name), _reference(scenario, hold), hold)
        for grasp, hold in zip(agent.grasps, holds, strict=True)
    ]
    return replace(agent, grasps=tuple(grasps))


def _grasp(who: Person | Robot, grasp: Grasp, reference: Array, hold: PlacedGrasp) -> Grasp:
    friction = who.friction if isinstance(who, Person) and who.contact == "flat" else None
    bar = along_bar(reference) if hold.hold == "handle" else None
    grasp = replace(grasp, R_hand_object=reference.T, friction=friction, bar=bar)
    if who.grasp == "point":
        return grasp
    return replace(grasp, moments=True, max_moment=who.max_grasp_moment, max_turn=math.radians(who.grasp_turn_deg))


def _reference(scenario: Scenario, hold: PlacedGrasp) -> Array:
    """Return R_world_hand (3, 3) of a hold on a level object.

    It turns with who holds; a palm on a side, and a fist around a handle there, with that side.
    """
    yaw = stand_of(scenario, hold.agent).yaw_deg
    if hold.hand is None:
        return _turned(LEVEL_TOOL, yaw - 180.0)
    hand = hand_on(hold.hold, hold.hand, holds_from_below(scenario, hold))
    return _turned(hand, 90.0 * hold.quarters if hold.hold in AGAINST_A_SIDE else yaw)


def holds_from_below(scenario: Scenario, hold: PlacedGrasp) -> bool:
    """Whether a fist around a handle comes from below, as forearms do where it is higher than the elbows.

    That is told by the mean of both ends of the lift and by upper arms that hang: nobody changes the grip on the way.
    There is no room below a handle on top of the object.
    """
    person = scenario.agents[hold.agent]
    if hold.hold != "handle" or not isinstance(person, Person):
        return False
    if hold.point[2] > scenario.object.height / 2.0 - ON_TOP:
        return False
    lengths = link_lengths(Subject(person.stature, person.mass, person.sex))
    return sum(heights_of(scenario, hold.point)) / 2.0 > lengths.l1 + lengths.l2 - lengths.l4


def _turned(rotation: Array, about_z_deg: float) -> Array:
    return rotation_z(math.radians(about_z_deg))[:3, :3] @ rotation if about_z_deg else rotation
