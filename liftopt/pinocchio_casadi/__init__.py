"""``pinocchio.casadi`` for pip: Pinocchio's algorithms on casadi.SX expressions.

The wheels of Pinocchio ship no ``pinocchio.casadi``. This package offers the part of it that inverse dynamics, its
derivatives and forward kinematics need, with upstream's names, signatures and return types, so that the same code
runs on either::

    import liftopt.pinocchio_casadi as cpin

    model = cpin.Model(pinocchio_model)
    tau = cpin.rnea(model, model.createData(), q, v, a)

An upstream ``pinocchio.casadi`` is used when it imports; otherwise the extension built from the wheels' own headers
when liftopt was installed. All names of the one in use are attributes of this module.

Exposed by the extension: ``Model``, ``Data``, ``Frame``, ``SE3``, ``Motion``, ``Force``, ``Inertia``,
``StdVec_Force``, the enumerations of ``pinocchio`` and their values; ``rnea`` and ``computeRNEADerivatives`` with and
without external forces, ``crba``; ``forwardKinematics``,
``getVelocity``, ``getAcceleration``; ``updateFramePlacement``, ``updateFramePlacements``,
``framesForwardKinematics``, ``getFrameVelocity``, ``getFrameAcceleration``, ``getFrameClassicalAcceleration``;
``computeJointJacobians``, ``getJointJacobian``, ``getFrameJacobian``, ``computeFrameJacobian``. Joints: revolute and
prismatic about any axis, spherical, free-flyer; fixed joints vanish in Pinocchio.

Where the extension differs from upstream:

- Joints and frames cannot be added to a symbolic model: build the ``pinocchio.Model`` first. Inertias, placements,
  armature and gravity can be assigned. Limits, friction and other data that no algorithm here reads are not copied.
- Arguments may be anything that ``casadi.SX`` takes (numbers, NumPy arrays), not only SX; attributes that upstream
  lets one assign but that are results (``data.tau``) are read-only.
- ``StdVec_Force`` is a Python list; a list of forces is taken for it. The sequences of a model and of a data have
  fixed length and take integers, not slices. Of a frame, assign the placement, not the whole.
- ``SE3()``, ``Motion()``, ``Force()`` and ``Inertia()`` are the identity or zero, not uninitialised.
- Wrong sizes and a data of another model raise ValueError, indices out of range IndexError, where upstream may
  read out of bounds.
- The rotational inertia given to ``Inertia`` is taken as symmetric: its lower triangle is read.
"""

from __future__ import annotations

import importlib
from types import ModuleType
from typing import Any


def _load() -> ModuleType:
    try:
        return importlib.import_module("pinocchio.casadi")
    except ImportError:
        return importlib.import_module("liftopt.pinocchio_casadi.built")


_backend = _load()


def __getattr__(name: str) -> Any:
    try:
        return getattr(_backend, name)
    except AttributeError:
        raise AttributeError(f"{__name__} (backed by {_backend.__name__}) has no attribute {name!r}") from None


def __dir__() -> list[str]:
    return sorted({*globals(), *dir(_backend)})
