"""The table that is lifted: a box with a free-flyer and two grasp points (Table 4)."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from liftopt.multibody.agent import LiftedObject
from liftopt.multibody.bounds import checked_number
from liftopt.multibody.dh import BodyInertia, DHChain, table_rows, translation
from liftopt.multibody.edges import Point, edge_grasps
from liftopt.multibody.shapes import Colour, box_at
from liftopt.multibody.urdf import FixedLink, body_robot, load_free_model, urdf_text

NAME = "table"
WOOD = Colour("wood", (0.76, 0.58, 0.36, 1.0))


def table_body(mass: float, size: tuple[float, float, float]) -> BodyInertia:
    """Return a uniform box of ``mass`` [kg] and ``size`` (x, y, z) [m] about its centre, axes along its edges."""
    x, y, z = np.square(size)
    return BodyInertia(float(mass), np.zeros(3), mass / 12.0 * np.diag([y + z, z + x, x + y]))


def table_chain(*, mass: float, depth: float, width: float, height: float) -> DHChain:
    """Return Table 4 with the table's body in its last DH frame.

    At zero that frame's x, y, z are the paper's -X, -Y, Z: across, down and away from the human. So the body is
    ``width`` along x, ``height`` along y and ``depth`` along z, and its underside is at y = +height/2 [kg, m].

    Raises:
        InputError: a value is out of range.
    """
    _check(mass, depth, width, height)
    rows = table_rows()
    virtual = tuple(BodyInertia.zero() for _ in rows[:-1])
    return DHChain(NAME, rows, (*virtual, table_body(mass, (width, height, depth))))


def lifted_table(
    *,
    mass: float,
    depth: float,
    width: float,
    height: float,
    urdf: str | None = None,
    name: str = NAME,
    grasps: Mapping[str, Point] | None = None,
) -> LiftedObject:
    """Return the table as a free body; its frame is at its centre of mass and aligned with the world at zero.

    Args:
        mass: [kg].
        depth: along X, from the human to the robot [m].
        width: along Y [m].
        height: thickness of the top, along Z [m].
        urdf: this table's URDF if it was written before; None writes it.
        name: of the object.
        grasps: where each agent holds it, in its own axes from its centre [m]; None: ``edge_grasps``.

    Raises:
        InputError: a value is out of range; its key is ``object.mass``, ``object.depth``...
    """
    _check(mass, depth, width, height)
    points = edge_grasps(depth, height) if grasps is None else grasps
    frames = tuple(f"grasp_{agent}" for agent in points)
    text = urdf
    if text is None:
        size = (float(depth), float(width), float(height))
        grasp_links = [FixedLink(f"grasp_{agent}", name, translation(*point)) for agent, point in points.items()]
        top = box_at("top", WOOD, np.zeros(3), size)
        text = urdf_text(body_robot(name, table_body(mass, size), (top,), grasp_links))
    return LiftedObject(name, text, load_free_model(text), frames)


def _check(mass: float, depth: float, width: float, height: float) -> None:
    checked_number("object.mass", mass, 0.01, 200.0, "kg")
    for key, value in (("depth", depth), ("width", width), ("height", height)):
        checked_number(f"object.{key}", value, 0.001, 3.0, "m")
