"""From a scenario to what the optimal-control problem knows: agents, object and task."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping

import numpy as np

from liftopt.collocation.spline import RestToRestSpline
from liftopt.collocation.task import LiftTask
from liftopt.multibody.agent import Agent, LiftedObject
from liftopt.multibody.person.human import Subject, human_agent
from liftopt.multibody.person.whole_body import whole_human_agent
from liftopt.multibody.placement import Placement
from liftopt.multibody.solids import Solid, placed_box
from liftopt.multibody.table import lifted_table
from liftopt.scenario.agent_grasps import holds_from_below, with_grasps
from liftopt.scenario.agents import Person
from liftopt.scenario.grasps import grasp_points, middle_of_grasps, middle_of_hands, placed_grasps
from liftopt.scenario.model import Scenario
from liftopt.scenario.placement import lead, stand_of
from liftopt.scenario.robot import Robot
from liftopt.scenario.robot_agents import agent_of_robot
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
    return with_grasps(scenario, _bare_agent(scenario, name, (urdfs or {}).get(name)))


def _bare_agent(scenario: Scenario, name: str, urdf: str | None) -> Agent:
    """Return the agent with grasps that are not yet what the scenario says of them."""
    who = scenario.agents[name]
    if isinstance(who, Robot):
        return agent_of_robot(scenario, name, urdf)
    place = Placement.at(*stand_of(scenario, name))
    if who.body == "arm":
        return human_agent(subject_of(who), urdf, name=name, place=place)
    most = scenario.limits.spine_compression
    return whole_human_agent(subject_of(who), urdf, name=name, place=place, hands=who.hands, compression=most)


def agent_key(scenario: Scenario, name: str) -> Hashable:
    """Return all that an agent's model depends on: two scenarios with equal keys give the same agent."""
    own = [hold for hold in placed_grasps(scenario) if hold.agent == name]
    holds = tuple((hold.name, hold.hold, hold.quarters, holds_from_below(scenario, hold)) for hold in own)
    entries = tuple(value for key, value in scenario.agents[name] if key != "weight")
    limit = scenario.limits.spine_compression if scenario.agents[name].kind == "person" else None
    return name, entries, stand_of(scenario, name), holds, scenario.objective.preset, limit


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
    turns = [math.radians(most) for most in (limits.table_roll_deg, limits.table_pitch_deg, limits.table_yaw_deg)]
    if (locked := _unturnable_axis(scenario)) is not None:
        turns[locked] = 0.0
    roll, pitch, yaw = turns
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
        spine_weight=objective.spine_weight,
        shares=objective.preset == "natural",
        pace=_pace(scenario),
        max_grasp_force=limits.max_grasp_force,
        balance_tolerance=limits.balance_tolerance,
    )


def _unturnable_axis(scenario: Scenario) -> int | None:
    """Return about which of its axes nobody can turn the object: point grasps on one line cannot about that line."""
    if any(agent.grasp == "wrench" for agent in scenario.agents.values()):
        return None
    points = list(grasp_points(scenario).values())
    return next((axis for axis in range(3) if len({point[:axis] + point[axis + 1 :] for point in points}) == 1), None)


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


def _pose(scenario: Scenario, place: GraspPlace | ObjectPlace) -> Array:
    """Return the pose of the centre of mass: the object's own, or from where the grasps are.

    ``height`` is midway between the lead's hands and the partner's, ``human_distance`` that of the middle of the
    lead's.
    """
    if isinstance(place, ObjectPlace):
        x, y = (np.nan if value is None else value for value in (place.x, place.y))
        return np.array([x, y, place.z, 0.0, math.radians(place.pitch_deg), 0.0])
    pitch, first = math.radians(place.pitch_deg), lead(scenario)
    cos, sin = math.cos(pitch), math.sin(pitch)
    own, middle = middle_of_hands(scenario, first), middle_of_grasps(scenario)
    forward = -own[0] * cos - own[2] * sin
    distance = place.human_distance
    ahead = np.nan if distance is None else stand_of(scenario, first).x + (distance + forward)
    return np.array([ahead, np.nan, place.height - middle[2] * cos + middle[0] * sin, 0.0, pitch, 0.0])
