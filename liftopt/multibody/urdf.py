"""From a Denavit-Hartenberg chain with inertias and shapes to URDF text, and from URDF text to a Pinocchio model."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from io import BytesIO
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from liftopt.multibody.dh import Array, BodyInertia, DHChain, frame_transforms, row_origin, row_tail
from liftopt.multibody.shapes import Shape

# Writing URDFs takes yourdfpy, whose import takes longer than reading a result: it is imported where it is used.
if TYPE_CHECKING:
    import yourdfpy

# Frames and bodies are written with all their digits; where a shape is drawn, to the micrometre.
SHAPE_DECIMALS = 6
_MINUS_ZERO = re.compile(r'(?<=[ "])-0\.0(?=[ "])')


@dataclass(frozen=True)
class JointBounds:
    """Limits of one joint as URDF has them: position [rad, m], effort [Nm, N] and velocity [rad/s, m/s]."""

    lower: float
    upper: float
    effort: float
    velocity: float


# A virtual joint holds its agent on the ground: it does not move, and the ground bears what is asked of it [N].
HELD = JointBounds(lower=0.0, upper=0.0, effort=1.0e5, velocity=0.0)


@dataclass(frozen=True)
class FixedLink:
    """A link that does not move against its parent, joined to it by the joint ``<name>_fixed``.

    Attributes:
        name, parent: link names.
        placement: (4, 4) T_parent_link.
        body: mass properties in the link's frame.
        shapes: in the link's frame.
    """

    name: str
    parent: str
    placement: Array
    body: BodyInertia = field(default_factory=BodyInertia.zero)
    shapes: tuple[Shape, ...] = ()


def joint_name(chain: str, row: str) -> str:
    """Return the URDF name of one DH row's joint, such as ``human_Q4``."""
    return f"{chain}_{row}"


def link_name(chain: str, row: str) -> str:
    """Return the URDF name of the link that one DH row's joint moves."""
    return f"{chain}_{row}_link"


def link_placements(chain: DHChain, root: Array) -> dict[str, Array]:
    """Return T_world_link (4, 4) of every moving URDF link at zero, by row name, given T_world_root (4, 4).

    A URDF link's frame is the one right after its joint's motion: before the DH row's tail.
    """
    ends = [np.eye(4), *frame_transforms(chain, np.zeros(len(chain.rows)))]
    return {row.name: root @ end @ row_origin(row) for row, end in zip(chain.rows, ends, strict=False)}


def shapes_on_links(
    placements: Mapping[str, Array], shapes: Mapping[str, Sequence[Shape]]
) -> dict[str, tuple[Shape, ...]]:
    """Return ``shapes``, given in the world at the chain's zero pose, in the frames of the links that move them."""
    on_links = {}
    for row, parts in shapes.items():
        link_world = np.asarray(np.linalg.inv(placements[row]), dtype=np.float64)
        on_links[row] = tuple(part.seen_from(link_world) for part in parts)
    return on_links


def chain_robot(
    chain: DHChain,
    *,
    root: FixedLink,
    bounds: Mapping[str, JointBounds],
    shapes: Mapping[str, Sequence[Shape]],
    grasp: str,
    attached: Sequence[FixedLink] = (),
) -> yourdfpy.Robot:
    """Return the URDF description of a DH chain that stands on the link ``world``.

    Args:
        chain: DH rows and their bodies.
        root: the base link, with ``parent="world"`` and T_world_root as its placement.
        bounds: limits of every joint, by row name.
        shapes: what links look like, by row name, in the URDF link's frame.
        grasp: name of the massless link at the end of the chain, at the last DH frame.
        attached: further fixed links.
    """
    import yourdfpy

    links, joints = [yourdfpy.Link("world")], []
    parent, tail = root.name, np.eye(4)
    for row, body in zip(chain.rows, chain.inertias, strict=True):
        joint, link = joint_name(chain.name, row.name), link_name(chain.name, row.name)
        limit, origin = bounds[row.name], tail @ row_origin(row)
        joints.append(
            yourdfpy.Joint(
                joint,
                type=row.kind,
                parent=parent,
                child=link,
                origin=origin,
                axis=np.array([0.0, 0.0, 1.0]),
                limit=yourdfpy.Limit(limit.effort, limit.velocity, limit.lower, limit.upper),
            )
        )
        # The chain states its bodies in DH frames, after the row's tail; a URDF link's frame is before it.
        tail = row_tail(row)
        links.append(_link(link, body.transformed(tail[:3, :3], tail[:3, 3]), shapes.get(row.name, ())))
        parent = link
    robot = yourdfpy.Robot(f"liftopt_{chain.name}", links=links, joints=joints)
    fixed = (root, *attached, FixedLink(grasp, parent, tail))
    return with_fixed_links(robot, fixed)


def body_robot(name: str, body: BodyInertia, shapes: Sequence[Shape], fixed: Sequence[FixedLink]) -> yourdfpy.Robot:
    """Return the URDF description of one free body whose frame is the link ``name``."""
    import yourdfpy

    return with_fixed_links(yourdfpy.Robot(f"liftopt_{name}", links=[_link(name, body, shapes)]), fixed)


def with_fixed_links(robot: yourdfpy.Robot, fixed: Sequence[FixedLink]) -> yourdfpy.Robot:
    """Return ``robot`` with more links that do not move."""
    import yourdfpy

    links = [_link(item.name, item.body, item.shapes) for item in fixed]
    joints = [
        yourdfpy.Joint(f"{item.name}_fixed", type="fixed", parent=item.parent, child=item.name, origin=item.placement)
        for item in fixed
    ]
    return yourdfpy.Robot(robot.name, links=[*robot.links, *links], joints=[*joints, *robot.joints])


def urdf_text(robot: yourdfpy.Robot) -> str:
    """Return the URDF; numbers are written with all their digits, so the same robot gives the same bytes."""
    import yourdfpy

    buffer = BytesIO()
    yourdfpy.URDF(robot, build_scene_graph=False, load_meshes=False).write_xml_file(buffer)
    return _MINUS_ZERO.sub("0.0", buffer.getvalue().decode("ascii"))


def load_model(text: str) -> pin.Model:
    """Return the Pinocchio model of a URDF whose root is the link ``world``, gravity (0, 0, -9.81)."""
    return pin.buildModelFromXML(text)


def load_free_model(text: str) -> pin.Model:
    """Return the Pinocchio model of a URDF whose root link is a free body, with a free-flyer root joint."""
    return pin.buildModelFromXML(text, pin.JointModelFreeFlyer())


def _link(name: str, body: BodyInertia, shapes: Sequence[Shape]) -> yourdfpy.Link:
    import yourdfpy

    link = yourdfpy.Link(name)
    if body.mass > 0.0:
        origin = np.eye(4)
        origin[:3, 3] = body.com
        link.inertial = yourdfpy.Inertial(origin, body.mass, body.inertia)
    for shape in shapes:
        material = yourdfpy.Material(shape.colour.name, yourdfpy.Color(np.array(shape.colour.rgba)))
        for part, placement, geometry in shape.parts():
            placement = np.round(placement, SHAPE_DECIMALS)
            link.visuals.append(yourdfpy.Visual(part, placement, geometry, material))
            link.collisions.append(yourdfpy.Collision(f"{part}_collision", placement, geometry))
    return link
