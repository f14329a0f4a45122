"""A scenario to start from for a robot: a person opposite it, a box that both can hold, and a stand that reaches."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
import pinocchio as pin

from liftopt.collocation.solvers.deadline import NEVER
from liftopt.errors import NO_VALUE, InputError
from liftopt.multibody.robots.grasp_frames import FINGER
from liftopt.multibody.robots.robot_solids import robot_solids
from liftopt.multibody.robots.sawyer_description import PAYLOAD
from liftopt.scenario.build import agent_of, motions_of
from liftopt.scenario.model import scenario_from_dict
from liftopt.scenario.robot import Robot
from liftopt.scenario.robot_agents import chosen_of
from liftopt.scenario.robot_defaults import SAWYER
from liftopt.search.cache import SolverCache
from liftopt.search.feasibility_screen import screen_ends
from liftopt.types import Array, Progress

NAME = "robot"
AHEAD, DEPTH = 0.40, 0.45  # where the person holds, and how long the box is [m]: as in Table 5 of the paper
LOWEST, HIGHEST = 0.65, 1.35  # between them is the middle of the lift, for an adult who stands [m]
STAND = 1.0  # [m]: where the middle of the lift is best, if a stand can be had
# Shares of the robot's reach that it lifts, the largest first but no more than HIGH [m]; and masses of the box [kg].
SHARES, HIGH = (0.4, 0.25, 0.12), 0.4
MASSES = (2.0, 1.0, 0.5, 0.2, 0.1)
PAYLOAD_SHARE = 0.9  # of the payload, for the gripper and half of the box
GRIPPER = {"length": 0.15, "mass": 0.4}
# A hand whose frame is as near to the last joint [m] holds farther out, by this share of the robot's reach.
AT_WRIST, FINGERS_SHARE = 0.01, 0.2
# What does not move of a robot that is taller than this stands on the floor itself: a trunk on legs or wheels [m];
# unless its tool would be lower than that above the floor.
TALL, LOW = 0.5, 0.4
SETTLED = 2  # digits of the lengths in the file


@dataclass(frozen=True)
class _Robot:
    """A robot's entries, with what is known of it.

    Attributes:
        entries: of its section.
        payload: what it may carry [kg], infinite where that is not known.
        own_stand: height of its base where it stands on legs or wheels of its own, None of one without [m].
        tip: (3,) its tool's tip in its resting posture, from its base, world axes [m].
        reach: of the tip there, from the first joint [m].
    """

    entries: Mapping[str, Any]
    payload: float
    own_stand: float | None
    tip: Array
    reach: float

    def bears(self, mass: float) -> bool:
        """Whether its payload bears its gripper and half of a box of a mass [kg]."""
        tool = Robot(**self.entries).tool.mass
        return tool + mass / 2.0 <= PAYLOAD_SHARE * self.payload


def first_scenario(robot: Mapping[str, Any], name: str, progress: Progress | None = None) -> dict[str, Any]:
    """Return the tables of a scenario whose robot can hold the box still at both ends.

    Args:
        robot: entries of its section, ``model`` at least.
        name: of the scenario.
        progress: called when kernels must be compiled first.

    Raises:
        InputError: the robot cannot be read or used, or no such scenario was found; it says what was in the way.
    """
    cache, known = SolverCache(), _known(robot)
    why = f"its payload of {known.payload:g} kg bears none of the boxes that were tried"
    for mass, share in product(MASSES, SHARES):
        if not known.bears(mass):
            continue
        tables = _placed(known, name, mass, share)
        scenario = scenario_from_dict(tables)
        reasons, _ = screen_ends(cache.problem(scenario, motions_of(scenario), progress), 0, NEVER)
        if not reasons:
            return tables
        why = reasons[0].message
    raise InputError(str(robot["model"]), NO_VALUE, f"no stand was found at which it holds a box; at last {why}")


def _known(robot: Mapping[str, Any]) -> _Robot:
    section = Robot(**robot)
    if section.model == SAWYER:
        entries = {**robot, "tool": dict(GRIPPER)}
        return _Robot(entries, section.payload or PAYLOAD, None, *_at_rest(entries))
    chosen = chosen_of(section, NAME)
    published = None if chosen.known is None else chosen.known.payload
    payload = section.payload or published or float("inf")
    chain = chosen.examination().chain
    # The link that the last joint moves may be called after what it carries.
    has_hand = any(FINGER.search(link) for link in chain.links[-1].links[1:])
    own = None if payload < 4.0 * GRIPPER["mass"] else GRIPPER
    if has_hand:
        at_wrist = float(np.linalg.norm(chain.T_last_grasp[:3, 3])) < AT_WRIST
        own = {"length": round(FINGERS_SHARE * chain.reach, SETTLED), "mass": 0.0} if at_wrist else None
    tool = {} if "tool" in robot or own is None else {"tool": dict(own)}
    heights, entries = robot_solids(chain).base[:, 2], {**robot, **tool}
    own_stand = -float(heights.min()) if np.ptp(heights) > TALL else None
    return _Robot(entries, payload, own_stand, *_at_rest(entries))


def _at_rest(entries: Mapping[str, Any]) -> tuple[Array, float]:
    """Return where a robot's tip is in its resting posture, and how far it reaches there, see ``_Robot``."""
    tables = _tables(entries, "at rest", MASSES[0])
    own = agent_of(scenario_from_dict(tables), NAME)
    model = own.reduced()
    data = model.createData()
    pin.framesForwardKinematics(model, data, own.posture)
    places = (data.oMf[model.getFrameId(own.hands[0])], data.oMi[1])
    tip, shoulder = (np.asarray(place.translation) - [0.0, 0.0, STAND] for place in places)  # from its base
    return tip, float(np.linalg.norm(tip - shoulder))


def _tables(robot: Mapping[str, Any], name: str, mass: float) -> dict[str, Any]:
    """Return a scenario in which the robot stands at the origin, and no lift is meant yet."""
    human = {"kind": "person", "stature": 1.75, "mass": 75.0, "sex": "male"}
    return {
        "schema": 2,
        "name": name,
        "duration": 2.0,
        "agents": {"human": human, NAME: {"kind": "robot", **robot, "base": {"x": 0.0, "z": STAND}}},
        "object": {"name": "box", "mass": mass, "depth": DEPTH, "width": 0.3, "height": 0.02},
        "task": {"standing_distance": 2.0} | {end: {"x": 0.0, "z": 1.0} for end in ("start", "end")},
        "objective": {"preset": "natural"},
    }


def _placed(robot: _Robot, name: str, mass: float, share: float) -> dict[str, Any]:
    """Return a scenario in which the robot's tool, in its resting posture, is at the middle of the lift."""
    tables, tip, target = _tables(robot.entries, name, mass), robot.tip, AHEAD + DEPTH
    half = min(HIGH, 2.0 * share * robot.reach) / 2.0
    stand = max(0.0, STAND - float(tip[2]))
    if robot.own_stand is not None and robot.own_stand + tip[2] > LOW:
        stand = max(0.0, robot.own_stand)
    middle = float(np.clip(stand + tip[2], LOWEST, HIGHEST))
    x, y = round(target - float(tip[0]), SETTLED), round(-float(tip[1]), SETTLED) + 0.0
    tables["agents"][NAME]["base"] = {"x": x, "y": y, "z": round(stand, SETTLED)}
    tables["task"] = {
        "standing_distance": min(max(x, 0.5), 4.0),
        "start": {"height": round(middle - half, SETTLED), "human_distance": AHEAD},
        "end": {"height": round(middle + half, SETTLED), "human_distance": AHEAD},
    }
    return tables
