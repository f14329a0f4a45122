"""The human: a 13-DOF right arm on spine and feet (Table 2) for one subject, as a URDF and an agent."""

from __future__ import annotations

from collections.abc import Iterable
from math import radians

import numpy as np

from liftopt.multibody.agent import Agent, Grasp, HalfSpace, JointLimits
from liftopt.multibody.dh import ROTATION_WORLD_PAPER, BodyInertia, DHChain, frame_transforms, human_rows
from liftopt.multibody.person.anthropometry import link_lengths
from liftopt.multibody.person.bodies import human_bodies
from liftopt.multibody.person.comfort import human_comfort
from liftopt.multibody.person.human_shapes import human_shapes
from liftopt.multibody.person.lumbar_levers import spine_shares
from liftopt.multibody.person.range_of_motion import RANGES
from liftopt.multibody.person.strength import torque_limit
from liftopt.multibody.person.subject import Sex, Subject
from liftopt.multibody.placement import Placement
from liftopt.multibody.shapes import Shape
from liftopt.multibody.urdf import (
    HELD,
    FixedLink,
    JointBounds,
    chain_robot,
    joint_name,
    link_placements,
    load_model,
    shapes_on_links,
    urdf_text,
)
from liftopt.types import Array

__all__ = ["Subject", "human_agent", "human_chain", "human_limits", "human_root"]

NAME, ORIGIN = "human", Placement()
VIRTUAL = ("GT1", "GT2", "GT3")
# Forearm level and half pronated, the hand about 0.43 m ahead at elbow height: the middle of a lift at the waist.
POSTURE_DEG = {"Q5": 15.0, "Q7": -75.0, "Q8": -80.0}


def human_root(place: Placement = ORIGIN) -> Array:
    """Return T_world_root (4, 4): the paper's frame at the feet, in the world."""
    root = np.eye(4)
    root[:3, :3] = ROTATION_WORLD_PAPER
    return root if place == ORIGIN else np.asarray(place.T_world_base @ root, dtype=np.float64)


def human_chain(subject: Subject, name: str = NAME) -> DHChain:
    """Return Table 2 for ``subject``, the inertia of each body in its row's DH frame; ``name`` begins its joints'.

    The bodies add up to the whole body mass: the pelvis and the legs are on GT3, so that the forces of the three
    virtual joints are the ground reaction.
    """
    lengths = link_lengths(subject)
    rows = human_rows(lengths.l1, lengths.l2, lengths.l3, lengths.l4, lengths.l5, lengths.l6)
    bodies = human_bodies(subject)
    massless = DHChain(name, rows, tuple(BodyInertia.zero() for _ in rows))
    frames = frame_transforms(massless, np.zeros(len(rows)))
    inertias = []
    for row, frame in zip(rows, frames, strict=True):
        world_frame = human_root() @ frame
        rotation = world_frame[:3, :3].T
        body = bodies.get(row.name, BodyInertia.zero())
        inertias.append(body.transformed(rotation, -rotation @ world_frame[:3, 3]).rounded())
    return DHChain(name, rows, tuple(inertias))


def human_limits(sex: Sex) -> JointLimits:
    """Return ranges of motion, speeds and strength of Q1 to Q10, arrays (10,), for a man or a woman."""
    return JointLimits(
        q_lower=np.array([radians(item.lower) for item in RANGES]),
        q_upper=np.array([radians(item.upper) for item in RANGES]),
        velocity=np.array([item.velocity for item in RANGES]),
        tau_lower=np.array([torque_limit(item.joint, -1, sex) for item in RANGES]),
        tau_upper=np.array([torque_limit(item.joint, +1, sex) for item in RANGES]),
    )


def human_agent(subject: Subject, urdf: str | None = None, *, name: str = NAME, place: Placement = ORIGIN) -> Agent:
    """Return the subject as an agent that holds at ``<name>_grasp``; by default at the origin, facing +X.

    The grasp point must stay in front of the base of the spine (eq. 14), which stands over the feet.

    Args:
        subject: who it is.
        urdf: the subject's URDF if it was written before; None writes it.
        name: begins the names of its joints and links.
        place: of the feet.
    """
    limits, text = human_limits(subject.sex), urdf or human_urdf(subject, name, place)
    ahead = place.ahead
    return Agent(
        name=name,
        kind="person",
        urdf=text,
        model=load_model(text),
        locked_joints=tuple(joint_name(name, row) for row in VIRTUAL),
        grasps=(Grasp(name, f"{name}_grasp"),),
        hands=(f"{name}_grasp",),
        limits=limits,
        posture=np.array([radians(POSTURE_DEG.get(item.joint, 0.0)) for item in RANGES]),
        workspace=HalfSpace(ahead, float(ahead @ (place.x, place.y, 0.0))),
        comfort=human_comfort(),
        spine=spine_shares([item.joint for item in RANGES]),
    )


def human_urdf(subject: Subject, name: str = NAME, place: Placement = ORIGIN) -> str:
    """Return the subject's URDF; arguments as ``human_agent``."""
    chain, limits = human_chain(subject, name), human_limits(subject.sex)
    bounds = dict.fromkeys(VIRTUAL, HELD) | joint_bounds((item.joint for item in RANGES), limits)
    return chain_urdf(chain, bounds, placed_shapes(chain, subject), place)


def joint_bounds(rows: Iterable[str], limits: JointLimits) -> dict[str, JointBounds]:
    """Return limits as URDF has them, by row of the chain; its one effort is that of the stronger direction."""
    columns = zip(rows, limits.q_lower, limits.q_upper, limits.effort, limits.velocity, strict=True)
    return {row: JointBounds(*map(float, values)) for row, *values in columns}


def placed_shapes(chain: DHChain, subject: Subject) -> dict[str, tuple[Shape, ...]]:
    """Return the subject's shapes in the frames of the links of ``chain``, the subject's own."""
    return shapes_on_links(link_placements(chain, human_root()), human_shapes(subject))


def chain_urdf(
    chain: DHChain,
    bounds: dict[str, JointBounds],
    shapes: dict[str, tuple[Shape, ...]],
    place: Placement = ORIGIN,
) -> str:
    """Return the URDF of a chain with the rows of Table 2, bounds and shapes by row, standing at ``place``."""
    root = FixedLink(f"{chain.name}_base", "world", human_root(place))
    return urdf_text(chain_robot(chain, root=root, bounds=bounds, shapes=shapes, grasp=f"{chain.name}_grasp"))
