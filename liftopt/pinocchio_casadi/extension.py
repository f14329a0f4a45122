"""The compiled module: beside this file in the wheel of its own, at the top of site-packages if liftopt brings it."""

from __future__ import annotations

import importlib
from typing import Any

NAME = "_liftopt_pinocchio_casadi"
# Imports in this folder are relative, for in the wheel of its own it is the package pinocchio.casadi.
REINSTALL = (
    "reinstall liftopt with `pip install --force-reinstall --no-deps .`, which builds it"
    if (__package__ or "").startswith("liftopt")
    else "reinstall it with `pip install --force-reinstall --no-deps liftopt-pinocchio-casadi`"
)

try:
    extension: Any = importlib.import_module(f".{NAME}", __package__)
except ModuleNotFoundError:
    try:
        extension = importlib.import_module(NAME)
    except ImportError as error:
        raise ImportError(f"the extension of pinocchio.casadi cannot be loaded; {REINSTALL} ({error})") from error
