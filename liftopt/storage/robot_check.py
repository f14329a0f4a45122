"""Whether the model of a robot in a result is one that its scenario can mean; its maker's file is not read for that.

That file may be gone, or be another robot by now. What the scenario itself says of the model is looked at: where its
base is, which joints it holds, and the limits that it gives.
"""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin

from liftopt.multibody.agent import Agent
from liftopt.multibody.dh import rotation_z
from liftopt.multibody.likeness import moved
from liftopt.multibody.robots.catalogue import known_robots
from liftopt.multibody.robots.robot_urdf import own_joint
from liftopt.scenario.model import Scenario
from liftopt.scenario.robot import Robot
from liftopt.scenario.robot_agents import T_world_base_of
from liftopt.solution.solution import Solution

SAME_LIMIT = 1e-6  # relative
CLOSED = 5e-3  # m between where a hand is and where it holds the object; in a solved lift far below


def unlike_scenario(scenario: Scenario, agent: Agent) -> str:
    """Return the first thing in which a robot's model is not what a scenario says of it, in words; empty if none is.

    Args:
        scenario: with a robot of that name, whose model comes from a file.
        agent: made of the URDF that a result keeps.
    """
    robot = scenario.agents[agent.name]
    assert isinstance(robot, Robot)
    for frame in agent.hands:
        if not agent.model.existFrame(frame):
            return f"it has no frame {frame}"
    known = known_robots().get(robot.model)
    front = 0.0 if known is None or robot.base_link not in (None, known.base) else known.front_deg
    placed = T_world_base_of(scenario, agent.name) @ rotation_z(-math.radians(front))
    if found := moved(pin.SE3(agent.T_world_base), pin.SE3(np.asarray(placed))):
        return f"its base is {found}"
    joints = list(agent.moving_joints)
    for name in robot.locked:
        if own_joint(agent.name, name) in joints:
            return f"its joint {name} moves, and the scenario holds it"
    for name, given in robot.limits.items():
        if own_joint(agent.name, name) not in joints:
            continue
        i, limits = joints.index(own_joint(agent.name, name)), agent.limits
        has = {"lower": limits.q_lower, "upper": limits.q_upper, "velocity": limits.velocity, "effort": limits.effort}
        for entry, values in has.items():
            said = getattr(given, entry)
            if said is not None and not math.isclose(said, values[i], rel_tol=SAME_LIMIT, abs_tol=SAME_LIMIT):
                return f"its joint {name} has {entry} {values[i]:g}, not {said:g}"
    return ""


def lets_go(solution: Solution, name: str) -> str:
    """Return how far a robot of a solved lift is from where it holds the object, in words; empty if it holds it.

    Another arm at the same base, with the same names of joints, has its hand elsewhere.
    """
    held = solution.object.grasp_position
    columns = np.cumsum([0, *(len(agent.grasps) for agent in solution.agents)])
    for k, agent in enumerate(solution.agents):
        if agent.name == name:
            away = np.linalg.norm(agent.grasp_position - held[:, columns[k] : columns[k + 1]], axis=2).max()
            return f"its hand is {away:.3f} m from where it holds the object" if away > CLOSED else ""
    return ""
