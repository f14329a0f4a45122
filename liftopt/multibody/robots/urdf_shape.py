"""Whether a text has the shape of a URDF, before a reader takes it apart: what is wrong is named with its place."""

from __future__ import annotations

from collections import Counter
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from liftopt.errors import NO_VALUE, InputError
from liftopt.multibody.robots.description import KINDS, LARGEST_NUMBER

JUDGED_LATER = ("mass", "inertia", "limit", "safety_controller")  # a number that is none is a finding there
LARGEST = 20_000_000  # characters; the largest public ones have some 500 000
MOST_LINKS = 2000
WITHOUT_AXIS = ("fixed", "floating")  # joints of which URDF reads none
INERTIAL = ("origin", "mass", "inertia")
# Elements of a link or a joint, and their attributes that are numbers, with how many of them.
NUMBERS = {
    "origin": {"xyz": 3, "rpy": 3},
    "axis": {"xyz": 3},
    "mass": {"value": 1},
    "inertia": dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), 1),
    "limit": dict.fromkeys(("lower", "upper", "effort", "velocity"), 1),
    "mimic": {"multiplier": 1, "offset": 1},
    "safety_controller": dict.fromkeys(("soft_lower_limit", "soft_upper_limit", "k_position", "k_velocity"), 1),
}


def checked_shape(text: str, source: str) -> Element:
    """Return the XML of a URDF whose links and joints have names, numbers that are some, and make trees.

    Args:
        text: of the URDF.
        source: its file, for messages.

    Raises:
        InputError: it has another shape; it says where, what stands there, and what must.
    """
    if len(text) > LARGEST:
        raise InputError(source, NO_VALUE, f"is larger than {LARGEST} characters; no robot is")
    if "<!DOCTYPE" in text.upper():
        raise InputError(source, NO_VALUE, "declares a document type, which no URDF needs; take that line out")
    try:
        robot = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise InputError(source, NO_VALUE, f"is no XML: {error}") from None
    if robot.tag != "robot":
        raise InputError(source, f"<{robot.tag}>", "must be a URDF, whose outermost element is <robot>")
    for element in (*robot.findall("link"), *robot.findall("joint")):
        _check_numbers(element, source)
    for link in robot.findall("link"):
        _check_inertial(link, source)
    _check_tree(robot, source)
    return robot


def _check_inertial(link: Element, source: str) -> None:
    """Raise where a macro stands for the moments of inertia: xacro leaves one alone that is called without xacro:."""
    inertial = link.find("inertial")
    if inertial is not None and inertial.find("inertia") is None:
        other = next((inner.tag for inner in inertial if inner.tag not in INERTIAL), None)
        if other is not None:
            told = f"is no part of a URDF; if it is a macro, xacro expands it as <xacro:{other} ...>"
            raise InputError(f"{source}: link {link.get('name')}: inertial", f"<{other}>", told)


def _check_numbers(element: Element, source: str) -> None:
    place = f"{source}: {element.tag} {element.get('name')}"
    for inner in element.iter():
        if inner.tag == "axis" and element.get("type") in WITHOUT_AXIS:
            continue
        for name, count in NUMBERS.get(inner.tag, {}).items():
            value = inner.get(name)
            if value is not None and not _are_numbers(value, count, any_size=inner.tag in JUDGED_LATER):
                must = "a number" if count == 1 else f"{count} numbers"
                within = "" if inner.tag in JUDGED_LATER else f" within {LARGEST_NUMBER:g}"
                raise InputError(f"{place}: {inner.tag} {name}", value, f"must be {must}{within}")


def _are_numbers(text: str, count: int, *, any_size: bool) -> bool:
    try:
        numbers = [float(word) for word in text.split()]
    except ValueError:
        return False
    return len(numbers) == count and (any_size or all(abs(number) <= LARGEST_NUMBER for number in numbers))


def _check_tree(robot: Element, source: str) -> None:
    links, joints = robot.findall("link"), robot.findall("joint")
    if not links or len(links) > MOST_LINKS:
        raise InputError(source, NO_VALUE, f"has {len(links)} links; a robot has from 1 to {MOST_LINKS}")
    for what, elements in (("link", links), ("joint", joints)):
        names = Counter(element.get("name") for element in elements)
        name, times = names.most_common(1)[0] if names else ("", 1)
        if None in names or "" in names:
            raise InputError(source, NO_VALUE, f"has a {what} without a name")
        if times > 1:
            raise InputError(source, name, f"{times} of its {what}s have this name; names must differ")
    names = Counter(str(link.get("name")) for link in links)
    parents: dict[str, str] = {}
    for joint in joints:
        place = f"{source}: joint {joint.get('name')}"
        if joint.get("type") not in KINDS:
            raise InputError(f"{place}: type", joint.get("type"), f"must be one of {', '.join(KINDS)}")
        ends = {which: _end(joint, which) for which in ("parent", "child")}
        for which, link in ends.items():
            if link not in names:
                raise InputError(f"{place}: {which}", link, "must be one of the robot's links")
        if ends["child"] in parents:
            raise InputError(f"{place}: child", ends["child"], "two joints carry it; a tree has one")
        parents[str(ends["child"])] = str(ends["parent"])
        mimic = joint.find("mimic")
        if mimic is not None and mimic.get("joint") not in {other.get("name") for other in joints}:
            raise InputError(f"{place}: mimic joint", mimic.get("joint"), "must be one of the robot's joints")
    for link in names:
        above, steps = link, 0
        while above in parents:
            above, steps = parents[above], steps + 1
            if steps > len(links):
                raise InputError(source, link, "its joints carry it in a loop; they must make a tree")


def _end(joint: Element, which: str) -> str | None:
    found = joint.find(which)
    return None if found is None else found.get("link")
