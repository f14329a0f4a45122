"""The models that a solution was solved with, and where they stand."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.multibody.urdf import load_model
from liftopt.scenario.urdf_files import urdf_files
from liftopt.solution.solution import Solution

Array = npt.NDArray[np.float64]
EXACT = 9  # decimals of a placement: a URDF's angles give quarter turns with an error in the last digit


def urdf_of(solution: Solution, name: str) -> str:
    """Return the URDF of an agent or of the object."""
    return solution.urdfs[urdf_files(solution.scenario)[name]]


def model_of(solution: Solution, name: str) -> pin.Model:
    """Return the model of an agent."""
    return load_model(urdf_of(solution, name))


def grasp_frame(name: str) -> str:
    """Return the name of the frame that an agent holds at."""
    return f"{name}_grasp"


def base_of(model: pin.Model, agent: AgentTrajectory) -> Array:
    """Return T_world_base (4, 4) of a chain of Table 2 or 3: X ahead, Z up.

    It is at the feet of a person, and at the base of a robot's arm, on its pedestal.
    """
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
