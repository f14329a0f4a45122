"""From a scenario to what the optimal-control problem knows: agents, object and task."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from liftopt.collocation.spline import RestToRestSpline
from liftopt.collocation.task import LiftTask
from liftopt.multibody.agent import Agent, Grasp, LiftedObject
from liftopt.multibody.person.human import HAND_UNDER_EDGE, Subject, human_agent
from liftopt.multibody.robots.sawyer import LEVEL_TOOL, sawyer_agent
from liftopt.multibody.table import lifted_table
from liftopt.scenario.model import GraspPose, Human, Robot, Scenario, Table

Array = npt.NDArray[np.float64]
OBJECT_SPEED = 2.0  # [m/s] and [rad/s], each coordinate: a safe pace beside a person
ROOM = 5.0  # [m]: half the width of the room the object may move in


def agents_of(scenario: Scenario, urdfs: Mapping[str, str] | None = None) -> tuple[Agent, ...]:
    """Return the person and the robot, in the order of the object's grasp points.

    Args:
        scenario: who they are.
        urdfs: name -> text of the models if they were written before, as a solution keeps them.
    """
    return human_of(scenario, urdfs), robot_of(scenario, urdfs)


def human_of(scenario: Scenario, urdfs: Mapping[str, str] | None = None) -> Agent:
    """Return the person; ``urdfs`` as in ``agents_of``."""
    human = scenario.human
    agent = human_agent(subject_of(human), (urdfs or {}).get("human"))
    friction = human.friction if human.contact == "flat" else None
    return replace(agent, grasp=replace(_grasp(human, HAND_UNDER_EDGE), friction=friction))


def subject_of(human: Human) -> Subject:
    """Return the body that a scenario's person has."""
    return Subject(human.stature, human.mass, "male" if human.sex == "male" else "female")


def robot_of(scenario: Scenario, urdfs: Mapping[str, str] | None = None) -> Agent:
    """Return the robot; ``urdfs`` as in ``agents_of``."""
    robot = scenario.robot
    agent = sawyer_agent(
        standing_distance=scenario.task.standing_distance,
        base_height=robot.base_height,
        tool_length=robot.tool.length,
        tool_mass=robot.tool.mass,
        urdf=(urdfs or {}).get("robot"),
    )
    return replace(agent, grasp=_grasp(robot, LEVEL_TOOL))


def _grasp(who: Human | Robot, reference: Array) -> Grasp:
    """Return someone's grasp; ``reference`` (3, 3) is the hand's orientation in the world on a level object."""
    if who.grasp == "point":
        return Grasp(R_hand_object=reference.T)
    return Grasp(True, who.max_grasp_moment, math.radians(who.grasp_turn_deg), reference.T)


def object_of(scenario: Scenario, urdfs: Mapping[str, str] | None = None) -> LiftedObject:
    """Return the table; ``urdfs`` as in ``agents_of``."""
    table, urdf = scenario.table, (urdfs or {}).get("table")
    return lifted_table(mass=table.mass, depth=table.depth, width=table.width, height=table.height, urdf=urdf)


def task_of(scenario: Scenario) -> LiftTask:
    """Return the task: poses at both ends by the height and tilt of the grasp points, sideways free."""
    limits, objective = scenario.limits, scenario.objective
    pitch, yaw = math.radians(limits.table_pitch_deg), math.radians(limits.table_yaw_deg)
    # Two point grasps cannot turn the object about the line through them: its roll is locked.
    turnable = "wrench" in (scenario.human.grasp, scenario.robot.grasp)
    roll = math.radians(limits.table_roll_deg) if turnable else 0.0
    return LiftTask(
        duration=scenario.duration,
        start=_pose(scenario.task.start, scenario.table),
        end=_pose(scenario.task.end, scenario.table),
        pose_lower=np.array([-ROOM, -ROOM, 0.0, -roll, -pitch, -yaw]),
        pose_upper=np.array([ROOM, ROOM, ROOM, roll, pitch, yaw]),
        pose_velocity=np.full(6, OBJECT_SPEED),
        agent_weights=(objective.human_weight, objective.robot_weight),
        acceleration_weight=objective.acceleration_weight,
        force_weight=objective.force_weight,
        max_grasp_force=limits.max_grasp_force,
        balance_tolerance=limits.balance_tolerance,
    )


def motions_of(scenario: Scenario, intervals: int | None = None) -> RestToRestSpline:
    """Return the motions that a scenario allows: at rest at both ends as it asks, on its intervals or on others."""
    return RestToRestSpline(scenario.solver.intervals if intervals is None else intervals, scenario.task.rest)


def _pose(grasp: GraspPose, table: Table) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Return the pose of the centre of mass from where the grasp points are.

    ``height`` is midway between them, ``human_distance`` the human's. The centre of mass lies half the table's height
    off that middle, along the body's Z axis; half the depth along its X axis leads there from the human's grasp point.
    """
    pitch = math.radians(grasp.pitch_deg)
    forward = (table.depth * math.cos(pitch) + table.height * math.sin(pitch)) / 2
    ahead = np.nan if grasp.human_distance is None else grasp.human_distance + forward
    return np.array([ahead, np.nan, grasp.height + table.height / 2 * math.cos(pitch), 0.0, pitch, 0.0])
