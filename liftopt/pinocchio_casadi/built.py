"""The names of ``pinocchio.casadi`` from the extension that was built when liftopt was installed."""

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

from liftopt.pinocchio_casadi.force_list import StdVec_Force
from liftopt.pinocchio_casadi.versions import require_same_version

try:
    import _liftopt_pinocchio_casadi as _extension
except ImportError as error:
    raise ImportError(
        "pinocchio.casadi is not installed, and liftopt's own extension for it cannot be loaded; reinstall liftopt "
        f"with `pip install --force-reinstall --no-deps .`, which builds it ({error})"
    ) from error

require_same_version("casadi", casadi.CasadiMeta.version(), _extension.casadi_version)
require_same_version("pin", _pinocchio_version, _extension.pinocchio_version)

# Only now: these need the extension.
from _liftopt_pinocchio_casadi import (  # noqa: E402
    SE3,
    Data,
    Force,
    Frame,
    Inertia,
    Motion,
    StdVec_Frame,
    StdVec_Inertia,
    StdVec_Motion,
    StdVec_SE3,
    computeFrameJacobian,
    computeJointJacobians,
    computeRNEADerivatives,
    crba,
    forwardKinematics,
    framesForwardKinematics,
    getAcceleration,
    getFrameAcceleration,
    getFrameClassicalAcceleration,
    getFrameJacobian,
    getFrameVelocity,
    getJointJacobian,
    getVelocity,
    rnea,
    updateFramePlacement,
    updateFramePlacements,
)

from liftopt.pinocchio_casadi.model import Model  # noqa: E402

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
