"""Where an agent stands and which way it faces, as its model has it."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from liftopt.multibody.agent import Agent
from liftopt.types import Array

EXACT = 9  # decimals of a placement: a URDF's angles give quarter turns with an error in the last digit


def base_of(agent: Agent) -> Array:
    """Return T_world_base (4, 4) of one who stands, or of a chain of Table 2 or 3: X ahead, Z up.

    It is at the feet of a person, and at the base of a robot's arm, on its pedestal.
    """
    if agent.stance is not None:
        return np.asarray(np.round(agent.T_world_base, EXACT) + 0.0, dtype=np.float64)
    model = agent.model
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
