"""Whether a robot's motors can bear its own weight: masses in grams and efforts in other units show there."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pinocchio as pin

from liftopt.multibody.robots.chain import RobotChain
from liftopt.multibody.robots.data_finding import DataFinding
from liftopt.multibody.robots.evenly_spread import evenly_spread
from liftopt.multibody.robots.robot_urdf import robot_urdf
from liftopt.multibody.urdf import load_model
from liftopt.types import Array

WEIGHT = "weight.effort"
POSTURES = 128


def weight_findings(chain: RobotChain) -> Iterator[DataFinding]:
    """Give the joints that cannot hold the robot's own weight in some posture, of a robot that stands upright."""
    effort = np.array([joint.effort for joint in chain.joints], dtype=np.float64)
    needed = heaviest(chain)
    short = np.flatnonzero(needed > effort)
    if short.size:
        told = ", ".join(f"{chain.joints[i].name} needs {needed[i]:.3g} and has {effort[i]:.3g}" for i in short)
        message = f"not enough to hold the robot's own weight in every posture: {told}"
        fix = "check masses and efforts; where springs or counterweights bear part of it, say so"
        yield DataFinding(WEIGHT, "warned", "effort", float(effort[short[0]]), message, fix)


def heaviest(chain: RobotChain) -> Array:
    """Return the largest effort (n,) that each joint needs to hold the robot in its postures [Nm, N]."""
    model = load_model(robot_urdf(chain, "robot", np.eye(4), tool_length=0.0, tool_mass=0.0, shapes=False))
    data = model.createData()
    lower = np.array([max(ends.lower, -np.pi) for ends in chain.ranges])
    upper = np.array([min(ends.upper, np.pi) for ends in chain.ranges])
    postures = lower + evenly_spread(POSTURES, len(lower)) * (upper - lower)
    return np.asarray(np.max([np.abs(pin.computeGeneralizedGravity(model, data, q)) for q in postures], axis=0))
