"""Where an agent stands and which way it faces, as its model has it."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from liftopt.multibody.agent import Agent
from liftopt.types import Array

LEVEL = 0.3  # of an axis' length that must lie in the level for it to be a direction there

EXACT = 9  # decimals of a placement: a URDF's angles give quarter turns with an error in the last digit


def base_of(agent: Agent) -> Array:
    """Return T_world_base (4, 4) of one who stands, or of a chain of Table 2 or 3: X ahead, Z up.

    It is at the feet of a person, and at the base of a robot's arm, on its pedestal. Of a robot from outside, X ahead
    is that of its base link, made level; of one on a wall it is away from the wall.
    """
    if agent.stance is not None:
        return np.asarray(np.round(agent.T_world_base, EXACT) + 0.0, dtype=np.float64)
    model = agent.model
    if agent.kind == "robot" and not agent.locked_joints:
        return _level(base_link_of(agent))
    first = model.jointPlacements[1]
    # The first of the chain's joints slides ahead along its z axis; its x axis is up.
    ahead, up = first.rotation[:, 2], first.rotation[:, 0]
    base = np.eye(4)
    base[:3, :3] = np.column_stack([ahead, np.cross(up, ahead), up])
    base[:3, 3] = first.translation
    if agent.kind == "robot":
        data = model.createData()
        pin.forwardKinematics(model, data, np.zeros(model.nq))
        base[:3, 3] = data.oMi[model.getJointId(agent.moving_joints[0])].translation
    return np.asarray(np.round(base, EXACT) + 0.0, dtype=np.float64)


def base_link_of(agent: Agent) -> Array:
    """Return T_world_base (4, 4) of the link of a robot from outside that is bolted down."""
    model = agent.model
    data = model.createData()
    pin.framesForwardKinematics(model, data, np.zeros(model.nq))
    links = (i for i in range(1, model.nframes) if model.frames[i].type == pin.FrameType.BODY)
    base = next(i for i in links if model.frames[i].name != "world")
    return np.asarray(data.oMf[base].homogeneous)


def _level(base: Array) -> Array:
    """Return a placement where a base is, its z axis up."""
    ahead = next(axis for axis in (base[:3, 0], base[:3, 2], base[:3, 1]) if np.hypot(*axis[:2]) > LEVEL)
    x = np.array([ahead[0], ahead[1], 0.0]) / np.hypot(*ahead[:2])
    upright = np.eye(4)
    upright[:3, :3] = np.column_stack([x, np.cross([0.0, 0.0, 1.0], x), [0.0, 0.0, 1.0]])
    upright[:3, 3] = base[:3, 3]
    return np.asarray(np.round(upright, EXACT) + 0.0)
