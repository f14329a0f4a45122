"""How far an agent's trunk leans from the vertical."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from liftopt.multibody.agent import Agent
from liftopt.types import Array


def up_in_link(model: pin.Model, joint: int) -> Array:
    """Return the direction (3,) in the link that a joint carries which is up where all joints are at zero."""
    data = model.createData()
    pin.forwardKinematics(model, data, pin.neutral(model))
    return np.array(data.oMi[joint].rotation[2])


def trunk_tilt(agent: Agent, q: Array) -> Array:
    """Return 1 - cos of the angle (K,) between the trunk and the vertical, from all joints (K, n) of the model.

    It does not lean where all joints are at zero.
    """
    if agent.lean is None:
        raise ValueError(f"{agent.name} has no trunk that leans")
    model, data = agent.model, agent.model.createData()
    trunk = model.getJointId(agent.lean.joint)
    up = up_in_link(model, trunk)
    found = np.zeros(len(q))
    for k, posture in enumerate(q):
        pin.forwardKinematics(model, data, posture)
        found[k] = 1.0 - float(data.oMi[trunk].rotation[2] @ up)
    return found
