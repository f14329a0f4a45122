"""Sawyer: Table 3 with the manufacturer's inertias and limits, and a gripper, as a URDF and an agent."""

from __future__ import annotations

import numpy as np

from liftopt.multibody.agent import Agent, Grasp, JointLimits
from liftopt.multibody.bounds import checked_number
from liftopt.multibody.dh import (
    ROTATION_WORLD_PAPER,
    BodyInertia,
    DHChain,
    frame_transforms,
    robot_rows,
    row_tail,
    translation,
)
from liftopt.multibody.placement import Placement
from liftopt.multibody.robots import sawyer_description as described
from liftopt.multibody.robots.sawyer_shapes import link_shapes, stand_shapes, tool_shapes
from liftopt.multibody.robots.tool import tool_body
from liftopt.multibody.shapes import Shape
from liftopt.multibody.urdf import (
    HELD,
    FixedLink,
    JointBounds,
    chain_robot,
    joint_name,
    link_name,
    link_placements,
    load_model,
    shapes_on_links,
    urdf_text,
)
from liftopt.types import Array

NAME = "robot"
VIRTUAL, MOVING = ("GT1", "GT2", "GT3"), ("Q1", "Q2", "Q3", "Q4", "Q5", "Q6", "Q7")
# l1 to l8 of Table 3 [m], to the flange: they reproduce the manufacturer's joint origins.
LENGTHS = (0.317, 0.081, 0.1925, 0.4, 0.1685, 0.4, 0.1363, 0.1345)
# Table 3's joints turn as the manufacturer's right_j0 to right_j6, the fourth the other way round.
JOINT_SIGNS = np.array([1.0, 1.0, 1.0, -1.0, 1.0, 1.0, 1.0])
# Elbow up, the tool level and pointing at the human, 1.05 m ahead of the base and 0.24 m above it.
# Orientation of the tool that comes to the edge level, in the world: its axis (the grasp frame's z) along -X, y up.
LEVEL_TOOL = np.array([[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
POSTURE = (-0.15, -0.44, 0.0, -1.12, 0.0, -0.68, 0.0)


def sawyer_root(place: Placement) -> Array:
    """Return T_world_root (4, 4): the paper's frame on the floor below the robot, which faces along ``place``."""
    root: Array = np.eye(4)
    root[:3, :3] = ROTATION_WORLD_PAPER
    return np.asarray(place.T_world_base @ root, dtype=np.float64)


def sawyer_chain(*, base_height: float, tool_length: float, tool_mass: float) -> DHChain:
    """Return Table 3 up to the tool's tip, the inertia of each body in its row's DH frame, the tool in the last.

    Args:
        base_height: of the arm's base above the floor, l9 [m].
        tool_length: from the flange to the grasp point [m]; 0 for none.
        tool_mass: of the gripper, a uniform cylinder from flange to tip [kg].

    Raises:
        InputError: a value is out of range.
    """
    _check(NAME, base_height, tool_length, tool_mass)
    bare = _bare_chain(NAME, base_height, tool_length)
    flange_from_tip = np.array([0.0, 0.0, -tool_length])
    last = bare.inertias[-1] + tool_body(tool_length, tool_mass).transformed(np.eye(3), flange_from_tip)
    return DHChain(NAME, bare.rows, (*bare.inertias[:-1], last.rounded()))


def sawyer_limits() -> JointLimits:
    """Return the manufacturer's limits of Q1 to Q7 in Table 3's signs, arrays (7,)."""
    joints = described.JOINTS
    ends = JOINT_SIGNS * np.array([[joint.lower for joint in joints], [joint.upper for joint in joints]])
    effort = np.array([joint.effort for joint in joints])
    return JointLimits(
        q_lower=ends.min(axis=0),
        q_upper=ends.max(axis=0),
        velocity=np.array([joint.velocity for joint in joints]),
        tau_lower=-effort,
        tau_upper=effort,
    )


def sawyer_agent(
    *,
    place: Placement,
    base_height: float,
    tool_length: float,
    tool_mass: float,
    urdf: str | None = None,
    name: str = NAME,
) -> Agent:
    """Return Sawyer as an agent on its pedestal.

    It holds at ``<name>_grasp``, the tool's tip; with a tool of length and mass zero, the bare flange.

    Args:
        place: of its base axis on the floor, and which way it faces.
        base_height: of the arm's base above the floor, l9 [m].
        tool_length: from the flange to the grasp point [m].
        tool_mass: of the gripper [kg].
        urdf: this robot's URDF if it was written before; None writes it.
        name: begins the names of its joints and links.

    Raises:
        InputError: a value is out of range; its key is ``<name>.base_height``, ``<name>.tool.length`` or
            ``<name>.tool.mass``.
    """
    _check(name, base_height, tool_length, tool_mass)
    text = urdf or _urdf(name, place, base_height, tool_length, tool_mass)
    return Agent(
        name=name,
        kind="robot",
        urdf=text,
        model=load_model(text),
        locked_joints=tuple(joint_name(name, row) for row in VIRTUAL),
        grasps=(Grasp(name, f"{name}_grasp"),),
        hands=(f"{name}_grasp",),
        limits=sawyer_limits(),
        posture=np.array(POSTURE),
    )


def _urdf(name: str, place: Placement, base_height: float, tool_length: float, tool_mass: float) -> str:
    chain, limits = _bare_chain(name, base_height, tool_length), sawyer_limits()
    root = sawyer_root(place)
    moves = zip(limits.q_lower, limits.q_upper, limits.tau_upper, limits.velocity, strict=True)
    bounds = dict.fromkeys(VIRTUAL, HELD) | {
        row: JointBounds(*map(float, values)) for row, values in zip(MOVING, moves, strict=True)
    }
    return urdf_text(
        chain_robot(
            chain,
            root=_stand(chain, root, base_height),
            bounds=bounds,
            shapes=shapes_on_links(link_placements(chain, root), _shapes(chain, root)),
            grasp=f"{name}_grasp",
            attached=_tool(chain, tool_length, tool_mass),
        )
    )


def _bare_chain(name: str, base_height: float, tool_length: float) -> DHChain:
    """Return Table 3 to the tool's tip, without the tool's body: the manufacturer's bodies moved into DH frames."""
    rows = robot_rows((*LENGTHS[:7], LENGTHS[7] + tool_length, base_height))
    massless = DHChain(name, rows, tuple(BodyInertia.zero() for _ in rows))
    dh_frames = frame_transforms(massless, np.zeros(len(rows)))[len(VIRTUAL) :]
    described_frames = described.described_frames(np.zeros(len(MOVING)))
    inertias = [BodyInertia.zero() for _ in VIRTUAL]
    for body, dh_frame, frame in zip(_described_bodies(), dh_frames, described_frames, strict=True):
        relative = np.linalg.inv(dh_frame) @ _root_base(massless) @ frame
        inertias.append(body.transformed(relative[:3, :3], relative[:3, 3]).rounded())
    return DHChain(name, rows, tuple(inertias))


def _described_bodies() -> list[BodyInertia]:
    bodies = [link.body() for link in described.LINKS]
    bodies[0] += described.HEAD.body().transformed(np.eye(3), np.array(described.HEAD_IN_FIRST_LINK))
    return bodies


def _root_base(chain: DHChain) -> Array:
    """Return T_root_base (4, 4) of the manufacturer's base frame, which is Table 3's frame after GT3."""
    return frame_transforms(chain, np.zeros(len(chain.rows)))[len(VIRTUAL) - 1]


def _stand(chain: DHChain, root: Array, base_height: float) -> FixedLink:
    """Return the base link: pedestal and arm base, which do not move."""
    base = _root_base(chain)
    body = (described.BASE_LINK.body() + described.PEDESTAL.body()).transformed(base[:3, :3], base[:3, 3]).rounded()
    shapes = tuple(shape.seen_from(base) for shape in stand_shapes(base_height))
    return FixedLink(f"{chain.name}_base", "world", root, body, shapes)


def _shapes(chain: DHChain, root: Array) -> dict[str, tuple[Shape, ...]]:
    """Return the links' shapes in the world at the zero pose, by the DH row that moves them."""
    world_base = root @ _root_base(chain)
    frames = described.described_frames(np.zeros(len(MOVING)))
    return {
        row: tuple(shape.seen_from(world_base @ frame) for shape in shapes)
        for row, shapes, frame in zip(MOVING, link_shapes(), frames, strict=True)
    }


def _tool(chain: DHChain, length: float, mass: float) -> tuple[FixedLink, ...]:
    """Return the gripper as a link on the flange, or nothing for the bare flange."""
    if length == 0.0 and mass == 0.0:
        return ()
    flange = row_tail(chain.rows[-1]) @ translation(0.0, 0.0, -length)
    body = tool_body(length, mass)
    return (FixedLink(f"{chain.name}_tool", link_name(chain.name, MOVING[-1]), flange, body, tool_shapes(length)),)


def _check(name: str, base_height: float, tool_length: float, tool_mass: float) -> None:
    checked_number(f"{name}.base_height", base_height, 0.1, 2.0, "m")
    checked_number(f"{name}.tool.length", tool_length, 0.0, 1.0, "m")
    checked_number(f"{name}.tool.mass", tool_mass, 0.0, 20.0, "kg")
