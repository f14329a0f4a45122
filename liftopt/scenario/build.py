"""From a scenario to what the optimal-control problem knows: agents, object and task."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping
from dataclasses import replace

import numpy as np

from liftopt.collocation.spline import RestToRestSpline
from liftopt.collocation.task import LiftTask
from liftopt.multibody.agent import Agent, Grasp, LiftedObject
from liftopt.multibody.dh import rotation_z
from liftopt.multibody.person.human import HAND_UNDER_EDGE, Subject, human_agent
from liftopt.multibody.placement import Placement
from liftopt.multibody.robots.sawyer import LEVEL_TOOL, sawyer_agent
from liftopt.multibody.solids import Solid, placed_box
from liftopt.multibody.table import lifted_table
from liftopt.scenario.agents import Person, Robot
from liftopt.scenario.model import Scenario
from liftopt.scenario.placement import grasp_points, lead, stand_of
from liftopt.scenario.task import GraspPlace, ObjectPlace
from liftopt.types import Array

OBJECT_SPEED = 2.0  # [m/s] and [rad/s], each coordinate: a safe pace beside a person
ROOM = 5.0  # [m]: half the width of the room the object may move in
PACE = 2.0  # [s]: duration of the lift that the weight of accelerations is stated for


def agents_of(scenario: Scenario, urdfs: Mapping[str, str] | None = None) -> tuple[Agent, ...]:
    """Return everybody who lifts, in the scenario's order.

    Args:
        scenario: who they are.
        urdfs: name -> text of the models if they were written before, as a solution keeps them.

    Raises:
        InputError: a model cannot be what the scenario says.
    """
    return tuple(agent_of(scenario, name, urdfs) for name in scenario.agents)


def agent_of(scenario: Scenario, name: str, urdfs: Mapping[str, str] | None = None) -> Agent:
    """Return the agent of that name; ``urdfs`` as in ``agents_of``."""
    who, urdf = scenario.agents[name], (urdfs or {}).get(name)
    stand = stand_of(scenario, name)
    place = Placement.at(*stand)
    if isinstance(who, Person):
        friction = who.friction if who.contact == "flat" else None
        person = human_agent(subject_of(who), urdf, name=name, place=place)
        holds = [_grasp(grasp, who, HAND_UNDER_EDGE, stand.yaw_deg) for grasp in person.grasps]
        return replace(person, grasps=tuple(replace(hold, friction=friction) for hold in holds))
    robot = sawyer_agent(
        place=place,
        base_height=who.height,
        tool_length=who.tool.length,
        tool_mass=who.tool.mass,
        urdf=urdf,
        name=name,
    )
    return replace(robot, grasps=tuple(_grasp(grasp, who, LEVEL_TOOL, stand.yaw_deg - 180.0) for grasp in robot.grasps))


def agent_key(scenario: Scenario, name: str) -> Hashable:
    """Return all that an agent's model depends on: two scenarios with equal keys give the same agent."""
    who = scenario.agents[name]
    return name, tuple(value for key, value in who if key != "weight"), stand_of(scenario, name)


def object_key(scenario: Scenario) -> Hashable:
    """Return all that the object's model depends on, as ``agent_key`` does."""
    return scenario.object, tuple(grasp_points(scenario).items())


def subject_of(person: Person) -> Subject:
    """Return the body that a scenario's person has."""
    return Subject(person.stature, person.mass, person.sex)


def object_of(scenario: Scenario, urdfs: Mapping[str, str] | None = None) -> LiftedObject:
    """Return the object, held in the agents' order; ``urdfs`` as in ``agents_of``."""
    box = scenario.object
    return lifted_table(
        mass=box.mass,
        depth=box.depth,
        width=box.width,
        height=box.height,
        urdf=(urdfs or {}).get(box.name),
        name=box.name,
        grasps=grasp_points(scenario),
    )


def obstacles_of(scenario: Scenario) -> tuple[Solid, ...]:
    """Return the obstacles of a scenario as solids in the world; the floor is none of them."""
    return tuple(
        placed_box(str(obstacle.name), obstacle.box, obstacle.position, math.radians(obstacle.yaw_deg))
        for obstacle in scenario.obstacles
    )


