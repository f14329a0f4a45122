"""``pinocchio.casadi`` for pip: Pinocchio's algorithms on casadi.SX expressions.

The wheels of Pinocchio ship no ``pinocchio.casadi``. This package offers the part of it that inverse dynamics, its
derivatives and forward kinematics need, with upstream's names, signatures and return types, so that the same code
runs on either::

    import liftopt.pinocchio_casadi as cpin

    model = cpin.Model(pinocchio_model)
    tau = cpin.rnea(model, model.createData(), q, v, a)

An upstream ``pinocchio.casadi`` is used when it imports; otherwise the extension built from the wheels' own headers
when liftopt was installed. All names of the one in use are attributes of this module.

README.md in this folder says what the extension covers and where it differs from upstream.
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
