"""The models of a result read back: plain shapes, bodies and joints as liftopt writes them, and nothing else.

Pinocchio's reader is for files that one trusts: a mesh names other files, deep nesting ends the process, and numbers
that are none become a model that computes nothing. So a text is looked through before it is handed on.
"""

from __future__ import annotations

import math
import re
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

LARGEST_URDF = 1_000_000  # characters; the robot has 28 000
MOST_LINKS = 200
DEEPEST = 5  # robot, link, visual, geometry, box
NAME = re.compile(r"[\w .+-]{1,100}")
LARGEST_NUMBER = 1e6  # in SI units
# Elements, and of their attributes those that are text; all others are numbers.
ELEMENTS: dict[str, frozenset[str]] = {
    **dict.fromkeys(("robot", "link", "visual", "collision", "material"), frozenset({"name"})),
    **dict.fromkeys(("parent", "child"), frozenset({"link"})),
    **dict.fromkeys(("inertial", "origin", "mass", "inertia", "geometry", "color", "axis", "limit"), frozenset()),
    **dict.fromkeys(("box", "cylinder", "sphere"), frozenset()),
    "joint": frozenset({"name", "type"}),
}
JOINTS = ("revolute", "prismatic", "fixed")


def check_urdf(text: str) -> None:
    """Raise ValueError if a URDF is not well-formed or holds something that liftopt does not write."""
    if len(text) > LARGEST_URDF:
        raise ValueError(f"it is larger than {LARGEST_URDF} characters; no model of liftopt is that large")
    if "<!DOCTYPE" in text.upper():
        raise ValueError("it declares a document type")
    try:
        robot = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise ValueError(f"it is no XML: {error}") from None
    if robot.tag != "robot":
        raise ValueError("it is no URDF")
    _check_element(robot)
    _check_tree(robot)


def _check_element(element: Element, depth: int = 1) -> None:
    texts = ELEMENTS.get(element.tag)
    if depth > DEEPEST:
        raise ValueError(f"its elements are nested deeper than {DEEPEST}")
    if texts is None:
        raise ValueError(f"it holds {element.tag!r:.40}, which liftopt writes into no model")
    if element.tag == "joint" and element.get("type") not in JOINTS:
        raise ValueError(f"a joint is of type {element.get('type')!r:.40}")
    for name, value in element.items():
        if name in texts and not NAME.fullmatch(value):
            raise ValueError(f"{element.tag}, {name} = {value!r:.40}: must be a name")
        if name not in texts and not all(_is_number(number) for number in value.split()):
            raise ValueError(f"{element.tag}, {name} = {value!r:.40}: must be numbers")
    for inner in element:
        _check_element(inner, depth + 1)


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text)) and abs(float(text)) <= LARGEST_NUMBER
    except ValueError:
        return False


def _check_tree(robot: Element) -> None:
    """Check that the joints make one tree of the links: a loop has no end."""
    links = [link.get("name") for link in robot.findall("link")]
    parents = {_end(joint, "child"): _end(joint, "parent") for joint in robot.findall("joint")}
    roots = set(links) - set(parents)
    if len(links) > MOST_LINKS or len(set(links)) < len(links):
        raise ValueError(f"it has more than {MOST_LINKS} links, or two of one name")
    if len(roots) != 1 or len(parents) != len(robot.findall("joint")) or not set(parents.values()) <= set(links):
        raise ValueError("its joints do not make one tree of its links")
    for link in links:
        for _ in links:
            link = parents.get(link, link)
        if link not in roots:
            raise ValueError("its joints make a loop")


def _end(joint: Element, which: str) -> str | None:
    found = joint.find(which)
    return None if found is None else found.get("link")
