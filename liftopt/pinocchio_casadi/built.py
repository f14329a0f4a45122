"""The names of ``pinocchio.casadi`` from the extension that was built when this package was installed.

In the wheel of its own this file is ``pinocchio/casadi/__init__.py``.
"""

from __future__ import annotations

# The extension needs libcasadi in the process, which this brings.
import casadi
from pinocchio import (
    BODY,
    FIXED_JOINT,
    JOINT,
    LOCAL,
    LOCAL_WORLD_ALIGNED,
    OP_FRAME,
    SENSOR,
    WORLD,
    Convention,
    FrameType,
    ReferenceFrame,
)
from pinocchio.pinocchio_pywrap_default import __version__ as _pinocchio_version

from .extension import extension as _extension
from .force_list import StdVec_Force
from .versions import require_same_version

require_same_version("casadi", casadi.CasadiMeta.version(), _extension.casadi_version)
require_same_version("pin", _pinocchio_version, _extension.pinocchio_version)

# Only now: this needs the extension.
from .model import Model  # noqa: E402

SE3 = _extension.SE3
Data = _extension.Data
Force = _extension.Force
Frame = _extension.Frame
Inertia = _extension.Inertia
Motion = _extension.Motion
StdVec_Frame = _extension.StdVec_Frame
StdVec_Inertia = _extension.StdVec_Inertia
StdVec_Motion = _extension.StdVec_Motion
StdVec_SE3 = _extension.StdVec_SE3
computeFrameJacobian = _extension.computeFrameJacobian
computeJointJacobians = _extension.computeJointJacobians
computeRNEADerivatives = _extension.computeRNEADerivatives
crba = _extension.crba
forwardKinematics = _extension.forwardKinematics
framesForwardKinematics = _extension.framesForwardKinematics
getAcceleration = _extension.getAcceleration
getFrameAcceleration = _extension.getFrameAcceleration
getFrameClassicalAcceleration = _extension.getFrameClassicalAcceleration
getFrameJacobian = _extension.getFrameJacobian
getFrameVelocity = _extension.getFrameVelocity
getJointJacobian = _extension.getJointJacobian
getVelocity = _extension.getVelocity
rnea = _extension.rnea
updateFramePlacement = _extension.updateFramePlacement
updateFramePlacements = _extension.updateFramePlacements

__all__ = [
    "BODY",
    "FIXED_JOINT",
    "JOINT",
    "LOCAL",
    "LOCAL_WORLD_ALIGNED",
    "OP_FRAME",
    "SE3",
    "SENSOR",
    "WORLD",
    "Convention",
    "Data",
    "Force",
    "Frame",
    "FrameType",
    "Inertia",
    "Model",
    "Motion",
    "ReferenceFrame",
    "StdVec_Force",
    "StdVec_Frame",
    "StdVec_Inertia",
    "StdVec_Motion",
    "StdVec_SE3",
    "computeFrameJacobian",
    "computeJointJacobians",
    "computeRNEADerivatives",
    "crba",
    "forwardKinematics",
    "framesForwardKinematics",
    "getAcceleration",
    "getFrameAcceleration",
    "getFrameClassicalAcceleration",
    "getFrameJacobian",
    "getFrameVelocity",
    "getJointJacobian",
    "getVelocity",
    "rnea",
    "updateFramePlacement",
    "updateFramePlacements",
]