def task_of(scenario: Scenario) -> LiftTask:
    """Return the task: poses at both ends by the height and tilt of the grasp points, sideways free."""
    limits, objective = scenario.limits, scenario.objective
    pitch, yaw = math.radians(limits.table_pitch_deg), math.radians(limits.table_yaw_deg)
    # Point grasps on one line along X cannot turn the object about it: its roll is locked.
    lines = {(y, z) for _, y, z in grasp_points(scenario).values()}
    turnable = len(lines) > 1 or any(agent.grasp == "wrench" for agent in scenario.agents.values())
    roll = math.radians(limits.table_roll_deg) if turnable else 0.0
    return LiftTask(
        duration=scenario.duration,
        start=_pose(scenario, scenario.task.start),
        end=_pose(scenario, scenario.task.end),
        pose_lower=np.array([-ROOM, -ROOM, 0.0, -roll, -pitch, -yaw]),
        pose_upper=np.array([ROOM, ROOM, ROOM, roll, pitch, yaw]),
        pose_velocity=np.full(6, OBJECT_SPEED),
        agent_weights=tuple(agent.weight for agent in scenario.agents.values()),
        acceleration_weight=objective.acceleration_weight,
        force_weight=objective.force_weight,
        range_weight=objective.range_weight,
        tilt_weight=objective.tilt_weight,
        shares=objective.preset == "natural",
        pace=_pace(scenario),
        max_grasp_force=limits.max_grasp_force,
        balance_tolerance=limits.balance_tolerance,
    )


def _pace(scenario: Scenario) -> float:
    """Return the factor on squared accelerations: in preset natural, a slow lift is as smooth as a fast one.

    People move along the same path with the same profile of speed whatever their pace and load (Atkeson &
    Hollerbach, 1985, J Neurosci 5:2318-2330). Accelerations fall with the square of the duration, so that the same
    smoothness costs the same beside effort and posture if their squares count with its fourth power.
    """
    return (scenario.duration / PACE) ** 4 if scenario.objective.preset == "natural" else 1.0


def motions_of(scenario: Scenario, intervals: int | None = None) -> RestToRestSpline:
    """Return the motions that a scenario allows: at rest at both ends as it asks, on its intervals or on others."""
    return RestToRestSpline(scenario.solver.intervals if intervals is None else intervals, scenario.task.rest)


def _grasp(grasp: Grasp, who: Person | Robot, reference: Array, turn_deg: float) -> Grasp:
    """Return someone's grasp as the scenario has it.

    Args:
        grasp: which one.
        who: holds the object.
        reference: (3, 3) the hand's orientation in the world on a level object, of one who stands as by default.
        turn_deg: how far from that it stands turned, about Z.
    """
    if turn_deg:
        reference = rotation_z(math.radians(turn_deg))[:3, :3] @ reference
    if who.grasp == "point":
        return replace(grasp, R_hand_object=reference.T)
    turn = math.radians(who.grasp_turn_deg)
    return replace(grasp, moments=True, max_moment=who.max_grasp_moment, max_turn=turn, R_hand_object=reference.T)


def _pose(scenario: Scenario, place: GraspPlace | ObjectPlace) -> Array:
    """Return the pose of the centre of mass: the object's own, or from where the grasp points are.

    ``height`` is midway between them, ``human_distance`` the lead's. The centre of mass lies half the box's height off
    that middle, along the body's Z axis; half the depth along its X axis leads there from the lead's grasp point.
    """
    if isinstance(place, ObjectPlace):
        x, y = (np.nan if value is None else value for value in (place.x, place.y))
        return np.array([x, y, place.z, 0.0, math.radians(place.pitch_deg), 0.0])
    box, pitch, feet = scenario.object, math.radians(place.pitch_deg), stand_of(scenario, lead(scenario))
    forward = (box.depth * math.cos(pitch) + box.height * math.sin(pitch)) / 2
    ahead = np.nan if place.human_distance is None else feet.x + (place.human_distance + forward)
    return np.array([ahead, np.nan, place.height + box.height / 2 * math.cos(pitch), 0.0, pitch, 0.0])
