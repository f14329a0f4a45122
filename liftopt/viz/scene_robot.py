"""A robot from outside as a figure: with its own meshes where they are at hand, else with the shapes of its model."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np
import pinocchio as pin

from liftopt.multibody.agent import Agent
from liftopt.multibody.robots.carried_links import BASE
from liftopt.multibody.robots.robot_stand import STAND
from liftopt.multibody.solids import END_SPHERES, numbers_in, placement_of
from liftopt.viz.base import base_link_of
from liftopt.viz.robot_figure import FigurePiece
from liftopt.viz.scene_mesh import Mesh, ball, block, capsule, cylinder
from liftopt.viz.scene_part import GROUND, Colour, Part


def robot_parts(agent: Agent, figure: Sequence[FigurePiece] = ()) -> list[Part]:
    """Return a robot with all joints at zero, in the world.

    Args:
        agent: it.
        figure: its own meshes; a body that has none is drawn with the shapes of the model, and so is the stand.
    """
    model, data = agent.model, agent.model.createData()
    pin.framesForwardKinematics(model, data, np.zeros(model.nq))
    parts = []
    for number, piece in enumerate(figure):
        joint = piece.joint + 1
        placement = base_link_of(agent) if piece.joint == BASE else data.oMi[joint].homogeneous
        body = GROUND if piece.joint == BASE else model.names[joint]
        parts.append(Part(body, f"mesh_{number}", piece.colour, piece.mesh.seen_from(placement)))
    own = {piece.joint + 1 for piece in figure}
    tool = f"{agent.name}_tool"
    for link in ElementTree.fromstring(agent.urdf).iter("link"):
        name = link.get("name", "")
        frame = model.getFrameId(name, pin.FrameType.BODY)
        if name == tool or frame >= model.nframes:  # the gripper is drawn as one that closes
            continue
        joint = model.frames[frame].parentJoint
        placement = data.oMf[frame].homogeneous
        for shape, colour, mesh in _shapes(link):
            if joint not in own or shape.startswith(STAND):
                body = model.names[joint] if joint else GROUND
                parts.append(Part(body, f"{name}_{shape}", colour, mesh.seen_from(placement)))
    return parts


def _shapes(link: Element) -> Iterator[tuple[str, Colour, Mesh]]:
    """Give name, colour and mesh of each shape of a link, in its frame; three primitives of a capsule are one."""
    visuals = {visual.get("name", ""): visual for visual in link.iter("visual")}
    ends = {name + end for name in visuals for end in END_SPHERES}
    for name, visual in visuals.items():
        whole = name + END_SPHERES[0] in visuals
        if name not in ends and (mesh := _mesh(visual, whole)) is not None:
            yield name, _colour(visual), mesh


def _mesh(visual: Element, with_ends: bool) -> Mesh | None:
    placement = placement_of(visual.find("origin"))
    box, round_, sphere = (visual.find(f"geometry/{kind}") for kind in ("box", "cylinder", "sphere"))
    if box is not None:
        return block((0.0, 0.0, 0.0), numbers_in(box.get("size", "")), edge=0.01).seen_from(placement)
    if round_ is not None:
        radius, half = float(round_.get("radius", "0")), float(round_.get("length", "0")) / 2.0
        if half < 1e-6:
            return ball((0.0, 0.0, 0.0), (radius,) * 3).seen_from(placement)
        shape = capsule if with_ends else cylinder
        return shape((0.0, 0.0, -half), (0.0, 0.0, half), radius).seen_from(placement)
    if sphere is not None:
        return ball((0.0, 0.0, 0.0), (float(sphere.get("radius", "0")),) * 3).seen_from(placement)
    return None


def _colour(visual: Element) -> Colour:
    colour = visual.find("material/color")
    red, green, blue, *_ = numbers_in("" if colour is None else colour.get("rgba", "")) or (0.5, 0.5, 0.5)
    return (red, green, blue)
