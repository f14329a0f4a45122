"""Packages of the extra ``lab``: imported when they are needed, named when they are missing."""

from __future__ import annotations

import importlib
import importlib.util
from types import ModuleType

from liftopt.errors import NO_VALUE, InputError

INSTALL = 'pip install "liftopt[lab]"'


def check_extra(module: str, what_for: str) -> None:
    """Raise ``InputError`` if ``module`` cannot be found; it is not imported.

    Args:
        module: name under which it is imported.
        what_for: completes "is needed to ...".
    """
    if importlib.util.find_spec(module) is None:
        raise InputError(module, NO_VALUE, f"the package is not installed; it is needed to {what_for}: {INSTALL}")


def load_extra(module: str, what_for: str) -> ModuleType:
    """Return a module of the extra ``lab``.

    Args:
        module: name under which it is imported.
        what_for: completes "is needed to ...".

    Raises:
        InputError: it is not installed; the message says how to install it.
    """
    check_extra(module, what_for)
    return importlib.import_module(module)
