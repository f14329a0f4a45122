"""A picture of a robot alone, without a lift: what it looks like where it is bolted down."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from liftopt.multibody.agent import Agent
from liftopt.types import Array
from liftopt.viz.camera import in_perspective
from liftopt.viz.robot_figure import FigurePiece
from liftopt.viz.scene_part import GROUND
from liftopt.viz.scene_robot import robot_parts
from liftopt.viz.shading import Body, Image, render

THREE_QUARTER = (0.9, -1.0, 0.45)  # from where it is seen, world axes
MARGIN = 0.04  # [m]


def robot_picture(
    agent: Agent,
    figure: Sequence[FigurePiece] = (),
    *,
    q: Array | None = None,
    side: Sequence[float] = THREE_QUARTER,
    size: tuple[int, int] = (400, 400),
) -> Image:
    """Return a picture (H, W, 3) of a robot.

    Args:
        agent: it.
        figure: its own meshes, by ``figure_of``; without them its model's shapes are drawn.
        q: (n,) posture, by default its comfortable one [rad, m].
        side: (3,) from where it is seen, world axes.
        size: width and height [pixels].
    """
    bodies = robot_bodies(agent, figure, q)
    points = np.vstack([body.mesh.vertices for body in bodies])
    camera = in_perspective(side, points.min(axis=0) - MARGIN, points.max(axis=0) + MARGIN, size)
    return render(bodies, camera, size)


def robot_bodies(agent: Agent, figure: Sequence[FigurePiece] = (), q: Array | None = None) -> list[Body]:
    """Return what is drawn of a robot, where it is in the world; arguments as ``robot_picture``."""
    model = agent.model
    posture = agent.posture if q is None else q
    zero, now = model.createData(), model.createData()
    pin.forwardKinematics(model, zero, np.zeros(model.nq))
    pin.forwardKinematics(model, now, np.asarray(posture, dtype=np.float64))
    moved = {
        name: now.oMi[joint].homogeneous @ zero.oMi[joint].inverse().homogeneous
        for joint, name in enumerate(model.names) if joint
    }  # fmt: skip
    return [
        Body(part.mesh if part.body == GROUND else part.mesh.seen_from(moved[part.body]), part.colour)
        for part in robot_parts(agent, figure)
    ]
