"""From a Denavit-Hartenberg chain with inertias and shapes to URDF text, and from URDF text to a Pinocchio model."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

import numpy as np
import pinocchio as pin

from liftopt.multibody.dh import BodyInertia, DHChain, JointKind, frame_transforms, row_origin, row_tail
from liftopt.multibody.shapes import Shape, urdf_numbers
from liftopt.types import Array

# Frames and bodies are written with all their digits; where a shape is drawn, to the micrometre.
SHAPE_DECIMALS = 6
LIMITS = ("effort", "velocity", "lower", "upper")
DECLARATION = "<?xml version='1.0' encoding='ASCII'?>\n"


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


@dataclass(frozen=True)
class MovingLink:
    """A link that a joint moves against its parent, about the z axis of the link's frame or along it.

    Attributes:
        joint, name, parent: names of the joint, of the link and of the link that carries it.
        kind: of the joint.
        placement: (4, 4) T_parent_link where the joint is at zero.
        bounds: limits of the joint.
        body: mass properties in the link's frame.
        shapes: in the link's frame.
    """

    joint: str
    name: str
    parent: str
    kind: JointKind
    placement: Array
    bounds: JointBounds
    body: BodyInertia
    shapes: tuple[Shape, ...] = ()


def plain_name(name: str) -> str:
    """Return a name with ``_`` for each character that names in liftopt's URDFs do not have."""
    return re.sub(r"[^A-Za-z0-9_.+-]", "_", name)


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
) -> Element:
    """Return the URDF of a DH chain that stands on the link ``world``.

    Args:
        chain: DH rows and their bodies.
        root: the base link, with ``parent="world"`` and T_world_root as its placement.
        bounds: limits of every joint, by row name.
        shapes: what links look like, by row name, in the URDF link's frame.
        grasp: name of the massless link at the end of the chain, at the last DH frame.
        attached: further fixed links.
    """
    moving, parent, tail = [], root.name, np.eye(4)
    for row, body in zip(chain.rows, chain.inertias, strict=True):
        name, joint, placement = (
            link_name(chain.name, row.name),
            joint_name(chain.name, row.name),
            tail @ row_origin(row),
        )
        # The chain states its bodies in DH frames, after the row's tail; a URDF link's frame is before it.
        tail = row_tail(row)
        own, drawn = body.transformed(tail[:3, :3], tail[:3, 3]), tuple(shapes.get(row.name, ()))
        moving.append(MovingLink(joint, name, parent, row.kind, placement, bounds[row.name], own, drawn))
        parent = name
    return tree_robot(chain.name, moving, (root, *attached, FixedLink(grasp, parent, tail)))


def tree_robot(name: str, moving: Sequence[MovingLink], fixed: Sequence[FixedLink]) -> Element:
    """Return the URDF of a tree of links that stands on the link ``world``.

    Args:
        name: of the robot.
        moving: links that joints move, parents before children.
        fixed: links that do not move against their parents; one at least has the parent ``world``.
    """
    links, joints = [Element("link", name="world")], []
    for item in moving:
        joint = _joint(item.joint, item.kind, item.parent, item.name, item.placement)
        SubElement(joint, "axis", xyz="0.0 0.0 1.0")
        limit = asdict(item.bounds)
        SubElement(joint, "limit", {key: urdf_numbers(limit[key]) for key in LIMITS})
        joints.append(joint)
        links.append(_link(item.name, item.body, item.shapes))
    return _robot(name, links, fixed, joints)


def body_robot(name: str, body: BodyInertia, shapes: Sequence[Shape], fixed: Sequence[FixedLink]) -> Element:
    """Return the URDF of one free body whose frame is the link ``name``."""
    return _robot(name, [_link(name, body, shapes)], fixed, [])


def urdf_text(robot: Element) -> str:
    """Return the URDF; numbers are written with all their digits, so the same robot gives the same bytes."""
    ElementTree.indent(robot)
    return DECLARATION + ElementTree.tostring(robot, encoding="unicode").replace(" />", "/>") + "\n"


def load_model(text: str) -> pin.Model:
    """Return the Pinocchio model of a URDF whose root is the link ``world``, gravity (0, 0, -9.81)."""
    return pin.buildModelFromXML(text)


def load_free_model(text: str) -> pin.Model:
    """Return the Pinocchio model of a URDF whose root link is a free body, with a free-flyer root joint."""
    return pin.buildModelFromXML(text, pin.JointModelFreeFlyer())


def _robot(name: str, links: Iterable[Element], fixed: Sequence[FixedLink], joints: Iterable[Element]) -> Element:
    robot = Element("robot", name=f"liftopt_{name}")
    robot.extend([*links, *(_link(item.name, item.body, item.shapes) for item in fixed)])
    robot.extend([_joint(f"{item.name}_fixed", "fixed", item.parent, item.name, item.placement) for item in fixed])
    robot.extend(joints)
    return robot


def _joint(name: str, kind: str, parent: str, child: str, placement: Array) -> Element:
    joint = Element("joint", name=name, type=kind)
    SubElement(joint, "parent", link=parent)
    SubElement(joint, "child", link=child)
    joint.append(_origin(placement))
    return joint


def _link(name: str, body: BodyInertia, shapes: Sequence[Shape]) -> Element:
    link = Element("link", name=name)
    if body.mass > 0.0:
        inertial = SubElement(link, "inertial")
        SubElement(inertial, "origin", xyz=urdf_numbers(*body.com), rpy=urdf_numbers(0.0, 0.0, 0.0))
        SubElement(inertial, "mass", value=urdf_numbers(body.mass))
        moments = {f"i{'xyz'[r]}{'xyz'[c]}": urdf_numbers(body.inertia[r, c]) for r in range(3) for c in range(r, 3)}
        SubElement(inertial, "inertia", moments)
    parts = [(shape.colour, *part) for shape in shapes for part in shape.parts()]
    for colour, part, placement, geometry in parts:
        visual = _drawn("visual", part, placement, geometry)
        material = SubElement(visual, "material", name=colour.name)
        SubElement(material, "color", rgba=urdf_numbers(*colour.rgba))
        link.append(visual)
    link.extend([_drawn("collision", f"{part}_collision", placement, shape) for _, part, placement, shape in parts])
    return link


def _drawn(kind: str, name: str, placement: Array, geometry: Element) -> Element:
    drawn = Element(kind, name=name)
    SubElement(drawn, "geometry").append(geometry)
    drawn.append(_origin(np.round(placement, SHAPE_DECIMALS)))
    return drawn


def _origin(placement: Array) -> Element:
    angles = pin.rpy.matrixToRpy(placement[:3, :3])
    return Element("origin", xyz=urdf_numbers(*placement[:3, 3]), rpy=urdf_numbers(*angles))
