"""The URDF of a robot's chain as liftopt writes it: solids, bodies and joints, each name with the agent's.

A joint of the chain is ``<agent>_<its own name>``, and q is its own: forward kinematics, mass matrix and gravity are
those of the URDF that was read. What does not move is one body with what carries it.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import pinocchio as pin

from liftopt.errors import InputError
from liftopt.multibody.dh import BodyInertia
from liftopt.multibody.robots.carried_links import BASE
from liftopt.multibody.robots.chain import ChainLink, RobotChain
from liftopt.multibody.robots.description import LARGEST_NUMBER
from liftopt.multibody.robots.mass_findings import ROUNDING, principal_moments
from liftopt.multibody.robots.robot_solids import robot_solids
from liftopt.multibody.robots.robot_stand import robot_stand
from liftopt.multibody.robots.sawyer_shapes import tool_shapes
from liftopt.multibody.robots.tool import UNTURNED, along, tool_body
from liftopt.multibody.urdf import FixedLink, JointBounds, MovingLink, plain_name, tree_robot, urdf_text
from liftopt.types import Array

UP = np.array([0.0, 0.0, 1.0])
LONGEST_NAME = 90


def robot_urdf(
    chain: RobotChain,
    name: str,
    T_world_base: Array,
    *,
    tool_length: float,
    tool_mass: float,
    tool_direction: str = UNTURNED,
    tool_turn: float = 0.0,
    shapes: bool = True,
) -> str:
    """Return the URDF of a robot whose base is bolted to the world.

    Args:
        chain: what moves.
        name: of the agent, which begins all names; ``<name>_grasp`` is the frame that it holds with.
        T_world_base: (4, 4) placement of the base link.
        tool_length: from the grasp frame to where it holds [m].
        tool_mass: of the tool [kg].
        tool_direction: axis of the grasp frame along which the tool extends; it becomes z of ``<name>_grasp``.
        tool_turn: how the tool is turned about that [rad].
        shapes: whether to find the shapes of its links, which takes a while, and which motion does not need.

    Raises:
        InputError: two of its names cannot be told apart in a URDF.
    """
    joints = _named(name, [joint.name for joint in chain.joints], (), chain)
    taken = (*joints, f"{name}_grasp", f"{name}_tool", "world")
    base, *links = _named(name, [chain.base, *(link.joint.child for link in chain.links)], taken, chain)
    turns = [turned(link) for link in chain.links]
    solids = robot_solids(chain) if shapes else None
    moving, parent, before = [], base, np.eye(4)
    bounded = zip(chain.links, chain.ranges, turns, joints, links, strict=True)
    for number, (link, ends_of_range, turn, joint, own) in enumerate(bounded):
        back = turn.T
        bounds = JointBounds(
            ends_of_range.lower, ends_of_range.upper, float(link.joint.effort or 0.0), float(link.joint.velocity or 0.0)
        )
        body = link.body.transformed(back[:3, :3], np.zeros(3))
        own_shapes = tuple(shape.seen_from(back) for shape in solids.shapes[number]) if solids else ()
        kind = "prismatic" if link.joint.kind == "prismatic" else "revolute"
        placement = before @ link.placement @ turn
        moving.append(MovingLink(joint, own, parent, kind, placement, bounds, body, own_shapes))  # type: ignore[arg-type]
        parent, before = own, back
    stand = (*solids.shapes[BASE], *robot_stand(T_world_base, solids.base)) if solids else ()
    flange = before @ chain.T_last_grasp @ along(tool_direction, tool_turn)
    fixed = [FixedLink(base, "world", T_world_base, _sound(chain.base_body), stand)]
    if tool_length or tool_mass:
        fixed.append(
            FixedLink(f"{name}_tool", parent, flange, tool_body(tool_length, tool_mass), tool_shapes(tool_length))
        )
    tip = np.eye(4)
    tip[2, 3] = tool_length
    fixed.append(FixedLink(f"{name}_grasp", parent, flange @ tip))
    return urdf_text(tree_robot(name, moving, fixed))


def _sound(body: BodyInertia) -> BodyInertia:
    """Return a body that does not move, or none in its place where its mass properties are none of a body."""
    numbers = np.array([body.mass, *body.com, *body.inertia.ravel()])
    if not (np.abs(numbers) <= LARGEST_NUMBER).all() or body.mass < 0.0 or principal_moments(body)[0] < -ROUNDING:
        return BodyInertia.zero()
    return body


def _named(agent: str, own: Iterable[str], taken: Iterable[str], chain: RobotChain) -> list[str]:
    """Return names as liftopt's URDFs have them; one that is taken, by a joint for instance, says that it is a link."""
    names: list[str] = []
    used = set(taken)
    for one in own:
        name = own_joint(agent, one)
        name = f"{name}_link" if name in used else name
        if name in used or f"{name}_fixed" in used:
            raise InputError(
                f"{chain.description.source}: name", one, "another link or joint has one that reads the same"
            )
        used.add(name)
        names.append(name)
    return names


def own_joint(agent: str, name: str) -> str:
    """Return what liftopt's URDF of an agent calls the joint or link that the robot's own URDF calls ``name``."""
    return f"{agent}_{plain_name(name)}"[:LONGEST_NAME]


def turned(link: ChainLink) -> Array:
    """Return T_child_link (4, 4) of the frame whose z axis is the joint's axis: liftopt's joints turn about z."""
    turn = np.eye(4)
    turn[:3, :3] = pin.Quaternion.FromTwoVectors(UP, link.joint.axis).matrix()
    return turn
