"""A robot's description from its URDF or xacro file, which yourdfpy takes apart."""

from __future__ import annotations

from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from types import MappingProxyType
from typing import Any
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.bounded_read import read_regular
from liftopt.multibody.dh import BodyInertia
from liftopt.multibody.robots.description import Mimic, RobotDescription, RobotJoint, RobotLink
from liftopt.multibody.robots.robot_shape import shapes_of
from liftopt.multibody.robots.urdf_shape import LARGEST, WITHOUT_AXIS, checked_shape
from liftopt.multibody.robots.xacro_text import INSTALL, expanded
from liftopt.types import Array

TEXT = "URDF"  # what messages call a text that is no file
MOMENTS = ("ixx", "iyy", "izz")  # the products of inertia may be left out, these may not
NEEDED = {
    "link": ("inertial",),
    "inertial": ("origin", "mass", "inertia"),
    "joint": ("origin", "parent", "child", "axis", "limit", "mimic", "safety_controller"),
}
NOTHING: Mapping[str, str] = MappingProxyType({})


def read_robot(
    source: str | Path, *, arguments: Mapping[str, str] = NOTHING, y_up: bool = False, expand: bool = True
) -> RobotDescription:
    """Return what a URDF or xacro file, or the text of a URDF, describes.

    Args:
        source: path of the file (xacro where its name ends so, or where it uses xacro), or the text itself.
        arguments: values of the ``xacro:arg`` of a xacro file.
        expand: expand a file that uses xacro, which evaluates expressions; False takes it as a URDF.
        y_up: turn meshes that state that their y axis is up; as robots' programs do, that is left out else.

    Raises:
        InputError: the file cannot be read, is no URDF, or a package that reads it is not installed.
    """
    if isinstance(source, str) and (source.lstrip().startswith("<") or "\n" in source):
        return _described(source, TEXT, None, y_up)
    path = Path(source)
    text = _text(path)
    if expand and (path.suffix == ".xacro" or ("xmlns:xacro" in text and "<xacro:" in text)):
        text = expanded(path, arguments)
    return _described(text, str(path), path, y_up)


def _text(path: Path) -> str:
    try:
        content = read_regular(path, LARGEST, "a robot is a URDF or xacro file")
    except FileNotFoundError:
        raise InputError(str(path), NO_VALUE, "there is no such file; a robot is a URDF or xacro file") from None
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("latin-1")


def _described(text: str, source: str, path: Path | None, y_up: bool) -> RobotDescription:
    tree = checked_shape(text, source)
    robot = _parsed(tree, source)
    elements = {str(link.get("name")): link for link in tree.findall("link")}
    materials = {
        str(material.get("name")): colour.get("rgba", "")
        for material in tree.iter("material")
        if (colour := material.find("color")) is not None
    }
    return RobotDescription(
        name=robot.name,
        source=source,
        links=tuple(_link(link, elements[link.name], materials, path, y_up) for link in robot.links),
        joints=tuple(_joint(joint, source) for joint in robot.joints),
    )


def _parsed(tree: Element, source: str) -> Any:
    """Return yourdfpy's robot, of the elements that dynamics need and no others, over which it might stumble."""
    try:
        import yourdfpy
    except ImportError:
        raise InputError(source, NO_VALUE, f"the package yourdfpy reads URDFs: {INSTALL}") from None
    bare = Element("robot", name=tree.get("name") or "robot")
    for element in (*tree.findall("link"), *tree.findall("joint")):
        bare.append(_needed(element))
    content = BytesIO(ElementTree.tostring(bare))
    return yourdfpy.URDF.load(content, build_scene_graph=False, load_meshes=False).robot


def _needed(element: Element) -> Element:
    """Return an element without what it holds that is not in ``NEEDED``."""
    copy = Element(element.tag, element.attrib)
    without = ("axis",) if element.get("type") in WITHOUT_AXIS else ()
    copy.extend(
        [_needed(inner) for inner in element if inner.tag in NEEDED.get(element.tag, ()) and inner.tag not in without]
    )
    return copy


def _link(link: Any, element: Element, materials: Mapping[str, str], path: Path | None, y_up: bool) -> RobotLink:
    visuals, collisions = (
        tuple(shapes_of(element, kind, materials, path, y_up=y_up)) for kind in ("visual", "collision")
    )
    return RobotLink(link.name, _body(link.inertial, element), visuals, collisions)


def _body(inertial: Any, element: Element) -> BodyInertia:
    """Return mass properties in the link's frame; yourdfpy has ones for moments that are missing, here they are NaN."""
    if inertial is None:
        return BodyInertia.zero()
    mass = 0.0 if inertial.mass is None else float(inertial.mass)
    origin = np.eye(4) if inertial.origin is None else np.asarray(inertial.origin, dtype=np.float64)
    stated = element.find("inertial/inertia")
    if inertial.inertia is None or stated is None or any(stated.get(name) is None for name in MOMENTS):
        inertia = np.full((3, 3), np.nan if mass != 0.0 else 0.0)
    else:
        inertia = np.asarray(inertial.inertia, dtype=np.float64)
    with np.errstate(all="ignore"):  # endless ones are judged later
        return BodyInertia(mass, np.zeros(3), inertia).transformed(origin[:3, :3], origin[:3, 3])


def _joint(joint: Any, source: str) -> RobotJoint:
    limit, soft, mimic = joint.limit, joint.safety_controller, joint.mimic
    return RobotJoint(
        name=joint.name,
        kind=joint.type,
        parent=joint.parent,
        child=joint.child,
        placement=np.eye(4) if joint.origin is None else np.asarray(joint.origin, dtype=np.float64),
        axis=_unit(np.asarray(joint.axis, dtype=np.float64), joint, source),
        lower=None if limit is None else limit.lower,
        upper=None if limit is None else limit.upper,
        velocity=None if limit is None else limit.velocity,
        effort=None if limit is None else limit.effort,
        soft_lower=None if soft is None else soft.soft_lower_limit,
        soft_upper=None if soft is None else soft.soft_upper_limit,
        mimic=None if mimic is None else Mimic(mimic.joint, float(mimic.multiplier), float(mimic.offset)),
    )


def _unit(axis: Array, joint: Any, source: str) -> Array:
    length = float(np.linalg.norm(axis))
    if joint.type == "fixed":
        return np.array([0.0, 0.0, 1.0])
    if not np.isfinite(length) or length < 1e-6:
        raise InputError(f"{source}: joint {joint.name}: axis", axis.tolist(), "must be a direction of some length")
    return axis / length
